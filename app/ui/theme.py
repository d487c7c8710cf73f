"""Colours of the scene, dark and light.

Blue means "chosen" and orange "expected" throughout: the pair stays apart for every common kind
of colour blindness, and neither ever carries a meaning that is not also written.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from app.recognition.poses.sequence import FloatArray

Rgb = tuple[int, int, int]
"""sRGB, 0 to 255."""


@dataclass(frozen=True)
class Theme:
    """Colours of the space-time cube.

    Attributes
    ----------
    background
        Behind everything; the same as the page's, so that the frame has no visible edge.
    wall
        The back wall, on which the trajectory image lies.
    line
        Edges of the cube and ticks of the time axis.
    quiet
        Trails of landmarks that are not salient.
    bone, joint
        The skeleton over the video.
    ink
        The stroke of the trajectory image on the wall, and the ticks' text.
    rim
        The outline of the video.
    accent
        viser derives its buttons' and sliders' shades from it.

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


DARK: Final = Theme(
    dark=True,
    background=(11, 17, 24),
    wall=(18, 27, 38),
    line=(74, 93, 113),
    quiet=(44, 64, 86),
    bone=(226, 236, 246),
    joint=(255, 255, 255),
    ink=(226, 236, 246),
    rim=(200, 214, 228),
    accent=(58, 134, 255),
)
LIGHT: Final = Theme(
    dark=False,
    background=(243, 246, 249),
    wall=(255, 255, 255),
    line=(148, 163, 178),
    quiet=(196, 207, 218),
    bone=(255, 255, 255),
    joint=(255, 255, 255),
    ink=(28, 42, 58),
    rim=(92, 111, 131),
    accent=(26, 99, 217),
)

_TIME_RAMP: Final = np.array([(58, 134, 255), (150, 118, 236), (226, 112, 160), (255, 150, 60)])
"""Blue to orange through violet and rose: the same lightness order for every kind of vision."""


def time_colours(share: FloatArray) -> npt.NDArray[np.uint8]:
    """Colour moments of a gesture from blue (begins) to orange (ends).

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


def linear(srgb: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
    """Undo the sRGB transfer curve: viser shows colours per vertex of a line without doing so."""
    return np.asarray(np.rint((srgb / 255.0) ** 2.2 * 255.0), dtype=np.uint8)
