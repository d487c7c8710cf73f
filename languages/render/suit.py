"""Suit of a diver: hood, suit, harness and gloves, painted on the body.

Paint is evaluated at every pixel from the place on the body at rest, so its edges are sharp at any
distance. Colours are RGB, 0 to 255.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from numba import njit, vectorize

from languages.render.body import Array, Body, unit
from languages.render.water import Colour

EDGE = 0.0025
"""Metres over which one paint gives way to the next."""

SCLERA, IRIS, PUPIL = (236.0, 234.0, 230.0), (74.0, 58.0, 44.0), (14.0, 12.0, 12.0)


@dataclass(frozen=True)
class Suit:
    """Colours of one diver.

    Parameters
    ----------
    main, panel, trim
        The suit, its flanks and shoulders, and its seams and bands.
    hood, skin, brows
        Around the face, the face and bare hands, the eyebrows.
    gloves
        None for bare hands.
    webbing
        Straps and belt of the harness.

    """

    main: Colour
    panel: Colour
    trim: Colour
    hood: Colour = (38, 38, 42)
    skin: Colour = (214, 164, 134)
    brows: Colour = (66, 48, 38)
    gloves: Colour | None = None
    webbing: Colour = (24, 25, 28)


class SkinMap:
    """Where on the body every vertex lies, in terms that hold for any build.

    The map has one row per vertex and the columns named in `COLUMNS`.
    """

    COLUMNS = ("x", "y", "height", "along_arm", "head", "face_x", "face_y", "face_z")
    """x, y: metres at rest; height: 0 at the hips, 1 at the shoulders; along_arm: 0 at the
    shoulder, 1 at the wrist, more on the hand, -1 off the arms; head: 1 on the head; face: metres
    from between the eyes, for a head of `HEAD_HEIGHT`."""

    HEAD_HEIGHT = 0.15
    """Metres from the head's joint to the crown for which the face is painted."""

    def __init__(self, body: Body) -> None:
        points = body.vertices
        hips, shoulders = (body.head_of(f"{bone}.R")[2] for bone in ("upperleg01", "upperarm01"))
        self.eyes = (body.head_of("eye.L") + body.head_of("eye.R")) / 2
        crown = points[:, 2].max() - body.head_of("head")[2]
        self.head_scale = float(crown / self.HEAD_HEIGHT)
        face = (points - self.eyes) / self.head_scale
        values = {
            "x": points[:, 0],
            "y": points[:, 1],
            "height": (points[:, 2] - hips) / (shoulders - hips),
            "along_arm": np.maximum(_along_arm(body, "L"), _along_arm(body, "R")),
            "head": (points[:, 2] > body.head_of("neck03")[2]).astype(float),
            "face_x": face[:, 0],
            "face_y": face[:, 1],
            "face_z": face[:, 2],
        }
        self.values = np.stack([values[name] for name in self.COLUMNS], axis=1)
        self.half_width = float(body.head_of("upperarm01.L")[0])
        self.eyeballs = _eyeball_colours(body)

    def paint(self, suit: Suit, at: npt.NDArray[np.float32]) -> Array:
        """Give the colours ``(P, 3)`` at places ``(P, 8)`` interpolated from `values`."""
        place = dict(zip(self.COLUMNS, at.T, strict=True))
        colour = np.tile(np.array(suit.main, dtype=np.float32), (len(at), 1))
        self._paint_suit(colour, suit, place)
        self._paint_harness(colour, suit, place)
        head = np.flatnonzero(place["head"] > 0)
        on_head = colour[head]
        self._paint_head(on_head, suit, {name: values[head] for name, values in place.items()})
        colour[head] = on_head
        return colour

    def _paint_suit(self, colour: Array, suit: Suit, place: dict[str, Array]) -> None:
        height, along = place["height"], place["along_arm"]
        side = np.abs(place["x"]) / self.half_width
        on_arm = along > -0.5
        flank = 0.60 + 0.16 * np.cos(2.4 * (height - 0.35))
        below_hips = np.clip(-height, 0, 1)
        panel = _above(side, flank + 0.42 * below_hips, 0.02) * ~on_arm
        _cover(colour, suit.panel, panel)
        yoke = np.maximum(_above(height, 0.86 + 0.1 * side, 0.01), _between(along, 0.0, 0.17, 0.01))
        _cover(colour, suit.panel, yoke)
        _cover(
            colour,
            suit.trim,
            _between(height, 0.825 + 0.1 * side, 0.855 + 0.1 * side, 0.01) * ~on_arm,
        )
        _cover(colour, suit.trim, _between(along, 0.17, 0.20, 0.01))
        _cover(colour, suit.panel, _between(along, 0.70, 0.97, 0.01))
        _cover(colour, suit.trim, _between(along, 0.67, 0.70, 0.01))
        hands = suit.skin if suit.gloves is None else suit.gloves
        _cover(colour, hands, _above(along, 0.97, 0.01))

    def _paint_harness(self, colour: Array, suit: Suit, place: dict[str, Array]) -> None:
        height, x, y = place["height"], place["x"], place["y"]
        trunk = (place["along_arm"] < 0.05) & (place["head"] < 0.5)
        strap = _between(np.abs(x), 0.085, 0.125, EDGE) * _between(height, 0.12, 1.3, 0.01) * trunk
        belt = _between(height, 0.02, 0.12, 0.006) * trunk
        chest = _between(height, 0.66, 0.705, 0.006) * trunk * (np.abs(x) < 0.1) * (y < 0)
        for webbing in (strap, belt, chest):
            _cover(colour, suit.webbing, webbing)
        metal = (176.0, 180.0, 184.0)
        buckle = _between(height, 0.03, 0.11, 0.006) * _between(x, -0.03, 0.03, EDGE) * (y < 0)
        clip = _between(height, 0.655, 0.71, 0.006) * _between(x, -0.018, 0.018, EDGE) * (y < 0)
        for part in (buckle, clip):
            _cover(colour, metal, part * trunk)

    def _paint_head(self, colour: Array, suit: Suit, place: dict[str, Array]) -> None:
        x, y, z = place["face_x"], place["face_y"], place["face_z"]
        head = place["head"]
        _cover(colour, suit.hood, head)
        oval = np.hypot(x / 0.068, (z + 0.024) / 0.086)
        face = _above(-oval, -1.0, 0.03) * (y < 0.05) * head
        _cover(colour, suit.skin, face)
        lips = np.hypot(x / 0.024, (z + 0.071) / 0.0095)
        red, green, blue = suit.skin
        lip_colour = (0.80 * red, 0.58 * green, 0.58 * blue)
        _cover(colour, lip_colour, _above(-lips, -1, 0.1) * face)
        across = (np.abs(x) - 0.012) / 0.042
        arch = 0.019 + 0.006 * np.sin(np.pi * np.clip(across, 0, 1))
        brow = _between(z, arch - 0.0045, arch + 0.0045, 0.002) * (across > 0) * (across < 1)
        _cover(colour, suit.brows, brow * face)
        strap = _between(z, -0.012, 0.014, EDGE) * (y > 0.035) * head
        _cover(colour, suit.webbing, strap)


def _along_arm(body: Body, side: str) -> Array:
    """Tell for every vertex how far along one arm it lies; -1 for the rest of the body."""
    shoulder, elbow, wrist = (
        body.head_of(f"{bone}.{side}") for bone in ("upperarm01", "lowerarm01", "wrist")
    )
    upper, lower = elbow - shoulder, wrist - elbow
    first = (body.vertices - shoulder) @ upper / (upper @ upper)
    second = (body.vertices - elbow) @ lower / (lower @ lower)
    prefixes = ("upperarm", "lowerarm", "wrist", "finger", "metacarpal")
    names = [
        number
        for number, bone in enumerate(body.bones)
        if bone.name.startswith(prefixes) and bone.name.endswith(side)
    ]
    share = body.weights[:, names].sum(axis=1)
    along = np.where(second > 0, 0.5 + 0.5 * second, 0.5 * first)
    masked: Array = np.where(share > 0.5, along, -1.0)
    return masked


def _eyeball_colours(body: Body) -> Array:
    """Colours of the vertices ``(V, 3)``, NaN everywhere but on the eyeballs."""
    colours = np.full((len(body.vertices), 3), np.nan)
    for eye in body.eyes:
        points = body.vertices[eye]
        forward = unit(points - points.mean(axis=0)) @ np.array([0.0, -1.0, 0.0])
        colours[eye] = SCLERA
        colours[eye[forward > 0.86]] = IRIS
        colours[eye[forward > 0.955]] = PUPIL
    return colours


@vectorize(cache=True)
def _above(value: float, edge: float, softness: float) -> float:
    """Give 0 well below the edge and 1 well above it, smooth in between."""
    share = min(max((value - edge) / softness + 0.5, 0.0), 1.0)
    return share * share * (3 - 2 * share)


@vectorize(cache=True)
def _between(value: float, low: float, high: float, softness: float) -> float:
    """Give 1 well between two edges and 0 well beyond either."""
    from_low = min(max((value - low) / softness + 0.5, 0.0), 1.0)
    from_high = min(max((high - value) / softness + 0.5, 0.0), 1.0)
    return from_low * from_low * (3 - 2 * from_low) * from_high * from_high * (3 - 2 * from_high)


def _cover(colour: Array, paint: Colour, share: Array) -> None:
    """Lay a paint over the colours, in place, where `share` is above zero."""
    _mix(colour, np.array(paint, dtype=np.float32), share.astype(np.float32))


@njit(cache=True)
def _mix(colour, paint, share):  # type: ignore[no-untyped-def]
    for pixel in range(len(colour)):
        part = share[pixel]
        if part > 0:
            for channel in range(3):
                colour[pixel, channel] += part * (paint[channel] - colour[pixel, channel])
