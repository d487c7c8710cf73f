"""Water correction: restores colour and contrast of under-water frames before estimation.

Water absorbs red first and, where it is turbid, blue; particles add a uniform colour; light from
above leaves divers dark. The models were trained in air. `correct_colours` decides by grey levels,
for estimators that cannot examine a single image; `WaterSight` decides by the models' scores.
"""

from __future__ import annotations

from typing import Final, Literal, get_args

import cv2
import numpy as np

from app.recognition.errors import EstimatorError
from app.recognition.estimation.estimator import check_image
from app.recognition.poses.frame import Image
from app.recognition.poses.sequence import FloatArray

WaterCorrection = Literal["auto", "on", "off"]
"""Which frames are corrected: those for which it raises the models' scores (`WaterSight`), all, or
none."""

Correction = Literal["none", "balanced", "lightened", "contrasted"]
"""Correction of a frame: none; colours balanced and stretched; in addition, dark parts lightened,
for divers against the light; in addition to both, local contrast equalised, for divers in haze."""

CORRECTIONS: Final[tuple[Correction, ...]] = get_args(Correction)

RED, GREEN, BLUE = 0, 1, 2

LIGHTENING: Final = 0.5
"""Exponent of brightness in [0, 1], a square root: a quarter becomes a half."""

CONTRAST_LIMIT: Final = 2.0
CONTRAST_TILES: Final = (8, 8)
"""Limit and tiles of the equalisation of local contrast (CLAHE, Zuiderveld 1994)."""

SAMPLING: Final = 4
"""Step in pixels, each way, with which a frame's colours are sampled."""

TAIL: Final = 1.0
"""Percentage of the pixels at either end of the range that the stretch may clip: a lamp, a hole."""

LEAST_RANGE: Final = 8.0
"""Least range in grey levels; an image with a smaller one would be stretched to noise."""

MURKY_RANGE: Final = 64.0
"""Grey levels between the `TAIL` darkest and lightest pixels below which ``"auto"`` corrects. Clear
frames have 75 to 190, those with 50 % murk 40 to 85, with 75 % 30 to 50; above the limit the models
work nearly as well without correction."""

LUMA: Final = np.array([0.299, 0.587, 0.114])
"""Weights of red, green and blue in brightness (ITU-R BT.601)."""


def correct_colours(image: Image, water: WaterCorrection = "auto") -> Image:
    """Return a frame as it would look in clear water, or the frame itself.

    Three steps. The mean difference of green and red is added to red where the pixel is green, and
    likewise to blue where the water is turbid (Ancuti et al. 2018, Sec. III, with a weight of 1).
    All channels are brought to the same mean (grey world, Buchsbaum 1980). All are stretched about
    it alike, until the widest fills its range. The sharpening and fusion of several images in that
    paper are left out, because they do not help the models.

    Parameters
    ----------
    image
        ``(height, width, 3)`` RGB of 8 bits; it is not written to.
    water
        ``"on"``, ``"off"``, or ``"auto"``: on where the brightness has less than `MURKY_RANGE`.

    Returns
    -------
    A new image, or `image` itself where nothing is corrected.

    Raises
    ------
    EstimatorError
        When `water` is none of the three, or `image` is no RGB image of 8 bits.

    """
    check_water(water)
    check_image(image)
    needed = water == "on" or (water == "auto" and is_murky(image))
    return apply_correction(image, "balanced" if needed else "none")


def check_water(water: str) -> None:
    """Check that a setting of the correction exists.

    Raises
    ------
    EstimatorError
        When it does not; the message names those that exist.

    """
    if water not in get_args(WaterCorrection):
        known = ", ".join(get_args(WaterCorrection))
        raise EstimatorError(f"unknown water correction {water!r}; there are: {known}")


def apply_correction(image: Image, correction: Correction) -> Image:
    """Return a corrected frame, a new image; with ``"none"`` the frame itself.

    Raises
    ------
    EstimatorError
        When `image` is no RGB image of 8 bits.

    """
    check_image(image)
    if correction == "none":
        return image
    compensated = _compensate(image)
    table = _balance_and_stretch(_sample(compensated))
    if correction in ("lightened", "contrasted"):
        table = np.round(255 * (table / 255) ** LIGHTENING).astype(np.uint8)
    corrected = np.asarray(cv2.LUT(compensated, table), np.uint8)
    return _equalise(corrected) if correction == "contrasted" else corrected


def is_murky(image: Image) -> bool:
    """Return whether the range of brightness is so small that correction helps."""
    darkest, lightest = np.percentile(_sample(image) @ LUMA, [TAIL, 100 - TAIL])
    return bool(lightest - darkest < MURKY_RANGE)


def _sample(image: Image) -> FloatArray:
    """Return ``(N, 3)``: a sample of the image's pixels."""
    return image[::SAMPLING, ::SAMPLING].reshape(-1, 3).astype(np.float64)


def _compensate(image: Image) -> Image:
    """Add to red and to blue their mean difference from green, most where the pixel is green."""
    means = _sample(image).mean(axis=0)
    channels = [np.ascontiguousarray(image[..., channel]) for channel in range(3)]
    for weak in (RED, BLUE):
        lack = (means[GREEN] - means[weak]) / 255
        if lack > 0:
            room = 255 - channels[weak]
            gain = cv2.multiply(room, channels[GREEN], scale=lack / 255)
            channels[weak] = np.asarray(cv2.add(channels[weak], gain), np.uint8)
    return np.asarray(cv2.merge(channels), np.uint8)


def _equalise(image: Image) -> Image:
    """Equalise local contrast of the brightness, and leave the colours."""
    space = cv2.cvtColor(image, cv2.COLOR_RGB2LAB)
    equaliser = cv2.createCLAHE(CONTRAST_LIMIT, CONTRAST_TILES)
    space[..., 0] = equaliser.apply(np.ascontiguousarray(space[..., 0]))
    return np.asarray(cv2.cvtColor(space, cv2.COLOR_LAB2RGB), np.uint8)


def _balance_and_stretch(pixels: FloatArray) -> Image:
    """Return the ``(1, 256, 3)`` table by which each value of each channel is replaced."""
    means = pixels.mean(axis=0)
    gains = means.mean() / np.maximum(means, 1.0)
    low, high = np.percentile(pixels * gains, [TAIL, 100 - TAIL], axis=0)
    darkest, lightest = low.min(), high.max()
    stretch = 255 / max(lightest - darkest, LEAST_RANGE)
    values = np.arange(256.0)[:, None] * gains
    stretched = np.clip((values - darkest) * stretch, 0, 255).round()
    return np.asarray(stretched[None], np.uint8)
