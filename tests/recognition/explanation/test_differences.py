"""Differences: a known fault is reported by its kind, at its time and joint."""

from dataclasses import replace

import numpy as np
import pytest

from app.recognition import Gesture, PoseSequence
from app.recognition.explanation.differences import Difference, find_differences
from app.recognition.explanation.pairing import Pairing
from app.recognition.features.traversals import AS_SHOWN
from app.recognition.gestures.demonstration import condense
from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from tests.recognition.damaged_poses import with_sides_exchanged
from tests.recognition.strategies import Shape, circle, line, recording, square, wedge

START = 5.0
"""Time in seconds at which the queries of these tests begin."""


def corners(*points: tuple[float, float]) -> Shape:
    def shape(share: FloatArray) -> FloatArray:
        at = np.linspace(0, 1, len(points))
        return np.stack(
            [np.interp(share, at, [point[axis] for point in points]) for axis in range(2)], axis=1
        )

    return shape


HOOK = ((-1.2, -0.4), (-0.4, -0.4), (-0.4, 0.4), (-0.9, 0.4))
hook = corners(*HOOK)


def told(
    query: PoseSequence, shape: Shape = hook, *, sees_direction: bool = True
) -> tuple[Difference, ...]:
    gesture = Gesture.from_demonstration("hook", recording(shape))
    trajectory = condense(Trajectory.from_poses(query))
    pairing = Pairing.of(trajectory, gesture, AS_SHOWN, start=START)
    assert pairing is not None
    return find_differences(pairing, sees_direction=sees_direction)


def mirrored(shape: Shape) -> Shape:
    return lambda share: shape(share) * (-1.0, 1.0) + (-1.6, 0.0)


def test_the_same_gesture_has_no_difference() -> None:
    assert told(recording(hook, jitter=0.005)) == ()
    assert told(recording(circle, jitter=0.005), circle) == ()


def test_the_other_way_round_is_a_difference_of_direction() -> None:
    query = recording(lambda share: hook(1 - share))
    first = told(query)[0]
    assert first.kind == "direction"
    assert first.share > 0.9
    assert first.landmark == "right_wrist"
    assert first.start == pytest.approx(START, abs=0.25)


def test_to_voters_that_see_drawings_both_ways_round_are_the_same() -> None:
    query = recording(lambda share: hook(1 - share))
    assert "direction" not in {each.kind for each in told(query, sees_direction=False)}


@pytest.mark.parametrize(
    ("query", "kind"),
    [
        (recording(mirrored(hook)), "side"),
        (recording(hook, hand="left_wrist"), "hand"),
        (recording(mirrored(hook), hand="left_wrist"), "hand"),
    ],
)
def test_the_wrong_side_is_named(query: PoseSequence, kind: str) -> None:
    first = told(query)[0]
    assert first.kind == kind
    assert first.share > 0.9


def test_a_last_side_that_is_missing_is_missing_after_the_end() -> None:
    query = recording(corners(*HOOK[:3]), frames=45)
    first = told(query)[0]
    assert first.kind == "missing"
    assert first.start == first.end == pytest.approx(START + 44 / 30, abs=0.1)
    assert "the last" in first.words
    # The third of three sides is shown in the last third of the demonstration, 2 s long.
    begins = float(first.words.split("(")[1].split(" to ")[0])
    assert begins == pytest.approx(4 / 3, abs=0.3)


def test_a_first_side_that_is_missing_is_missing_before_the_start() -> None:
    first = told(recording(corners(*HOOK[1:]), frames=45))[0]
    assert first.kind == "missing"
    assert first.start == pytest.approx(START, abs=0.25)
    assert "is missing before 5." in first.words


def test_what_is_too_much_is_told_with_its_time() -> None:
    query = recording(corners((-0.2, 1.2), (-0.7, 1.0), *HOOK), frames=90)
    first = told(query)[0]
    assert first.kind == "extra"
    assert first.start == pytest.approx(START, abs=0.25)
    assert first.end == pytest.approx(START + 2 / 5 * 90 / 30, abs=0.5)


def test_another_course_is_told_with_its_time_joint_and_directions() -> None:
    query = recording(corners(*HOOK[:3], (0.1, 0.4)))
    (first, *_) = told(query)
    assert (first.kind, first.landmark) == ("shape", "right_wrist")
    assert first.start is not None
    assert first.end is not None
    assert START + 1 < first.start < first.end <= START + 2
    assert "the right wrist goes right where 'hook' goes left" in first.words


def test_exchanged_sides_are_told_with_the_moments() -> None:
    query = with_sides_exchanged(recording(hook), [*range(20, 26), *range(34, 40)])
    first = told(query)[0]
    assert first.kind == "exchanged_sides"
    assert first.start == pytest.approx(START + 20 / 30, abs=0.07)
    assert first.end == pytest.approx(START + 39 / 30, abs=0.07)
    assert "12 of 60 moments" in first.words
    assert f"between {first.start:.1f} and {first.end:.1f} s" in first.words


def scaled(factor: float, shift: tuple[float, float] = (0.0, 0.0)) -> Shape:
    return lambda share: (hook(share) - (-0.7, 0.0)) * factor + (-0.7, 0.0) + shift


@pytest.mark.parametrize(
    ("query", "kind", "words"),
    [
        (recording(hook, frames=180), "tempo", "times slower"),
        (recording(hook, frames=20), "tempo", "times quicker"),
        (recording(scaled(1.0, (0.0, -0.8))), "place", "0.8 torso lengths higher"),
        (recording(scaled(1.0, (1.3, 0.0))), "place", "to the image's right"),
        (recording(scaled(2.5)), "size", "2.5 times larger"),
    ],
)
def test_what_changes_no_path_is_told_beside_it(query: PoseSequence, kind: str, words: str) -> None:
    (only,) = told(query)
    assert (only.kind, only.share) == (kind, 0.0)
    assert words in only.words


def bent(degrees: float) -> PoseSequence:
    """Record a hook with the hand turned clockwise from the forearm by an angle in the image."""
    poses = recording(hook)
    xy = poses.xy.copy()
    elbow, wrist, index, pinky = (
        poses.landmarks.index(f"right_{part}") for part in ("elbow", "wrist", "index", "pinky")
    )
    angle = np.radians(degrees)
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    xy[:, index] = xy[:, pinky] = xy[:, wrist] + 0.4 * (xy[:, wrist] - xy[:, elbow]) @ turn
    return replace(poses, xy=xy)


@pytest.mark.parametrize(("shown", "way"), [(40, "80 degrees farther clockwise"), (0, None)])
def test_a_wrist_that_is_bent_otherwise_is_told_by_degrees(shown: float, way: str | None) -> None:
    gesture = Gesture.from_demonstration("hook", bent(-shown))
    trajectory = condense(Trajectory.from_poses(bent(shown)))
    pairing = Pairing.of(trajectory, gesture, AS_SHOWN)
    assert pairing is not None
    found = find_differences(pairing, sees_direction=True)
    assert [each.kind for each in found] == ([] if way is None else ["wrist"])
    assert all(way is not None and way in each.words for each in found)
    assert find_differences(pairing, sees_direction=False) == ()


def test_a_joint_that_was_not_seen_is_told_with_the_time() -> None:
    query = recording(hook)
    xy = query.xy.copy()
    xy[15:40, query.landmarks.index("right_wrist")] = np.nan
    hidden = PoseSequence(
        landmarks=POSE_LANDMARKS, xy=xy, time=query.time, frame_size=query.frame_size
    )
    (unseen,) = [each for each in told(hidden) if each.kind == "unseen"]
    assert (unseen.start, unseen.end) == pytest.approx((START + 14 / 30, START + 40 / 30), abs=0.01)
    assert "right wrist" in unseen.words


@pytest.mark.parametrize("shape", [circle, line, square, wedge])
def test_every_difference_is_plain_and_lies_within_the_query(shape: Shape) -> None:
    query = recording(shape, jitter=0.01)
    for difference in told(query):
        assert 0.0 <= difference.share <= 1.0
        assert difference.to_dict()["words"] == difference.words
        if difference.start is not None and difference.end is not None:
            assert START <= difference.start <= difference.end <= START + 2
