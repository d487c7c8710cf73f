"""Traversals of the gestures of a language: which are compared with a query, and which fit."""

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.decision.motion_references import MotionReferences, describe_movement
from app.recognition.gestures.demonstration import condense
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.voters.registry import MOTION_VOTERS
from tests.recognition.demonstrations import ARMS, shown
from tests.recognition.strategies import Shape, circle, line, recording, square, wedge

GESTURES = [shown(s.__name__, s) for s in (circle, square, wedge, line)]
REFERENCES = MotionReferences.of(GESTURES)
PATH, VELOCITY = (
    [voter.name for voter in MOTION_VOTERS].index(name) for name in ("path", "velocity")
)


def begun_at(share: float, shape: Shape, *, backward: bool) -> Shape:
    """Draw a closed figure from another place, or the other way round."""
    return lambda way: shape(((-way if backward else way) + share) % 1)


def described(shape: Shape) -> dict[str, FloatArray]:
    poses = recording(shape, frames=50, jitter=0.01, seed=3, landmarks=ARMS)
    return describe_movement(condense(Trajectory.from_poses(poses)), REFERENCES.landmarks)


def measure(query: dict[str, FloatArray], rows: npt.NDArray[np.intp]) -> FloatArray:
    return np.array(
        [
            voter.distances(query[voter.name], REFERENCES.descriptors[voter.name][rows])
            for voter in MOTION_VOTERS
        ]
    )


@given(
    share=st.floats(0, 1, exclude_max=True),
    shape=st.sampled_from([circle, square]),
    backward=st.booleans(),
)
def test_a_closed_figure_is_found_wherever_it_begins_and_whichever_way_it_goes(
    share: float, shape: Shape, backward: bool
) -> None:
    query = described(begun_at(share, shape, backward=backward))
    rows = REFERENCES.find_promising(query["path"])
    distances = measure(query, rows)[[PATH, VELOCITY]].mean(axis=0)
    nearest = int(rows[distances.argmin()])
    assert GESTURES[REFERENCES.gestures[nearest]].label == shape.__name__
    assert REFERENCES.traversals[nearest].backward is backward
    assert distances.min() < 0.35


@pytest.mark.parametrize("share", [0.0, 0.3, 0.6])
def test_most_readings_are_spared_and_never_the_one_as_shown(share: float) -> None:
    query = described(begun_at(share, circle, backward=False))
    rows = REFERENCES.find_promising(query["path"])
    assert set(REFERENCES.as_shown) <= set(rows)
    assert len(rows) < len(REFERENCES) / 2


def test_the_nearest_traversals_are_measured_as_each_voter_measures_alone() -> None:
    query, count = described(wedge), len(GESTURES)
    weights = np.ones(len(MOTION_VOTERS))
    nearest = REFERENCES.find_nearest(query, weights, weights, count)
    alone = measure(query, nearest.rows)
    # Step costs are roots of numbers in single precision.
    np.testing.assert_allclose(nearest.distances, alone, rtol=1e-4, atol=3e-3)


def test_the_correction_is_one_for_the_same_movement_and_grows_with_other_joints() -> None:
    query = described(circle)
    factors = REFERENCES.correct(query["shares"])
    own = REFERENCES.gestures == 0
    assert factors[own].max() < 1.1
    moved = query["shares"].copy()
    moved[:, -2:] = moved[:, ::-1][:, -2:] + 1.0
    assert (REFERENCES.correct(moved / np.linalg.norm(moved, axis=1, keepdims=True)) >= 1).all()


def test_references_are_remembered_until_what_they_depend_on_changes() -> None:
    renamed = [replace(gesture, label=f"{gesture.label} again") for gesture in GESTURES]
    assert MotionReferences.of(renamed) is MotionReferences.of(GESTURES)
    one_way = replace(GESTURES[0], switches=replace(GESTURES[0].switches, direction="on"))
    changed = MotionReferences.of([one_way, *GESTURES[1:]])
    assert len(changed) < len(REFERENCES)
    assert not any(
        traversal.backward
        for gesture, traversal in zip(changed.gestures, changed.traversals, strict=True)
        if gesture == 0
    )
