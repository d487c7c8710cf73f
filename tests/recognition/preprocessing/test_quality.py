"""Recordings of insufficient quality get a reason in place of a label."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given

from app.recognition import Gesture, GestureError, Language, PoseSequence, Recognizer
from app.recognition.gestures.switches import Switches
from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.recognition.preprocessing.quality import QualityFault, find_fault
from app.recognition.preprocessing.repair import pair_sides
from tests.recognition.strategies import SHAPES, circle, recording, recordings

WRIST = POSE_LANDMARKS.index("right_wrist")
HAND = ("right_wrist",)


@pytest.fixture(scope="module")
def recognizer() -> Recognizer:
    gestures = [
        Gesture.from_demonstration(label, recording(shape)) for label, shape in SHAPES.items()
    ]
    return Recognizer(Language(name="shapes", gestures=gestures))


def unseen(poses: PoseSequence, frames: slice) -> PoseSequence:
    xy = poses.xy.copy()
    xy[frames, WRIST] = np.nan
    return replace(poses, xy=xy)


def leaping(poses: PoseSequence) -> PoseSequence:
    """Displace the wrist in two of three frames."""
    xy = poses.xy.copy()
    random = np.random.default_rng(0)
    bad = np.flatnonzero(np.arange(len(xy)) % 3 > 0)
    xy[bad, WRIST] += random.normal(0, 400, (len(bad), 2))
    return replace(poses, xy=xy)


@given(recordings())
def test_a_recording_of_a_gesture_is_good_enough(poses: PoseSequence) -> None:
    assert find_fault(poses, HAND) is None


def test_a_clock_that_does_not_run_in_seconds_is_no_fault() -> None:
    poses = recording(circle)
    assert find_fault(replace(poses, time=poses.time * 30), HAND) is None
    assert find_fault(replace(poses, time=poses.time / 30), HAND) is None


def test_half_a_gesture_out_of_view_is_told_with_its_share() -> None:
    poses = unseen(recording(circle), slice(10, 58))
    words = "the right wrist is followed for only 17% of its 2.0 s"
    assert find_fault(poses, HAND) == QualityFault("not_followed", words)
    assert find_fault(poses, ("left_wrist",)) is None


def test_short_gaps_are_no_fault() -> None:
    xy = recording(circle).xy.copy()
    xy[np.arange(60) % 5 > 0, WRIST] = np.nan
    assert find_fault(replace(recording(circle), xy=xy), HAND) is None


def test_leaps_are_told_with_their_share() -> None:
    told = find_fault(leaping(recording(circle)), HAND)
    assert told is not None
    assert told.kind == "leaps"
    assert told.words.startswith("the right wrist leaps over a torso length in ")


@pytest.mark.parametrize("frames", [0, 1, 4])
def test_a_few_frames_are_too_few(frames: int) -> None:
    words = f"it has {frames} frames, and at least 5 are needed"
    fault = find_fault(recording(circle, frames=frames), HAND)
    assert fault == QualityFault("few_frames", words)


def test_an_empty_recording_shows_nothing() -> None:
    poses = recording(circle)
    nothing = replace(poses, xy=np.full_like(poses.xy, np.nan))
    words = "none of its 60 frames shows a landmark"
    assert find_fault(nothing, HAND) == QualityFault("nothing_seen", words)


@pytest.mark.parametrize("poor", [leaping, lambda poses: unseen(poses, slice(15, 59))])
def test_recognition_names_the_fault_and_no_gesture(
    recognizer: Recognizer, poor: Callable[[PoseSequence], PoseSequence]
) -> None:
    result = recognizer.recognize(poor(recording(circle)))
    assert result.label is None
    assert result.nearest in SHAPES
    assert result.fault is not None
    again = type(result).from_dict(result.to_dict())
    assert (again.fault, again.fault_kind) == (result.fault, result.fault_kind)


def test_profile_paper_judges_whatever_it_gets(recognizer: Recognizer) -> None:
    result = Recognizer(recognizer.language, "paper").recognize(leaping(recording(circle)))
    assert result.label is not None
    assert result.fault is None


def test_the_mirror_image_is_judged_by_the_hand_that_shows_it(recognizer: Recognizer) -> None:
    poses = recording(circle)
    mirrored = replace(recognizer.language.gesture("circle"), switches=Switches(mirror="on"))
    either = Recognizer(Language(name="either hand", gestures=[mirrored]))
    xy = poses.xy.copy()
    xy[..., 0] = 640 - xy[..., 0]
    left, right = pair_sides(poses.landmarks)
    xy[:, [*left, *right]] = xy[:, [*right, *left]]
    other_hand = unseen(replace(poses, xy=xy), slice(1, None))
    assert either.recognize(other_hand).label == "circle"


def test_a_poor_demonstration_is_refused_with_the_reason() -> None:
    with pytest.raises(GestureError, match="too poor to use: the right wrist leaps"):
        Gesture.from_demonstration("circle", leaping(recording(circle)))
