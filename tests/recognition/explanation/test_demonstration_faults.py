"""Demonstration faults: what is wrong with a range of a recording as a demonstration."""

from dataclasses import replace

import numpy as np
import pytest

from app.recognition import PoseSequence, Recording
from app.recognition.explanation.demonstration_faults import (
    ClipOutline,
    FaultKind,
    find_demonstration_faults,
    find_range_faults,
)
from app.recognition.poses.sequence import FloatArray
from app.recognition.recording.segmentation import takes_in
from tests.api.recordings import recording_of
from tests.recognition.explanation.test_causes import HOOK, change_body, corners, leap
from tests.recognition.strategies import recording

CLIP = ClipOutline(
    triggers=((0.5, 1.0), (4.0, 4.5)), strokes=((1.5, 3.5),), start=0.0, end=5.0, moving=(1.4, 3.6)
)
WITHOUT_SALUTES = ClipOutline(triggers=(), strokes=(), start=0.0, end=6.0, moving=(2.0, 4.0))
SALUTE = (-0.35, -0.9)


@pytest.mark.parametrize(
    ("start", "end", "fault"),
    [
        (1.0, 4.0, None),  # the take
        (1.5, 3.5, None),  # its stroke
        (1.7, 3.5, None),  # a tenth less
        (2.5, 3.5, "is cut short: it keeps 1.0 of 2.0 s of the stroke"),
        (0.8, 3.5, "contains a Vulcan salute"),
        (0.0, 5.0, "is the whole clip, with 2 Vulcan salutes"),
    ],
)
def test_a_range_of_a_clip_with_salutes(start: float, end: float, fault: str | None) -> None:
    found = [each.words for each in find_range_faults(CLIP, start, end)]
    assert found == ([] if fault is None else [fault])


def test_the_better_range_is_the_stroke() -> None:
    (fault,) = find_range_faults(CLIP, 0.0, 5.0)
    assert (fault.kind, fault.remedy) == (FaultKind.whole_clip, "set_range")
    assert (fault.start, fault.end) == (1.5, 3.5)


def test_rest_before_and_after_the_movement_is_a_fault() -> None:
    (fault,) = find_range_faults(WITHOUT_SALUTES, 0.0, 6.0)
    assert fault.words == "contains 4.0 s of rest before and after the gesture"
    assert (fault.start, fault.end) == (2.0, 4.0)
    assert list(find_range_faults(WITHOUT_SALUTES, 1.8, 4.2)) == []


@pytest.mark.parametrize(
    ("start", "end", "count"), [(0.0, 10.0, 2), (0.0, 1.0, 1), (0.7, 2.5, 0), (2.55, 3.0, 1)]
)
def test_salutes_that_a_range_contains_are_counted(start: float, end: float, count: int) -> None:
    assert ClipOutline.of(recording_of("circle")).count_triggers(start, end) == count


def test_a_take_contains_none_of_its_salutes() -> None:
    made = recording_of("circle", "line")
    outline = ClipOutline.of(made)
    assert len(outline.triggers) == 4
    counts = [outline.count_triggers(take.start, take.end) for take in takes_in(made)]
    assert counts == [0, 0]


def saluted(poses: PoseSequence) -> Recording:
    """Return a recording with a second of salute before and after some poses."""
    held = 30
    xy = np.concatenate([poses.xy[:1].repeat(held, 0), poses.xy, poses.xy[-1:].repeat(held, 0)])
    salute = np.concatenate([np.ones(held), np.zeros(len(poses)), np.ones(held)])
    whole = replace(poses, xy=xy, time=np.arange(len(xy)) / 30, confidence=None)
    return Recording(whole, ((),) * len(xy), salute)


def faults_of(poses: PoseSequence, start: float, end: float) -> list[FaultKind]:
    found = find_demonstration_faults(saluted(poses), start, end)
    return [each.kind for each in found if each.kind is not FaultKind.no_hand]


def eased(*points: tuple[float, float]) -> PoseSequence:
    """Draw from point to point, slower at the corners."""
    sides, shape = len(points) - 1, corners(*points)
    return recording(
        lambda share: shape((np.floor(share * sides) + _ease(share * sides % 1)) / sides),
        frames=25 * sides,
    )


def _ease(share: FloatArray) -> FloatArray:
    return share**2 * (3 - 2 * share)


def test_a_stroke_from_salute_to_salute_still_holds_the_ways() -> None:
    poses = eased(SALUTE, *HOOK, SALUTE)
    start, end = 1.0, 1.0 + poses.time[-1]
    assert faults_of(poses, start + 0.05, end - 0.05) == [FaultKind.reaches_salute]
    (fault,) = [
        each
        for each in find_demonstration_faults(saluted(poses), start + 0.05, end - 0.05)
        if each.kind is FaultKind.reaches_salute
    ]
    assert (fault.start, fault.end) == pytest.approx((start + 0.83, end - 0.83), abs=0.15)
    assert fault.describe("hook") == (
        "The demonstration of 'hook' still holds the way from the salute. Set its range."
    )
    # Cut to the better range it has none.
    assert faults_of(poses, start + 0.83, end - 0.83) == []


def test_keypoints_that_jump_and_another_body_are_faults() -> None:
    shown = recording(corners(*HOOK))
    assert faults_of(shown, 1.0, 1.0 + shown.time[-1])[:1] != [FaultKind.keypoints_jumped]
    end = 1.0 + shown.time[-1]
    assert FaultKind.keypoints_jumped in faults_of(leap(shown), 1.1, end - 0.1)
    assert FaultKind.other_person in faults_of(change_body(shown), 1.1, end - 0.1)


def test_a_keypoint_that_is_not_seen_is_a_fault() -> None:
    shown = recording(corners(*HOOK))
    xy = shown.xy.copy()
    xy[20:40, shown.landmarks.index("right_wrist")] = np.nan
    found = faults_of(replace(shown, xy=xy), 1.1, shown.time[-1] + 0.9)
    assert FaultKind.keypoints_missing in found


def test_a_clip_without_hands_and_salutes_needs_the_arm_trigger() -> None:
    shown = recording(corners(*HOOK))
    blind = Recording(shown, ((),) * len(shown), np.zeros(len(shown)))
    (fault,) = find_demonstration_faults(blind, 0.0, float(shown.time[-1]))
    assert (fault.kind, fault.remedy) == (FaultKind.no_hand, "arm_trigger")
