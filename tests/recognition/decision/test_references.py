"""References: demonstrations, mirror images and traversals, and which are compared with a query."""

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.decision.references import References, describe_query, find_nearest
from app.recognition.gestures.demonstration import condense
from app.recognition.gestures.switches import Switches
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.voters.registry import MOTION_VOTERS
from tests.recognition.demonstrations import ARMS, shown
from tests.recognition.strategies import Shape, circle, line, recording, square, wedge

GESTURES = [shown(s.__name__, s) for s in (circle, square, wedge, line)]
REFERENCES = References.of(GESTURES)
PATH, VELOCITY = (
    [voter.name for voter in MOTION_VOTERS].index(name) for name in ("path", "velocity")
)


def begun_at(share: float, shape: Shape, *, backward: bool) -> Shape:
    """Draw a closed figure from another place, or the other way round."""
    return lambda way: shape(((-way if backward else way) + share) % 1)


def described(shape: Shape) -> dict[str, FloatArray]:
    poses = recording(shape, frames=50, jitter=0.01, seed=3, landmarks=ARMS)
    return describe_query(condense(Trajectory.from_poses(poses)), REFERENCES.landmarks)


def measure(query: dict[str, FloatArray], rows: npt.NDArray[np.intp]) -> FloatArray:
    return np.array(
        [
            voter.distances(query[voter.name], REFERENCES.described[voter.name][rows])
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
    own = np.array([GESTURES[each].label == shape.__name__ for each in REFERENCES.rows[rows]])
    nearest = int(np.where(own, distances, np.inf).argmin())
    assert REFERENCES.traversals[rows[nearest]].backward is backward
    assert distances[nearest] < 0.35
    # Halfway between two of the eight starting points a circle is as near as a square.
    assert distances[nearest] < 1.05 * distances.min()


@pytest.mark.parametrize("share", [0.0, 0.3, 0.6])
def test_most_readings_are_spared_and_never_the_one_as_shown(share: float) -> None:
    query = described(begun_at(share, circle, backward=False))
    rows = REFERENCES.find_promising(query["path"])
    assert set(REFERENCES.as_shown) <= set(rows)
    assert len(rows) < len(REFERENCES) / 2


def test_the_promising_traversals_are_measured_as_each_voter_measures_alone() -> None:
    query = described(wedge)
    rows = REFERENCES.find_promising(query["path"])
    # Step costs are roots of numbers in single precision.
    np.testing.assert_allclose(
        REFERENCES.measure(query, rows), measure(query, rows), rtol=1e-4, atol=3e-3
    )


def test_the_correction_is_one_for_the_same_movement_and_grows_with_other_joints() -> None:
    query = described(circle)
    factors = REFERENCES.correct(query["shares"])
    own = REFERENCES.rows == 0
    assert factors[own].max() < 1.1
    moved = query["shares"].copy()
    moved[:, -2:] = moved[:, ::-1][:, -2:] + 1.0
    assert (REFERENCES.correct(moved / np.linalg.norm(moved, axis=1, keepdims=True)) >= 1).all()


def test_references_are_remembered_until_a_gesture_changes() -> None:
    assert References.of([*GESTURES]) is References.of(GESTURES)
    one_way = replace(GESTURES[0], switches=replace(GESTURES[0].switches, direction="on"))
    changed = References.of([one_way, *GESTURES[1:]])
    assert len(changed) < len(REFERENCES)
    assert not any(
        traversal.backward
        for index, traversal in zip(changed.rows, changed.traversals, strict=True)
        if index == 0
    )


def test_first_come_the_gestures_then_further_demonstrations_then_mirror_images() -> None:
    line_twice = shown("line", line).with_demonstration(
        recording(line, jitter=0.02, seed=1, landmarks=ARMS)
    )
    mirrored = replace(shown("wedge", wedge), switches=Switches(mirror="on"))
    of = References.of([line_twice, mirrored, shown("circle", circle)])
    assert [each.label for each in of.shown] == ["line", "wedge", "circle", "line", "wedge"]
    assert of.owners.tolist() == [0, 1, 2, 0, 1]
    assert of.demonstrations.tolist() == [0, 0, 0, 1, 0]
    assert of.mirrored.tolist() == [False, False, False, False, True]


def test_each_gesture_is_as_near_as_its_nearest_reference() -> None:
    scores, owners = np.array([3.0, 2.0, np.inf, 1.0, 4.0, 1.0]), np.array([0, 1, 2, 0, 1, 0])
    assert find_nearest(scores, owners, 4).tolist() == [3, 1, -1, -1]
