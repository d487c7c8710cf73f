"""Closing a binary image gives what OpenCV gives."""

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.features.contour import close_image


@given(
    seed=st.integers(0, 2**32 - 1),
    density=st.floats(0, 1),
    size=st.tuples(st.integers(1, 60), st.integers(1, 60)),
    diameter=st.sampled_from([4, 6, 14, 28]),
)
def test_the_result_is_opencvs_to_the_last_pixel(
    seed: int, density: float, size: tuple[int, int], diameter: int
) -> None:
    strokes = np.random.default_rng(seed).random(size) < density
    border = diameter // 2 + 1
    to_a_whole_byte = -(size[1] + 2 * border) % 8
    image = np.pad(strokes * np.uint8(255), ((border,) * 2, (border, border + to_a_whole_byte)))
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (diameter + 1, diameter + 1))
    expected = cv2.morphologyEx(image, cv2.MORPH_CLOSE, disc)
    np.testing.assert_array_equal(close_image(image, diameter), expected)


@pytest.mark.parametrize(("gap", "filled"), [(20, True), (40, False)])
def test_a_gap_is_filled_where_the_disc_does_not_fit(gap: int, filled: bool) -> None:
    image = np.zeros((200, 200), dtype=np.uint8)
    image[40:160, 50:70] = 255
    image[40:160, 70 + gap : 90 + gap] = 255
    assert bool(close_image(image, 28)[100, 70 + gap // 2]) is filled
