"""Misreadings: which claims are true, and what readers and transcripts agree on."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from app.recognition import Language, Recognizer, Recording, takes_in
from app.recognition.explanation.context import RecognitionContext
from app.resources import samples_dir
from benchmarks.accuracy.explanations import agree, find_people, parse_strokes
from benchmarks.accuracy.misreadings import (
    CLIPS,
    HARD,
    NO_TAKE,
    SETS,
    claim_absence,
    judge,
    read_table,
)


@pytest.fixture(scope="module")
def context(sample_recording: Callable[[str], Recording]) -> RecognitionContext:
    """Return a triangle that was not finished, which is read as a wedge."""
    recording = Recording.load(samples_dir() / "clips" / "unfinished-triangle.npz")
    (take,) = takes_in(recording)
    language = Language.load(samples_dir() / "osg-table-2.json")
    return RecognitionContext.of_take(Recognizer(language), take)


@pytest.mark.parametrize(
    ("claim", "odd", "outcome"),
    [
        ("ended_early", False, "named"),
        ("upside_down", False, "named"),
        ("too_small", False, "false"),
        ("near_gesture", False, "alike"),
        ("demonstration", True, "odd"),
        ("demonstration", False, "false"),
        ("", False, "silent"),
    ],
)
def test_a_claim_is_true_if_a_reader_accepts_it(
    context: RecognitionContext, claim: str, odd: bool, outcome: str
) -> None:
    row = {"expected": "triangle", "read_as": "wedge"}
    row |= {"reader_1": "ended_early other_shape", "reader_2": "upside_down"}
    assert judge(row, context, claim, odd=odd) == outcome


def test_a_take_that_is_read_right_or_found_by_now_needs_no_claim(
    context: RecognitionContext,
) -> None:
    row = {"expected": "wedge", "read_as": "", "reader_1": "", "reader_2": ""}
    assert judge(row, context, "too_small") == "changed"
    row |= {"expected": "triangle", "read_as": NO_TAKE}
    assert judge(row, context, "too_small") == "changed"
    assert judge(row, None, "no_hand") == "false"


def test_every_row_is_measured_once() -> None:
    parts = [
        read_table(SETS),
        read_table(SETS, new=True),
        read_table(CLIPS),
        read_table((HARD,)),
    ]
    assert [len(each) for each in parts] == [30, 20, 6, 16]


def test_nothing_is_claimed_of_a_clip_whose_salutes_are_seen(
    sample_recording: Callable[[str], Recording],
) -> None:
    assert claim_absence(sample_recording("circle-demonstration")) == ""


def test_readers_agree_on_strokes_whichever_hand_comes_first() -> None:
    one = parse_strokes("down, anticlockwise arc right; up")
    assert [each.hand for each in one] == ["0", "0", "1"]
    assert agree(one, parse_strokes("up; down, anticlockwise arc right"))
    assert not agree(one, parse_strokes("up; down, clockwise loop"))


def test_sets_by_the_same_people_are_left_out_together() -> None:
    assert find_people("utd_signals") == find_people("utd_other")
    assert find_people("carried_digits") == find_people("carried_letters")
    assert len({*map(find_people, ("utd_other", "utkinect", "carried_figures"))}) == 3
