"""Zernike moments: the textbook's, computed fast."""

import mahotas  # type: ignore[import-untyped]
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.features.trajectory_image import Drawing
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.shape_voters import DEGREE, ORDERS, ZernikeMoments, zernike_magnitudes
from tests.recognition.strategies import Shape, strokes
from tests.recognition.voters.figures import CIRCLE, FIGURES, SIX, drawing_of, turned


def by_mahotas(drawing: Drawing) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    rows, columns = np.nonzero(drawing.image)
    centre = (rows.mean(), columns.mean())
    radius = np.hypot(rows - centre[0], columns - centre[1]).max()
    # mahotas leaves out pixels beyond the radius; rounding must not count the farthest as such.
    magnitudes = mahotas.features.zernike_moments(
        drawing.image > 0, radius * (1 + 1e-9), degree=DEGREE, cm=centre
    )
    return np.asarray(magnitudes)


def of_points(points: FloatArray) -> FloatArray:
    """Return the magnitudes of equally weighted points ``(N, 2)`` of the unit disc."""
    x, y = (points[:, axis, None] ** np.arange(DEGREE + 1) for axis in range(2))
    return zernike_magnitudes(x.T @ y / len(points))


@pytest.mark.parametrize("name", FIGURES)
def test_figures_have_the_moments_that_mahotas_finds(name: str) -> None:
    drawing = drawing_of(FIGURES[name])
    np.testing.assert_allclose(
        ZernikeMoments().describe(drawing), by_mahotas(drawing), rtol=0, atol=1e-6
    )


@given(strokes())
def test_any_stroke_has_the_moments_that_mahotas_finds(stroke: Shape) -> None:
    drawing = drawing_of(stroke(np.linspace(0, 1, 60)))
    np.testing.assert_allclose(
        ZernikeMoments().describe(drawing), by_mahotas(drawing), rtol=0, atol=1e-6
    )


def test_there_are_25_moments_up_to_degree_8() -> None:
    assert len(ORDERS) == ZernikeMoments().length(2) == 25
    assert all(n % 2 == m % 2 and m <= n for n, m in ORDERS)


def test_moments_of_a_ring_are_those_of_its_radial_polynomials() -> None:
    angles = np.linspace(0, 2 * np.pi, 720, endpoint=False)
    ring = 0.5 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    magnitudes = dict(zip(ORDERS, of_points(ring), strict=True))
    assert magnitudes[0, 0] == pytest.approx(1 / np.pi)
    assert magnitudes[2, 0] == pytest.approx(3 / np.pi * abs(2 * 0.5**2 - 1))
    assert magnitudes[4, 0] == pytest.approx(5 / np.pi * abs(6 * 0.5**4 - 6 * 0.5**2 + 1))
    assert all(value < 1e-9 for (_, m), value in magnitudes.items() if m)


def test_a_point_at_the_centroid_counts() -> None:
    assert of_points(np.zeros((1, 2)))[0] == pytest.approx(1 / np.pi)


@given(st.integers(0, 2**32 - 1), st.floats(0, 360))
def test_rotation_changes_no_magnitude(seed: int, degrees: float) -> None:
    points = np.random.default_rng(seed).uniform(-0.7, 0.7, (50, 2))
    np.testing.assert_allclose(of_points(turned(points, degrees)), of_points(points), atol=1e-9)


def test_a_six_is_nearer_to_a_nine_than_to_a_circle() -> None:
    six, nine, disc = (
        ZernikeMoments().describe(drawing_of(points)) for points in (SIX, turned(SIX, 180), CIRCLE)
    )
    to_nine, to_disc = ZernikeMoments().distances(six, np.stack([nine, disc]))
    assert to_nine < to_disc
