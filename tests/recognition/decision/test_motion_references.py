"""Traversals of the gestures of a language: which are compared with a query, and which fit."""

from dataclasses import replace

import numpy as np
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
PATH = [voter.name for voter in MOTION_VOTERS].index("path")


def begun_at(share: float, shape: Shape, *, backward: bool) -> Shape:
    """Draw a closed figure from another place, or the other way round."""
    return lambda way: shape(((-way if backward else way) + share) % 1)


def described(shape: Shape) -> dict[str, FloatArray]:
    poses = recording(shape, frames=50, jitter=0.01, seed=3, landmarks=ARMS)
    return describe_movement(condense(Trajectory.from_poses(poses)), REFERENCES.landmarks)


@given(
    share=st.floats(0, 1, exclude_max=True),
    shape=st.sampled_from([circle, square]),
    backward=st.booleans(),
)
def test_a_closed_figure_is_found_wherever_it_begins_and_whichever_way_it_goes(
    share: float, shape: Shape, backward: bool
) -> None:
    distances = REFERENCES.distances(described(begun_at(share, shape, backward=backward)))[PATH]
    nearest = int(distances.argmin())
    assert GESTURES[REFERENCES.gestures[nearest]].label == shape.__name__
    assert REFERENCES.traversals[nearest].backward is backward
    assert distances[nearest] < 0.05


@pytest.mark.parametrize("share", [0.0, 0.3, 0.6])
def test_most_readings_are_spared_and_never_the_one_as_shown(share: float) -> None:
    query = described(begun_at(share, circle, backward=False))
    rows = REFERENCES.find_promising(query["path"])
    assert set(REFERENCES.as_shown) <= set(rows)
    assert len(rows) < len(REFERENCES) / 2
    compared = np.isfinite(REFERENCES.distances(query)[PATH])
    np.testing.assert_array_equal(np.flatnonzero(compared), rows)


def test_voters_asked_together_measure_what_each_measures_alone() -> None:
    query = described(wedge)
    rows = REFERENCES.find_promising(query["path"])
    together = REFERENCES.distances(query)[:, rows]
    for voter, row in zip(MOTION_VOTERS, together, strict=True):
        alone = voter.distances(query[voter.name], REFERENCES.descriptors[voter.name][rows])
        # Step costs are in single precision.
        np.testing.assert_allclose(row, alone, rtol=1e-5, atol=1e-6)


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
