"""Simulated water in test clips."""

from __future__ import annotations

import numpy as np

from app.recognition.poses.frame import Image
from benchmarks.accuracy.murky_clips import WATER_COLOUR, degrade


def chequered(height: int, width: int) -> Image:
    """Return a picture of black and white squares."""
    rows, columns = np.mgrid[:height, :width] // 4
    return np.repeat(((rows + columns) % 2 * 255).astype(np.uint8)[..., None], 3, axis=2)


def test_without_murk_nothing_changes() -> None:
    (shown,) = degrade([chequered(48, 64)], 0.0)
    np.testing.assert_array_equal(shown, chequered(48, 64))


def test_murk_leaves_its_complement_of_the_contrast_and_pulls_to_the_water_s_colour() -> None:
    (shown,) = degrade([chequered(96, 128)], 0.75)
    assert abs(float(shown.std(axis=(0, 1)).mean()) - 0.25 * 127.5) < 2
    expected = 0.25 * 127.5 + 0.75 * np.array(WATER_COLOUR)
    np.testing.assert_allclose(shown.mean(axis=(0, 1)), expected, atol=1)


def test_lights_that_blink_darken_half_of_the_time() -> None:
    shown = list(degrade([np.full((4, 4, 3), 200, np.uint8)] * 25, 0.0, blink=0.5))
    assert [int(image[0, 0, 0]) for image in shown].count(100) == 12


def test_far_away_the_picture_keeps_its_size() -> None:
    picture = np.zeros((48, 64, 3), np.uint8)
    picture[8:40, 8:56] = 255
    (shown,) = degrade([picture], 0.0, far=True)
    assert shown.shape == picture.shape
    assert abs(int((shown > 127).sum()) - (picture > 127).sum() / 4) < 40
