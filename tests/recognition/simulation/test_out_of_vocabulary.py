"""Out-of-vocabulary movements: made from the language's gestures, but none of them."""

import numpy as np
from hypothesis import given

from app.recognition import Gesture, PoseSequence
from app.recognition.gestures.demonstration import condense
from app.recognition.poses.trajectory import Trajectory
from app.recognition.simulation.background_motion import MANNERS
from app.recognition.simulation.out_of_vocabulary import (
    MOST_SPLICES,
    draw_out_of_vocabulary,
    splice,
    splice_all,
)
from tests.recognition.strategies import SHAPES, circle, line, recording, recordings

WRIST = ("right_wrist",)


def shown(poses: PoseSequence) -> Trajectory:
    return condense(Trajectory.from_poses(poses)).select(WRIST)


@given(recordings(), recordings())
def test_a_splice_goes_on_without_a_jump(before: PoseSequence, after: PoseSequence) -> None:
    first, second = shown(before), shown(after)
    movement = splice(first, second)
    assert (np.diff(movement.time) > 0).all()
    steps = [
        np.linalg.norm(np.diff(each.xy[:, 0], axis=0), axis=1).max() for each in (first, second)
    ]
    assert np.linalg.norm(np.diff(movement.xy[:, 0], axis=0), axis=1).max() <= max(steps) + 1e-9


def test_a_splice_begins_as_the_one_and_ends_as_the_other() -> None:
    first, second = shown(recording(circle)), shown(recording(line, frames=90))
    movement = splice(first, second)
    np.testing.assert_array_equal(movement.xy[:20], first.xy[:20])
    np.testing.assert_allclose(np.diff(movement.xy[-40:], axis=0), np.diff(second.xy[-40:], axis=0))


def test_only_what_two_demonstrations_share_is_spliced() -> None:
    left = Trajectory.from_poses(recording(line, hand="left_wrist")).select(["left_wrist"])
    assert splice_all([shown(recording(circle)), left]) == ()
    assert splice_all([left]) == ()
    assert len(splice_all([left] * 3)) == 0
    many = [shown(recording(circle, frames=30 + index)) for index in range(MOST_SPLICES + 3)]
    assert len(splice_all(many)) == MOST_SPLICES


def test_a_language_has_accidental_movements_and_splices_against_it() -> None:
    gestures = [
        Gesture.from_demonstration(name, recording(shape)) for name, shape in SHAPES.items()
    ]
    assert len(draw_out_of_vocabulary(gestures)) == len(MANNERS) + len(SHAPES)
