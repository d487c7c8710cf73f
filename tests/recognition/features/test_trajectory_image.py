"""The image shows the path, the whole path, wherever and however large it was made."""

from dataclasses import replace
from itertools import pairwise

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition import PoseSequence
from app.recognition.features.contour import BinaryImage
from app.recognition.features.trajectory_image import (
    HIGHEST_POWER,
    MARGIN,
    MIN_EXTENT,
    SIZE,
    STROKE_WIDTH,
    StrokeMoments,
    draw,
    simplify,
)
from app.recognition.gestures.demonstration import condense
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from tests.recognition.strategies import Shape, circle, line, recording, recordings, strokes

SAME_SHAPE = 0.7
"""Intersection over union of two images of one stroke after half a stroke's shift: strokes are
five pixels wide, so images that differ by jitter in the samples overlap by more than this."""


def image_of(poses: PoseSequence, *names: str) -> BinaryImage:
    trajectory = condense(Trajectory.from_poses(poses))
    return draw(trajectory.select(names or ("right_wrist",))).image


def path(*points: tuple[float, float]) -> Trajectory:
    xy: FloatArray = np.array(points, dtype=np.float64)[:, None]
    return Trajectory(
        landmarks=("marker",), xy=xy, time=np.arange(len(xy)) / 10, unit="torso_length"
    )


def overlap(one: BinaryImage, other: BinaryImage) -> float:
    return float(np.count_nonzero(one & other) / np.count_nonzero(one | other))


@given(
    poses=recordings(),
    scale=st.floats(0.2, 5.0),
    shift=st.tuples(st.floats(-300, 300), st.floats(-300, 300)),
)
def test_translating_and_scaling_a_recording_leaves_its_image(
    poses: PoseSequence, scale: float, shift: tuple[float, float]
) -> None:
    nearer = replace(poses, xy=poses.xy * scale + shift)
    np.testing.assert_array_equal(image_of(nearer), image_of(poses))


@given(recordings(), st.floats(-100, 100))
def test_shifting_the_clock_leaves_the_image(poses: PoseSequence, offset: float) -> None:
    later = replace(poses, time=poses.time + offset)
    np.testing.assert_array_equal(image_of(later), image_of(poses))


@given(recordings())
def test_mirroring_a_recording_mirrors_its_image(poses: PoseSequence) -> None:
    mirrored = image_of(replace(poses, xy=poses.xy * (-1, 1)))
    # Pixels on the line between two columns go right in either image, so strokes may be a pixel
    # off.
    assert overlap(mirrored, np.ascontiguousarray(image_of(poses)[:, ::-1])) > SAME_SHAPE


@given(recordings())
def test_twice_the_frame_rate_gives_the_same_shape(poses: PoseSequence) -> None:
    trajectory = Trajectory.from_poses(poses).select(["right_wrist"])
    doubled = trajectory.resample_in_time(2 * len(trajectory) - 1)
    assert overlap(draw(condense(doubled)).image, draw(condense(trajectory)).image) > SAME_SHAPE


@given(recordings())
def test_strokes_are_never_clipped_and_fill_the_frame(poses: PoseSequence) -> None:
    image = image_of(poses)
    assert image.shape == (SIZE, SIZE)
    assert image.dtype == np.uint8
    assert set(np.unique(image)) == {0, 255}
    rows, columns = np.nonzero(image)
    border = MARGIN - STROKE_WIDTH
    assert min(rows.min(), columns.min()) >= border
    assert max(rows.max(), columns.max()) < SIZE - border
    longer = max(np.ptp(rows), np.ptp(columns))
    assert longer >= SIZE - 2 * MARGIN - 1


def test_the_aspect_of_the_motion_is_kept() -> None:
    image = draw(path((0, 0), (2, 0), (2, 1), (0, 1), (0, 0))).image
    rows, columns = np.nonzero(image)
    width = np.ptp(columns) + 1 - STROKE_WIDTH
    height = np.ptp(rows) + 1 - STROKE_WIDTH
    assert width / height == pytest.approx(2, rel=0.03)


def test_x_points_right_and_y_down() -> None:
    image = draw(path((0, 0), (1, 0), (1, 1))).image
    assert image[MARGIN, SIZE - 1 - MARGIN] == 255  # the corner, top right
    assert image[SIZE - 1 - MARGIN, MARGIN] == 0


def test_all_salient_keypoints_share_one_frame() -> None:
    both = recording(circle)
    xy = both.xy.copy()
    left = both.landmarks.index("left_wrist")
    xy[:, left, 0] += np.linspace(0, 30, len(both))
    image = image_of(replace(both, xy=xy), "left_wrist", "right_wrist")
    # The left wrist rests on the diver's left, the image's right, and lower than the circle.
    rows, columns = np.nonzero(image)
    assert columns.max() > SIZE - 2 * MARGIN
    assert rows[columns > SIZE / 2].min() > SIZE / 2


def test_a_gap_splits_the_stroke() -> None:
    nowhere = (np.nan, np.nan)
    image = draw(path((0, 0), (1, 0), nowhere, (2, 0), (3, 0))).image
    middle = SIZE // 2
    assert not image[:, middle].any()
    assert image[middle, MARGIN]
    assert image[middle, SIZE - 1 - MARGIN]


def test_a_straight_path_is_drawn_as_one_however_it_jitters() -> None:
    jittery = line(np.linspace(0, 1, 50))
    jittery[:, 1] += 0.005 * (-1) ** np.arange(50)
    smooth = draw(path(*line(np.linspace(0, 1, 50)))).image
    assert overlap(draw(path(*jittery)).image, smooth) > SAME_SHAPE


def test_a_closed_path_keeps_all_its_sides() -> None:
    image = draw(path((0, 0), (1, 0), (1, 1), (0, 1), (0, 0))).image
    near, far = MARGIN, SIZE - 1 - MARGIN
    for row, column in ((near, 100), (100, far), (far, 100), (100, near)):
        assert image[row, column] == 255


@given(strokes(), st.floats(0.001, 0.2))
def test_simplification_keeps_the_ends_and_stays_within_its_tolerance(
    stroke: Shape, tolerance: float
) -> None:
    points = stroke(np.linspace(0, 1, 60))
    corners = simplify(points, tolerance)
    np.testing.assert_array_equal(corners[[0, -1]], points[[0, -1]])
    kept = {tuple(corner) for corner in corners}
    assert kept <= {tuple(point) for point in points}
    assert len(simplify(corners, tolerance)) <= len(corners)
    finely = np.concatenate([np.linspace(one, other, 200) for one, other in pairwise(corners)])
    away = np.linalg.norm(points[:, None] - finely[None], axis=2).min(axis=1)
    assert away.max() <= tolerance + 0.01


def test_simplification_of_a_straight_line_is_its_ends() -> None:
    straight = np.linspace((0, 0), (3, 1), 30)
    np.testing.assert_array_equal(simplify(straight, 0.01), straight[[0, -1]])


@pytest.mark.parametrize(
    "points",
    [
        [(0.0, 0.0)],
        [(np.nan, np.nan), (np.nan, np.nan)],
        [(0.0, 0.0), (0.0, 0.9 * MIN_EXTENT)],
    ],
    ids=["one point", "never seen", "sway"],
)
def test_where_nothing_moves_nothing_is_drawn(points: list[tuple[float, float]]) -> None:
    drawing = draw(path(*points))
    assert drawing.empty
    assert not drawing.image.any()


@given(
    seed=st.integers(0, 2**32 - 1),
    density=st.floats(0.01, 1),
    size=st.tuples(st.integers(1, 40), st.integers(1, 40)),
)
def test_they_are_those_of_all_pixels_up_to_the_edges(
    seed: int, density: float, size: tuple[int, int]
) -> None:
    strokes = np.random.default_rng(seed).random(size) < density
    strokes[-1, -1] = True
    moments = StrokeMoments.of(strokes * np.uint8(255))
    y, x = (places - places.mean() for places in np.nonzero(strokes))
    assert moments.count == len(x)
    assert moments.radius == pytest.approx(max(1.0, np.hypot(x, y).max()))
    powers = np.arange(HIGHEST_POWER + 1)
    across, down = (each[:, None] / moments.radius for each in (x, y))
    expected = (across**powers).T @ down**powers / len(x)
    np.testing.assert_allclose(moments.means, expected, atol=1e-12)


def test_normalised_central_moments_are_opencvs() -> None:
    image = np.zeros((60, 80), dtype=np.uint8)
    cv2.polylines(image, [np.array([[10, 50], [30, 8], [70, 40]])], False, 255, 5)
    moments, expected = StrokeMoments.of(image), cv2.moments(image, binaryImage=True)
    for p, q in ((2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3)):
        assert moments.central(p, q) == pytest.approx(expected[f"nu{p}{q}"], abs=1e-12)
