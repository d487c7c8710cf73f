"""Gear of a diver: mask, regulator with hose, cylinder; meshes attached to a bone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from languages.render.body import Array, Body, unit
from languages.render.suit import SkinMap
from languages.render.water import Colour

DARK: Colour = (32.0, 33.0, 36.0)
BEHIND = np.array([0.0, 0.014, 0.0])
"""Metres from the mask's rim to its skirt, which lies on the face."""


@dataclass(frozen=True)
class Part:
    """A rigid mesh: vertices ``(V, 3)`` in metres at rest, triangles ``(F, 3)``, one colour."""

    bone: str
    vertices: Array
    triangles: npt.NDArray[np.int64]
    colour: Colour


@dataclass(frozen=True)
class Kit:
    """Colours of the equipment; `cylinder` is None for a free diver, who has no regulator."""

    mask: Colour = (28, 29, 32)
    regulator: Colour = (40, 42, 46)
    cylinder: Colour | None = (222, 190, 60)


def kit_parts(body: Body, skin: SkinMap, kit: Kit) -> list[Part]:
    """Build the opaque equipment of a diver, fitted to the head and back of this body."""
    face = _FaceFrame(skin)
    outline = face.place(_mask_outline())
    parts = [
        _part("head", _tube(outline, 0.0062 * face.scale, closed=True), kit.mask),
        _part("head", _tube(outline + BEHIND, 0.0085 * face.scale, closed=True), DARK),
    ]
    if kit.cylinder is not None:
        parts += _regulator(body, face, kit)
        parts += _cylinder(body, kit.cylinder)
    return parts


def mask_glass(skin: SkinMap) -> Part:
    """Build the mask's window; it is drawn last and lets the eyes be seen."""
    outline = _mask_outline()
    ring = outline * [0.97, 1, 0.97]
    middle = np.array([0.0, outline[:, 1].min(), outline[:, 2].mean()])
    points = np.concatenate([ring, middle[None]])
    count = len(ring)
    fan = np.array([[k, (k + 1) % count, count] for k in range(count)])
    return Part("head", _FaceFrame(skin).place(points), fan, (170, 215, 225))


def mouth(skin: SkinMap) -> Array:
    """Where the breath comes out, ``(3,)`` metres at rest."""
    place: Array = _FaceFrame(skin).place(np.array([0.0, -0.085, -0.085]))
    return place


class _FaceFrame:
    """Coordinates of a standard face, as in `SkinMap`, on this body's head."""

    def __init__(self, skin: SkinMap) -> None:
        self.eyes, self.scale = skin.eyes, skin.head_scale

    def place(self, points: Array) -> Array:
        placed: Array = self.eyes + points * self.scale
        return placed


def _mask_outline() -> Array:
    """Draw a rounded rectangle about the eyes and over the nose, wrapped around the face."""
    angle = np.linspace(0, 2 * np.pi, 64, endpoint=False)
    cosine, sine = np.cos(angle), np.sin(angle)
    roundness = (np.abs(cosine) ** 4 + np.abs(sine) ** 4) ** -0.25
    x, z = 0.066 * cosine * roundness, 0.036 * sine * roundness
    # The lower edge dips over the nose.
    z = z - 0.006 - 0.012 * np.exp(-((x / 0.02) ** 2)) * (sine < 0)
    return np.stack([x, -0.045 + 5.0 * x**2, z], axis=1)


def _regulator(body: Body, face: _FaceFrame, kit: Kit) -> list[Part]:
    case = _ellipsoid(np.array([0.031, 0.022, 0.027]) * face.scale)
    cover = _ellipsoid(np.array([0.021, 0.008, 0.018]) * face.scale)
    exhaust = _ellipsoid(np.array([0.043, 0.014, 0.011]) * face.scale)

    def at_lips(x: float, y: float, z: float) -> Array:
        return face.place(np.array([x, -0.036 + y, -0.072 + z]))

    def at(mesh: _Mesh, x: float, y: float, z: float) -> _Mesh:
        return mesh[0] + at_lips(x, y, z), mesh[1]

    shoulder = body.head_of("upperarm01.R")
    hose = np.array(
        [
            at_lips(-0.028, -0.022, -0.004),
            at_lips(-0.085, -0.012, -0.03),
            [0.66 * shoulder[0], shoulder[1] - 0.085, shoulder[2] + 0.075],
            [0.66 * shoulder[0], shoulder[1] + 0.0, shoulder[2] + 0.092],
            [0.56 * shoulder[0], shoulder[1] + 0.09, shoulder[2] + 0.05],
            [0.40 * shoulder[0], shoulder[1] + 0.15, shoulder[2] - 0.06],
        ]
    )
    return [
        _part("head", at(case, 0, -0.024, -0.002), DARK),
        _part("head", at(cover, 0, -0.042, 0.0), kit.regulator),
        _part("head", at(exhaust, 0, -0.020, -0.028), DARK),
        _part("spine01", _tube(_smooth(hose), 0.0075), DARK),
    ]


def _cylinder(body: Body, colour: Colour) -> list[Part]:
    shoulder = body.head_of("upperarm01.R")[2]
    hips = body.head_of("upperleg01.R")[2]
    radius, back = 0.088, body.head_of("spine01")[1] + 0.17
    rise = np.linspace(0, np.pi / 2, 8)
    heights = np.concatenate(
        [[hips - 0.02, shoulder - 0.01], shoulder - 0.01 + 0.06 * np.sin(rise)]
    )
    radii = np.concatenate([[radius, radius], radius * np.cos(rise) + 0.012 * np.sin(rise)])
    profile = np.stack([np.zeros_like(heights), np.full_like(heights, back), heights], axis=1)
    valve = np.array([[0, back, shoulder + 0.04], [0, back, shoulder + 0.085]])
    knob = np.array([[-0.05, back, shoulder + 0.075], [0.05, back, shoulder + 0.075]])
    metal = (150.0, 154.0, 158.0)
    return [
        _part("spine01", _tube(profile, radii), colour),
        _part("spine01", _tube(valve, 0.018), metal),
        _part("spine01", _tube(knob, 0.014), DARK),
    ]


_Mesh = tuple[Array, npt.NDArray[np.int64]]


def _part(bone: str, mesh: _Mesh, colour: Colour) -> Part:
    return Part(bone, *mesh, colour)


def _tube(path: Array, radius: Array | float, *, closed: bool = False, sides: int = 14) -> _Mesh:
    """Sweep a circle along a path ``(N, 3)``; `radius` may differ from point to point."""
    ahead, behind = np.roll(path, -1, axis=0), np.roll(path, 1, axis=0)
    if not closed:
        ahead[-1], behind[0] = path[-1], path[0]
    along = unit(ahead - behind)
    hint = (
        np.array([0.02, 1.0, 0.05]) if np.abs(along[:, 1]).max() < 0.95 else np.array([0.3, 0.1, 1])
    )
    first = unit(np.cross(along, hint))
    second = np.cross(along, first)
    angle = np.linspace(0, 2 * np.pi, sides, endpoint=False)[None, :, None]
    circle = np.cos(angle) * first[:, None] + np.sin(angle) * second[:, None]
    size = np.broadcast_to(np.asarray(radius, dtype=float), len(path))
    points = path[:, None] + size[:, None, None] * circle
    return points.reshape(-1, 3), _grid(len(path), sides, closed)


def _grid(rows: int, columns: int, closed: bool) -> npt.NDArray[np.int64]:
    """Triangles of a band of quads, closed around its columns and, on demand, its rows."""
    row, column = np.mgrid[0 : rows if closed else rows - 1, 0:columns].reshape(2, -1)
    below, beside = (row + 1) % rows, (column + 1) % columns
    a, b = row * columns + column, row * columns + beside
    c, d = below * columns + beside, below * columns + column
    return np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])


def _ellipsoid(radii: Array) -> _Mesh:
    rise = np.linspace(-np.pi / 2, np.pi / 2, 14)
    axis = np.stack([np.zeros(14), np.zeros(14), np.sin(rise)], axis=1)
    points, triangles = _tube(axis, np.maximum(np.cos(rise), 1e-3), sides=22)
    return points * radii, triangles


def _smooth(corners: Array, count: int = 40) -> Array:
    """Lay a curve (Catmull and Rom 1974) through points ``(N, 3)``."""
    padded = np.concatenate([corners[:1], corners, corners[-1:]])
    place = np.linspace(0, len(corners) - 1 - 1e-9, count)
    start = place.astype(int)
    t = (place - start)[:, None]
    p0, p1, p2, p3 = (padded[start + k] for k in range(4))
    curve: Array = 0.5 * (
        2 * p1
        + (p2 - p0) * t
        + (2 * p0 - 5 * p1 + 4 * p2 - p3) * t**2
        + (3 * p1 - p0 - 3 * p2 + p3) * t**3
    )
    return curve
