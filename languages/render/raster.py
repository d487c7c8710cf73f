"""Rasteriser: turns triangles into pixels with a depth buffer."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, floor, radians, tan

import numpy as np
import numpy.typing as npt
from numba import njit

from languages.render.body import Array, unit

NEAREST = 0.05
"""Metres before the camera within which nothing is drawn."""


@dataclass(frozen=True)
class Camera:
    """A pinhole camera that looks from `position` at `target`, upright.

    Parameters
    ----------
    position, target
        ``(3,)`` metres in world axes.
    width, height
        Size of the image in pixels.
    field_of_view
        Vertical, in degrees.

    """

    position: Array
    target: Array
    width: int
    height: int
    field_of_view: float = 45.0

    @property
    def focal_length(self) -> float:
        """Pixels."""
        return 0.5 * self.height / tan(radians(self.field_of_view) / 2)

    @property
    def axes(self) -> Array:
        """Rows: image right, into the image, image up; ``(3, 3)`` unit vectors."""
        forward = unit(self.target - self.position)
        right = unit(np.cross(forward, [0.0, 0.0, 1.0]))
        return np.stack([right, forward, np.cross(right, forward)])

    def project(self, points: Array) -> tuple[Array, Array]:
        """Give pixels ``(N, 2)`` and depth ``(N,)`` in metres of world points ``(N, 3)``."""
        right, depth, up = ((points - self.position) @ self.axes.T).T
        scale = self.focal_length / np.maximum(depth, 1e-6)
        xy = np.stack([self.width / 2 + scale * right, self.height / 2 - scale * up], axis=1)
        return xy, depth

    def rays(self) -> Array:
        """Give the world direction through every pixel's middle, ``(height, width, 3)`` unit."""
        x = (np.arange(self.width) + 0.5 - self.width / 2) / self.focal_length
        y = (self.height / 2 - np.arange(self.height) - 0.5) / self.focal_length
        right, forward, up = self.axes
        return unit(forward + x[None, :, None] * right + y[:, None, None] * up)


@dataclass(frozen=True)
class Fragments:
    """The visible surface: one entry per covered pixel.

    Parameters
    ----------
    pixel
        ``(P,)`` positions in the flattened image.
    corners
        ``(P, 3)`` vertex numbers of the triangle seen there.
    shares
        ``(P, 3)`` weights of the corners, perspective-correct; rows add up to one.
    depth
        ``(P,)`` metres.

    """

    pixel: npt.NDArray[np.int64]
    corners: npt.NDArray[np.int64]
    shares: npt.NDArray[np.float32]
    depth: npt.NDArray[np.float32]

    def interpolate(self, values: Array) -> npt.NDArray[np.float32]:
        """Give values of the vertices ``(V, C)`` at the covered pixels, ``(P, C)``."""
        found = np.empty((len(self.pixel), values.shape[1]), np.float32)
        _blend(values.astype(np.float32), self.corners, self.shares, found)
        return found


def rasterize(
    camera: Camera, points: Array, triangles: npt.NDArray[np.int64], behind: Array | None = None
) -> Fragments:
    """Find the nearest triangle at every pixel, from either of its sides.

    Parameters
    ----------
    camera
        Where it is seen from.
    points
        ``(V, 3)`` metres in world axes.
    triangles
        ``(F, 3)`` vertex numbers.
    behind
        ``(height, width)`` metres of what has been drawn already; only what lies before it is
        found.

    """
    xy, depth = camera.project(points)
    # Only the part of the image in which the points lie is looked at.
    size = np.array([camera.width, camera.height])
    left, top = np.clip(np.floor(xy.min(axis=0)), 0, size).astype(int)
    right, bottom = np.clip(np.ceil(xy.max(axis=0)), 0, size).astype(int)
    shape = (bottom - top, right - left)
    nearest = np.full(shape, np.inf, np.float32)
    if behind is not None:
        nearest[:] = behind[top:bottom, left:right]
    owner = np.full(shape, -1, np.int32)
    shares = np.empty((*shape, 2), np.float32)
    _fill(xy - [left, top], depth, triangles, nearest, owner, shares)
    row, column = np.nonzero(owner >= 0)
    at_b, at_c = shares[row, column].T
    return Fragments(
        pixel=(row + top) * camera.width + column + left,
        corners=triangles[owner[row, column]],
        shares=np.stack([1 - at_b - at_c, at_b, at_c], axis=1),
        depth=nearest[row, column],
    )


@njit(cache=True)
def _fill(xy, depth, triangles, nearest, owner, shares):  # type: ignore[no-untyped-def]
    height, width = nearest.shape
    for number in range(len(triangles)):
        a, b, c = triangles[number]
        if min(depth[a], depth[b], depth[c]) < NEAREST:
            continue
        ax, ay, bx, by, cx, cy = xy[a, 0], xy[a, 1], xy[b, 0], xy[b, 1], xy[c, 0], xy[c, 1]
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if abs(area) < 1e-9:
            continue
        for row in range(max(0, floor(min(ay, by, cy))), min(height, ceil(max(ay, by, cy)) + 1)):
            y = row + 0.5
            for column in range(
                max(0, floor(min(ax, bx, cx))), min(width, ceil(max(ax, bx, cx)) + 1)
            ):
                x = column + 0.5
                at_b = ((x - ax) * (cy - ay) - (y - ay) * (cx - ax)) / area
                at_c = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / area
                at_a = 1 - at_b - at_c
                if at_a < 0 or at_b < 0 or at_c < 0:
                    continue
                inverse = at_a / depth[a] + at_b / depth[b] + at_c / depth[c]
                if 1 / inverse < nearest[row, column]:
                    nearest[row, column] = 1 / inverse
                    owner[row, column] = number
                    shares[row, column, 0] = at_b / depth[b] / inverse
                    shares[row, column, 1] = at_c / depth[c] / inverse


@njit(cache=True)
def _blend(values, corners, shares, found):  # type: ignore[no-untyped-def]
    for pixel in range(len(corners)):
        a, b, c = corners[pixel]
        for column in range(values.shape[1]):
            found[pixel, column] = (
                shares[pixel, 0] * values[a, column]
                + shares[pixel, 1] * values[b, column]
                + shares[pixel, 2] * values[c, column]
            )


def vertex_normals(points: Array, triangles: npt.NDArray[np.int64]) -> Array:
    """Give the mean normal of the faces around every vertex, ``(V, 3)`` unit vectors."""
    a, b, c = (points[triangles[:, corner]] for corner in range(3))
    faces = np.cross(b - a, c - a)
    normals = np.zeros_like(points)
    for corner in range(3):
        for axis in range(3):
            normals[:, axis] += np.bincount(triangles[:, corner], faces[:, axis], len(points))
    return unit(normals)
