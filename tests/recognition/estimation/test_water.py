"""Colour and contrast under water."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.errors import EstimatorError
from app.recognition.estimation.water import (
    CORRECTIONS,
    LUMA,
    Correction,
    apply_correction,
    correct_colours,
    is_murky,
)
from app.recognition.poses.frame import Image

COLOURS = st.tuples(st.integers(0, 255), st.integers(0, 255), st.integers(0, 255))


def scene() -> Image:
    """Return a picture with every colour in it."""
    return np.random.default_rng(3).integers(0, 256, (96, 128, 3), dtype=np.uint8)


def in_water(image: Image, murk: float, colour: npt.ArrayLike = (40, 95, 110)) -> Image:
    """Mix `murk` of the water's colour into a picture."""
    return ((1 - murk) * image + murk * np.asarray(colour)).round().astype(np.uint8)


def brightness_range(image: Image) -> float:
    return float(np.ptp(np.percentile(image @ LUMA, [1, 99])))


def colour_cast(image: Image) -> float:
    """Return how far the channels' means lie apart."""
    return float(np.ptp(image.reshape(-1, 3).mean(axis=0)))


def test_murk_is_taken_away() -> None:
    murky = in_water(scene(), 0.75)
    clear = correct_colours(murky, "on")
    assert brightness_range(clear) > 3 * brightness_range(murky)
    assert colour_cast(clear) < colour_cast(murky) / 3


def test_what_was_lighter_stays_lighter() -> None:
    """Also where nothing is stretched out of range: the order of grey values is kept."""
    ramp = np.repeat(np.linspace(60, 110, 128).astype(np.uint8)[None, :, None], 3, axis=2)
    shown = correct_colours(np.repeat(ramp, 64, axis=0), "on")
    assert (np.diff(shown[0, :, 0].astype(int)) >= 0).all()
    assert np.ptp(shown) > 200


def test_auto_corrects_the_murky_and_leaves_the_clear_alone() -> None:
    clear, murky = scene(), in_water(scene(), 0.75)
    assert not is_murky(clear)
    assert is_murky(murky)
    assert correct_colours(clear, "auto") is clear
    np.testing.assert_array_equal(correct_colours(murky, "auto"), correct_colours(murky, "on"))


def test_off_never_corrects() -> None:
    murky = in_water(scene(), 0.9)
    assert correct_colours(murky, "off") is murky


def test_what_is_dark_against_the_light_is_lightened() -> None:
    back_lit = scene() // 8
    back_lit[:48] = 240
    diver = {one: float(apply_correction(back_lit, one)[48:].mean()) for one in CORRECTIONS}
    assert diver["lightened"] > 2 * diver["balanced"]


def test_local_contrast_shows_what_haze_hides() -> None:
    """A faint pattern beside a strong one, which leaves it no room in a stretched range."""
    hazy = np.full((96, 128, 3), 120, np.uint8)
    hazy[:, ::2] += 4
    hazy[:16, :16], hazy[-16:, -16:] = 0, 255
    faint = {
        one: float(apply_correction(hazy, one)[30:60, 40:80].std(axis=1).mean())
        for one in CORRECTIONS
    }
    assert faint["contrasted"] > 1.5 * faint["lightened"]


def test_without_a_correction_the_frame_itself_is_seen() -> None:
    clear = scene()
    assert apply_correction(clear, "none") is clear


@given(
    COLOURS,
    st.floats(0, 1),
    st.tuples(st.integers(1, 9), st.integers(1, 9)),
    st.sampled_from(CORRECTIONS),
)
def test_any_water_gives_a_picture_of_the_same_size(
    colour: tuple[int, int, int], murk: float, size: tuple[int, int], correction: Correction
) -> None:
    image = in_water(scene()[: size[0], : size[1]], murk, colour)
    before = image.copy()
    shown = apply_correction(image, correction)
    assert shown.shape == image.shape
    assert shown.dtype == np.uint8
    np.testing.assert_array_equal(image, before)


def test_an_unknown_setting_is_refused_with_the_ones_there_are() -> None:
    with pytest.raises(EstimatorError, match="'sea'; there are: auto, on, off"):
        correct_colours(scene(), cast(Any, "sea"))


def test_what_is_no_rgb_image_is_refused() -> None:
    with pytest.raises(EstimatorError, match="expected"):
        correct_colours(scene()[..., 0], "on")
