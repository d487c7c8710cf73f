"""Water around the diver: backdrop, light shafts, sea bed, haze and bubbles. Colours are RGB."""

from __future__ import annotations

from dataclasses import dataclass
from math import sin

import cv2
import numpy as np

from languages.render.body import Array
from languages.render.raster import Camera

Colour = tuple[float, float, float]


@dataclass(frozen=True)
class Water:
    """A body of water.

    Parameters
    ----------
    surface, deep
        RGB, 0 to 255: the colour towards the surface and towards the depths.
    floor
        RGB of the sea bed.
    visibility
        Metres after which 63 % of a colour has turned into the water's.
    shafts
        Strength of the light shafts, 0 to 1.
    floor_depth
        Metres from the hips down to the sea bed.
    grain
        Standard deviation of the backdrop's fixed grain, in grey levels; it keeps the smooth
        gradients from banding when compressed.

    """

    surface: Colour
    deep: Colour
    floor: Colour
    visibility: float = 8.0
    shafts: float = 0.6
    floor_depth: float = 1.5
    grain: float = 1.2

    def colour(self, height: Array) -> Array:
        """Give the water's own colour ``(..., 3)`` in directions of this elevation, -1 to 1."""
        share = np.clip(0.5 + 0.9 * height, 0, 1)[..., None]
        deep, surface = (np.array(end, dtype=height.dtype) for end in (self.deep, self.surface))
        mixed: Array = deep + share * (surface - deep)
        return mixed

    def haze(self, colour: Array, depth: Array, height: Array) -> Array:
        """Fade colours ``(N, 3)`` seen at a depth ``(N,)`` in metres into the water."""
        keep = np.exp(-depth / self.visibility)[:, None]
        faded: Array = keep * colour + (1 - keep) * self.colour(height)
        return faded


class Backdrop:
    """Everything behind the diver; painted once, only the light shafts move."""

    def __init__(self, water: Water, camera: Camera, seed: int) -> None:
        random = np.random.default_rng(seed)
        rays = camera.rays()
        image = water.colour(rays[..., 2])
        image = _add_floor(image, water, camera, rays, random)
        grain = random.normal(0, water.grain, (*image.shape[:2], 1))
        self._still = (image + grain).astype(np.float32)
        self._shafts = tuple(
            (water.shafts * 34 * _shafts(camera, random)).astype(np.float32) for _ in range(2)
        )

    def at(self, time: float) -> Array:
        """Paint the backdrop at a time in seconds, ``(height, width, 3)`` RGB."""
        share = 0.5 + 0.5 * sin(0.8 * time)
        light = (1 - share) * self._shafts[0] + share * self._shafts[1]
        painted: Array = self._still + light[..., None] * np.array([0.75, 1.0, 1.0], np.float32)
        return painted


def _add_floor(
    image: Array, water: Water, camera: Camera, rays: Array, random: np.random.Generator
) -> Array:
    """Paint the sea bed: sand with ripples, fading into the distance."""
    down = rays[..., 2]
    height = camera.position[2] + water.floor_depth
    distance = np.where(down < -0.01, height / np.maximum(-down, 0.01), np.inf)
    seen = np.isfinite(distance) & (distance < 12 * water.visibility)
    place = camera.position[:2] + rays[..., :2] * np.where(seen, distance, 0)[..., None]
    tile = _noise(random, 256, 12)
    cells = (place * 40).astype(np.float32) % 255
    sand = cv2.remap(tile, cells[..., 0].copy(), cells[..., 1].copy(), cv2.INTER_LINEAR)
    ripples = np.sin(6 * place[..., 1] + 1.5 * np.sin(1.7 * place[..., 0]))
    light = 1 + 0.35 * (sand - 0.5) + 0.05 * ripples
    floor = np.array(water.floor) * light[..., None]
    keep = np.where(seen, np.exp(-np.where(seen, distance, 0) / water.visibility), 0)[..., None]
    painted: Array = keep * floor + (1 - keep) * image
    return painted


def _shafts(camera: Camera, random: np.random.Generator) -> Array:
    """Light falling from above the image, brightest at the top, ``(height, width)`` 0 to 1."""
    column, row = np.meshgrid(
        np.arange(camera.width) / camera.width, np.arange(camera.height) / camera.height
    )
    angle = np.arctan2(column - random.uniform(0.3, 0.7), row + 0.6)
    light = np.zeros_like(angle)
    for frequency in (11, 23, 37, 61):
        light += np.sin(frequency * angle + random.uniform(0, 2 * np.pi)) / 4
    shaped: Array = np.clip(light, 0, 1) * np.clip(1 - 1.15 * row, 0, 1) ** 1.5
    return shaped


def _noise(random: np.random.Generator, size: int, cells: int) -> Array:
    """Smooth noise in three octaves, 0 to 1, ``(size, size)``, the same on opposite edges."""
    total = np.zeros((size, size), np.float32)
    for octave in range(3):
        count = cells * 2**octave
        coarse = random.random((count, count)).astype(np.float32)
        wrapped = np.pad(coarse, 2, mode="wrap")
        scale = size / count
        large = cv2.resize(wrapped, None, fx=scale, fy=scale, interpolation=cv2.INTER_CUBIC)
        start = round(2 * scale)
        total += large[start : start + size, start : start + size] / 2**octave
    scaled: Array = (total - total.min()) / np.ptp(total)
    return scaled


@dataclass(frozen=True)
class Bubble:
    """One bubble: breathed out at `birth` seconds; radius and offset in metres."""

    birth: float
    radius: float
    offset: tuple[float, float, float]
    sway: float


RISE = 0.32
"""Metres per second of a bubble of a few millimetres (Clift, Grace and Weber 1978)."""


def breath(random: np.random.Generator, start: float, count: int = 14) -> list[Bubble]:
    """Make the bubbles of one breath that begins at `start` seconds."""
    return [
        Bubble(
            birth=start + random.uniform(0, 0.8),
            radius=random.uniform(0.003, 0.011),
            offset=(random.uniform(0.02, 0.07), random.uniform(-0.05, 0.0), 0.0),
            sway=random.uniform(0, 2 * np.pi),
        )
        for _ in range(count)
    ]


def draw_bubbles(
    image: Array, camera: Camera, bubbles: list[Bubble], mouth: Array, time: float
) -> None:
    """Draw the bubbles that are on their way at a time, each from the mouth upwards."""
    for bubble in bubbles:
        age = time - bubble.birth
        if age < 0:
            continue
        wobble = 0.012 * np.sin(9 * age + bubble.sway)
        place = mouth + np.array(bubble.offset) + np.array([wobble + 0.02 * age, 0, RISE * age])
        xy, depth = camera.project(place[None])
        radius = camera.focal_length * bubble.radius * (1 + 0.15 * age) / depth[0]
        _draw_bubble(image, xy[0], radius)


def _draw_bubble(image: Array, centre: Array, radius: float) -> None:
    x, y = centre
    low = np.maximum([y - radius - 2, x - radius - 2], 0).astype(int)
    high = np.minimum([y + radius + 2, x + radius + 2], image.shape[:2]).astype(int)
    if (high <= low).any():
        return
    rows, columns = np.mgrid[low[0] : high[0], low[1] : high[1]] + 0.5
    distance = np.hypot(columns - x, rows - y) / radius
    rim = np.exp(-(((distance - 0.85) / 0.22) ** 2)) * 0.45
    inside = np.clip((1 - distance) * radius, 0, 1) * 0.12
    glint = np.exp(
        -((columns - x + 0.35 * radius) ** 2 + (rows - y + 0.35 * radius) ** 2) * 8 / radius**2
    )
    alpha = np.clip(rim + inside + 0.8 * glint * (distance < 1), 0, 1)[..., None]
    patch = image[low[0] : high[0], low[1] : high[1]]
    patch[:] = (1 - alpha) * patch + alpha * np.array([225.0, 245, 250])
