"""The starter language of divers' signs: complete, told apart, and not in the way of movements."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import pytest

from app.recognition import Language, Recognition, Recognizer, Recording, Take, takes_in
from languages.build import DIVERS_SIGNS, FOLDER
from tests.conftest import RECORDINGS

SIGNS = tuple(entry.label for entry in DIVERS_SIGNS)

NEAREST, ACCEPTED = 21, 19
"""Number of 25 takes by other divers in other water that are nearest to their own sign, and number
recognised as it, on any processor. Rejected are *cold*, *danger*, *look* and *problem*."""


@pytest.fixture(scope="module")
def language() -> Language:
    return Language.load(FOLDER / "signs-of-divers.json")


@pytest.fixture(scope="module")
def takes() -> Mapping[str, tuple[Take, ...]]:
    """Return the takes of each sign's test clip."""
    return {
        sign: takes_in(
            Recording.load(RECORDINGS / "signs" / f"sign-{sign.replace(' ', '-')}-test.npz")
        )
        for sign in SIGNS
    }


@pytest.fixture(scope="module")
def results(language: Language, takes: Mapping[str, tuple[Take, ...]]) -> Mapping[str, Recognition]:
    recognizer = Recognizer(language, "full")
    return {sign: recognizer.recognize(found[0].poses) for sign, found in takes.items()}


def test_every_sign_has_a_meaning_and_a_demonstration(language: Language) -> None:
    assert len(SIGNS) >= 20
    assert language.labels == SIGNS
    for gesture in language.gestures:
        assert gesture.description
        assert gesture.trajectories


def test_every_clip_of_a_sign_holds_one_closed_take(
    takes: Mapping[str, tuple[Take, ...]],
) -> None:
    unlike = {sign for sign, found in takes.items() if [take.closed for take in found] != [True]}
    assert unlike == set()


def test_signs_of_other_divers_are_told_apart(results: Mapping[str, Recognition]) -> None:
    nearest = {sign: result.nearest for sign, result in results.items()}
    assert sum(sign == read for sign, read in nearest.items()) >= NEAREST, nearest
    labels = {sign: result.label for sign, result in results.items()}
    assert sum(sign == read for sign, read in labels.items()) >= ACCEPTED, labels


def test_no_sign_is_taken_for_another(results: Mapping[str, Recognition]) -> None:
    mistaken = {sign: r.label for sign, r in results.items() if r.label not in (sign, None)}
    assert not mistaken
    asked = {sign: r.pair for sign, r in results.items() if r.pair is not None}
    assert all(sign in pair for sign, pair in asked.items()), asked


@pytest.mark.parametrize("kind", ["test-1", "test-2"])
def test_movements_are_named_as_before_beside_the_signs(
    language: Language, sample_recording: Callable[[str], Recording], kind: str
) -> None:
    movements = Language.load(FOLDER / "osg-table-2.json")
    kept = [gesture for gesture in language.gestures if gesture.label not in movements.labels]
    both = replace(movements, gestures=[*movements.gestures, *kept])
    alone, beside = Recognizer(movements, "full"), Recognizer(both, "full")
    for label in movements.labels:
        (take,) = takes_in(sample_recording(f"{label}-{kind}"))
        assert beside.recognize(take.poses).label == alone.recognize(take.poses).label == label
