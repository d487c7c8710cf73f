"""A demonstration becomes a gesture, or is refused with what to do about it."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given

from app.recognition import Gesture, GestureError, PoseSequence
from app.recognition.features.trajectory_image import draw
from app.recognition.gestures.demonstration import MAX_LANDMARKS, MAX_MOMENTS, condense
from app.recognition.gestures.gesture import MAX_LABEL_LENGTH
from app.recognition.poses.trajectory import Trajectory
from app.recognition.voters.registry import PAPER_VOTERS
from tests.recognition.strategies import circle, recording, recordings, rest


def test_a_demonstration_becomes_a_gesture() -> None:
    gesture = Gesture.from_demonstration(
        "circle", recording(circle), description="a large one", command={"mode": "hold"}
    )
    assert gesture.label == "circle"
    assert gesture.salient == ("right_wrist",)
    assert gesture.image.shape == (224, 224)
    assert gesture.image.dtype == np.uint8
    assert gesture.trajectory is not None
    assert gesture.trajectory.unit == "torso_length"
    assert tuple(gesture.descriptors) == tuple(voter.name for voter in PAPER_VOTERS)
    assert gesture.description == "a large one"
    assert gesture.command == {"mode": "hold"}


def test_the_author_can_choose_the_salient_landmarks() -> None:
    chosen = ("right_wrist", "left_wrist")
    gesture = Gesture.from_demonstration("circle", recording(circle), salient=chosen)
    assert gesture.salient == ("left_wrist", "right_wrist")
    with pytest.raises(GestureError, match="'tail' is not in this recording"):
        Gesture.from_demonstration("circle", recording(circle), salient=("tail",))


def test_landmarks_of_another_set_make_a_gesture() -> None:
    marker = recording(circle, hand="marker", landmarks=("marker", "base"))
    gesture = Gesture.from_demonstration("circle", marker)
    assert gesture.salient == ("marker",)
    assert gesture.trajectory is not None
    assert gesture.trajectory.landmarks == ("marker", "base")
    assert gesture.trajectory.unit == "extent"


@pytest.mark.parametrize("frames", [0, 1, 2])
@pytest.mark.withstands(row="H12")
def test_a_demonstration_of_hardly_a_frame_is_refused(frames: int) -> None:
    with pytest.raises(GestureError, match=f"has {frames} frames, a gesture needs at least 3"):
        Gesture.from_demonstration("blink", recording(circle, frames=frames))


def test_a_demonstration_in_which_nothing_moves_is_refused_with_a_way_out() -> None:
    with pytest.raises(
        GestureError, match=r"nothing moves in the demonstration of 'rest': .* show the gesture"
    ):
        Gesture.from_demonstration("rest", recording(rest, jitter=0.01))


def test_choosing_landmarks_does_not_admit_stillness() -> None:
    with pytest.raises(GestureError, match=r"nothing moves .*left_wrist has the largest"):
        Gesture.from_demonstration("rest", recording(circle), salient=("left_wrist",))


def test_a_demonstration_that_shows_nobody_is_refused() -> None:
    poses = recording(circle)
    nobody = replace(poses, xy=np.full_like(poses.xy, np.nan))
    with pytest.raises(GestureError, match="'gone' is empty: none of the 60 frames shows"):
        Gesture.from_demonstration("gone", nobody)


@pytest.mark.parametrize("label", ["", "  ", "a\nb", "x" * (MAX_LABEL_LENGTH + 1), None, "\udc00"])
def test_a_label_must_be_readable(label: str) -> None:
    with pytest.raises(GestureError, match="label must be"):
        Gesture.from_demonstration(label, recording(circle))


@pytest.mark.parametrize("label", ["../../x", "<script>alert(1)</script>", "sígueme 🤿"])
def test_a_label_is_text_and_nothing_else(label: str) -> None:
    assert Gesture.from_demonstration(label, recording(circle)).label == label


def deep(levels: int) -> dict[str, object]:
    command: dict[str, object] = {}
    for _ in range(levels):
        command = {"then": command}
    return command


@pytest.mark.parametrize(
    ("command", "complaint"),
    [
        (7, "must be text of at most 2000 characters, got 7"),
        ("x" * 2001, "got 2001 characters"),
        ("\ud800", "half a surrogate pair"),
        ({"speed": float("nan")}, "plain JSON: /speed: not a number"),
        ({"speed": 2**60}, "beyond 9007199254740991"),
        ({"when": object()}, "not JSON serializable"),
        ({"text": "\udc00"}, "surrogate"),
        ({"text": "x" * 4000}, "too large"),
        (deep(20), "nested 21 deep, the limit is 16"),
        (deep(5000), "plain JSON"),
    ],
    ids=lambda value: repr(value)[:30] if not isinstance(value, dict) else "object",
)
def test_a_command_that_no_file_could_hold_is_refused(command: object, complaint: str) -> None:
    with pytest.raises(GestureError, match=complaint):
        Gesture.from_demonstration("circle", recording(circle), command=command)  # type: ignore[arg-type]


def test_a_command_is_the_gestures_own_copy() -> None:
    command = {"speed": 1, "then": ("stop", "wait")}
    gesture = Gesture.from_demonstration("circle", recording(circle), command=command)
    command["speed"] = 2
    assert gesture.command == {"speed": 1, "then": ["stop", "wait"]}


def test_a_description_that_no_file_could_hold_is_refused() -> None:
    for description in ("x" * 2001, "\ud800"):
        with pytest.raises(GestureError, match="text"):
            Gesture.from_demonstration("circle", recording(circle), description=description)


def test_an_image_of_another_kind_is_refused() -> None:
    for image in (np.zeros((100, 100)), np.full((224, 224), 7)):
        with pytest.raises(GestureError, match="must be 224 x 224 of 0 and 255"):
            Gesture(label="x", salient=(), image=image.astype(np.uint8))


def test_a_gesture_cannot_be_changed_from_outside() -> None:
    gesture = Gesture.from_demonstration("circle", recording(circle))
    with pytest.raises(ValueError, match="read-only"):
        gesture.image[0, 0] = 255
    with pytest.raises(ValueError, match="read-only"):
        gesture.descriptors["hu"][0] = 1.0


def test_a_long_demonstration_is_kept_in_a_bounded_number_of_moments() -> None:
    gesture = Gesture.from_demonstration("circle", recording(circle, frames=5000))
    assert gesture.trajectory is not None
    assert len(gesture.trajectory) == MAX_MOMENTS
    assert gesture.trajectory.time[-1] == pytest.approx(4999 / 30, abs=1e-4)


def test_the_upper_body_is_kept_and_faces_and_legs_are_not() -> None:
    gesture = Gesture.from_demonstration("circle", recording(circle))
    assert gesture.trajectory is not None
    kept = set(gesture.trajectory.landmarks)
    assert {"right_wrist", "left_elbow", "left_shoulder", "right_hip", "nose"} <= kept
    assert not kept & {"left_eye", "mouth_left", "right_knee", "left_heel"}


def test_a_chosen_landmark_is_kept_whatever_it_is() -> None:
    gesture = Gesture.from_demonstration(
        "circle", recording(circle), salient=("right_wrist", "left_ankle")
    )
    assert gesture.trajectory is not None
    assert "left_ankle" in gesture.trajectory.landmarks


def test_of_a_large_set_of_landmarks_the_salient_ones_are_kept() -> None:
    names = tuple(f"marker_{index}" for index in range(60))
    gesture = Gesture.from_demonstration(
        "circle", recording(circle, hand="marker_50", landmarks=names)
    )
    assert gesture.salient == ("marker_50",)
    assert gesture.trajectory is not None
    assert len(gesture.trajectory.landmarks) == MAX_LANDMARKS
    assert "marker_50" in gesture.trajectory.landmarks


@given(recordings())
def test_redrawing_a_gesture_changes_nothing(poses: PoseSequence) -> None:
    gesture = Gesture.from_demonstration("stroke", poses)
    again = gesture.redraw()
    np.testing.assert_array_equal(again.image, gesture.image)
    for name, descriptor in gesture.descriptors.items():
        np.testing.assert_array_equal(again.descriptors[name], descriptor)


def test_condensing_bridges_gaps_before_it_resamples() -> None:
    poses = recording(circle, frames=240)
    xy = poses.xy.copy()
    xy[100:104] = np.nan
    whole = condense(Trajectory.from_poses(replace(poses, xy=xy)))
    assert len(whole) == MAX_MOMENTS
    assert np.isfinite(whole.select(["right_wrist"]).xy).all()
    assert not draw(whole.select(["right_wrist"])).empty


def test_condensing_twice_is_condensing_once() -> None:
    once = condense(Trajectory.from_poses(recording(circle, frames=240, jitter=0.01)))
    twice = condense(once)
    np.testing.assert_array_equal(twice.xy, once.xy)
    np.testing.assert_array_equal(twice.time, once.time)


def test_a_gesture_known_by_its_image_alone_is_described_from_it() -> None:
    drawn = Gesture.from_demonstration("circle", recording(circle))
    seen = Gesture(label="circle", salient=drawn.salient, image=drawn.image).redraw()
    assert seen.trajectory is None
    for name, descriptor in drawn.descriptors.items():
        np.testing.assert_array_equal(seen.descriptors[name], descriptor)


def test_of_another_set_of_landmarks_the_hands_are_kept_that_do_not_move() -> None:
    poses = recording(circle).select(["right_wrist", "right_elbow", "left_index"])
    tracked = replace(poses, landmarks=("right_wrist", "right_elbow", "left_hand_tip"))
    gesture = Gesture.from_demonstration("circle", tracked)
    assert gesture.trajectory is not None
    assert gesture.trajectory.landmarks == tracked.landmarks


def test_a_gesture_lists_the_trajectories_of_all_its_demonstrations() -> None:
    once = Gesture.from_demonstration("circle", recording(circle))
    twice = once.with_demonstration(recording(circle, jitter=0.01))
    assert once.trajectories == (once.trajectory,)
    assert len(twice.trajectories) == 2
    assert twice.trajectories[0] is once.trajectory
