"""The paper's protocols on the sample languages."""

import numpy as np
import pytest

from app.evaluation.one_shot import recognize_variants
from app.recognition import Language, OsgError
from app.recognition.language.export_format import from_reference, to_reference
from tests.conftest import ROOT
from tests.recognition.demonstrations import pool
from tests.recognition.strategies import circle, line


@pytest.fixture(scope="module")
def table_1() -> Language:
    return Language.load(ROOT / "languages" / "osg-table-1.json")


def test_variants_of_three_gestures_are_nearly_all_named(table_1: Language) -> None:
    matrix = recognize_variants(table_1, 10, profile="full", seed=3)
    assert matrix.labels == table_1.labels
    assert matrix.counts.sum(axis=1).tolist() == [10, 10, 10]
    assert matrix.correct.correct >= 27


def test_variants_between_two_gestures_are_asked_back() -> None:
    matrix = recognize_variants(pool(circle=circle, ring=circle, line=line), 4, profile="full")
    assert matrix.asked_back.asked >= 7
    assert matrix.asked_back.correct == matrix.asked_back.asked
    assert matrix.counts[:2, :2].sum() <= 1
    assert matrix.counts[2, :2].tolist() == [0, 0]
    assert matrix.counts[2, 2] >= 3


def test_the_same_seed_gives_the_same_matrix_and_progress_counts_every_query(
    table_1: Language,
) -> None:
    seen: list[tuple[int, int]] = []
    once = recognize_variants(
        table_1, 4, profile="paper", seed=5, progress=lambda *counts: seen.append(counts)
    )
    again = recognize_variants(table_1, 4, profile="paper", seed=5)
    np.testing.assert_array_equal(once.counts, again.counts)
    assert seen == [(done, 12) for done in range(1, 13)]


def test_a_gesture_without_demonstration_is_told_by_name(table_1: Language) -> None:
    images_only = from_reference(to_reference(table_1), "images")
    with pytest.raises(OsgError, match=r"circle.*define it again"):
        recognize_variants(images_only, 1, profile="paper")
