"""Moments from the ends of runs are those of all pixels."""

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.features.moments import HIGHEST_POWER, StrokeMoments


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
