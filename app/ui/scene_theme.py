"""Themes of the 3D scene, dark and light, with colours from the palette.

Blue means "chosen" and orange "expected" throughout: the pair is distinct for every common kind of
colour blindness, and its meaning is always written as well.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from app.recognition.poses.sequence import FloatArray
from app.ui.palette import Rgb, load_palette, parse_colour


@dataclass(frozen=True)
class Theme:
    """Colours of the space-time cube.

    Attributes
    ----------
    background
        Background, equal to the page's, so that the frame has no visible edge.
    wall
        Back wall with the trajectory image.
    line
        Edges of the cube and ticks of the time axis.
    quiet
        Trails of landmarks that are not salient.
    bone, joint
        Skeleton over the video.
    ink
        Stroke of the trajectory image on the wall, and text of the ticks.
    rim
        Outline of the video.
    accent
        Accent colour; viser derives the shades of its buttons and sliders from it.

    """

    dark: bool
    background: Rgb
    wall: Rgb
    line: Rgb
    quiet: Rgb
    bone: Rgb
    joint: Rgb
    ink: Rgb
    rim: Rgb
    accent: Rgb


def _build_theme(colours: Mapping[str, str], *, dark: bool) -> Theme:
    rgb = {name: parse_colour(colours[token]) for name, token in _TOKENS.items()}
    return Theme(dark=dark, **rgb)


_TOKENS: Final = {
    "background": "bg",
    "wall": "panel",
    "line": "scene-line",
    "quiet": "scene-trail",
    "bone": "scene-bone",
    "joint": "picture-strong",
    "ink": "ink",
    "rim": "scene-rim",
    "accent": "accent",
}
"""Name in the palette of each colour of a theme."""

DARK: Final = _build_theme(load_palette().dark, dark=True)
LIGHT: Final = _build_theme(load_palette().light, dark=False)

_TIME_RAMP: Final = np.array(
    [parse_colour(load_palette().dark[f"time-{number}"]) for number in (1, 2, 3, 4)]
)
"""Blue to orange through violet and rose; the order of lightness suits every colour vision."""


def map_time_colours(share: FloatArray) -> npt.NDArray[np.uint8]:
    """Map moments of a gesture to colours from blue (start) to orange (end).

    Parameters
    ----------
    share
        ``(T,)`` in [0, 1].

    Returns
    -------
    ``(T, 3)`` sRGB.

    """
    stops = np.linspace(0, 1, len(_TIME_RAMP))
    channels = [np.interp(share, stops, _TIME_RAMP[:, channel]) for channel in range(3)]
    return np.asarray(np.rint(np.stack(channels, axis=-1)), dtype=np.uint8)


def to_linear(srgb: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
    """Convert sRGB to linear RGB, which viser expects for the vertex colours of a line."""
    return np.asarray(np.rint((srgb / 255.0) ** 2.2 * 255.0), dtype=np.uint8)
