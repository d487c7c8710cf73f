"""Scene: renders a diver in the water, one frame at a time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import cv2
import numpy as np
import numpy.typing as npt
from numba import njit

from languages.render.body import Array, Body, Joints, unit
from languages.render.gear import Kit, kit_parts, mask_glass, mouth
from languages.render.posture import axis_rotation
from languages.render.raster import Camera, Fragments, rasterize, vertex_normals
from languages.render.suit import SkinMap, Suit
from languages.render.water import Backdrop, Bubble, Water, draw_bubbles

WIDTH, HEIGHT = 640, 480
SUPERSAMPLING = 2
"""Rendered pixels per pixel of the clip along each axis; smooths edges."""

SUN = unit(np.array([-0.35, -0.75, 0.75]))
FILL = unit(np.array([0.7, -0.6, 0.1]))
"""Directions towards the two lights: from above the camera's left shoulder, from its right."""


@dataclass(frozen=True)
class Diver:
    """A person: MakeHuman shape targets, suit and equipment."""

    shape: dict[str, float]
    suit: Suit
    kit: Kit = field(default_factory=Kit)


@dataclass(frozen=True)
class View:
    """Where the camera is.

    Parameters
    ----------
    distance
        Metres from the diver's chest.
    yaw
        Degrees by which the diver is turned to the image's right.
    pitch
        Degrees by which the camera looks down.
    aim
        Metres from the chest to the point in the image's middle: to the right, up.

    """

    distance: float = 1.7
    yaw: float = 0.0
    pitch: float = 0.0
    aim: tuple[float, float] = (0.0, 0.0)

    def camera(self, chest: Array, width: int, height: int) -> Camera:
        """Place a camera of this image size."""
        turn = axis_rotation([0, 0, 1], -np.radians(self.yaw))
        pitch = np.radians(self.pitch)
        back = turn @ np.array([0.0, -np.cos(pitch), np.sin(pitch)])
        target = chest + turn @ np.array([self.aim[0], 0.0, self.aim[1]])
        return Camera(target + self.distance * back, target, width, height)


class Scene:
    """Everything that stays the same through a clip.

    Parameters
    ----------
    diver, water, view, bubbles
        Who is seen, and where.
    seed
        Of the backdrop.
    body
        The diver's body where it is known already; made from the diver's shape otherwise.
    fineness
        Rendered pixels per pixel along each axis.
    light
        Light on the diver, of which 1 is the usual one; less leaves a silhouette.

    """

    def __init__(
        self,
        diver: Diver,
        water: Water,
        view: View,
        bubbles: list[Bubble],
        seed: int,
        *,
        body: Body | None = None,
        fineness: int = SUPERSAMPLING,
        light: float = 1.0,
    ) -> None:
        self.body = body or Body(diver.shape)
        self.light = light
        self.suit, self.water, self.bubbles = diver.suit, water, bubbles
        self.skin = SkinMap(self.body)
        chest = (self.body.head_of("upperarm01.R") + self.body.head_of("upperarm01.L")) / 2
        self.camera = view.camera(chest, WIDTH, HEIGHT)
        self._fine = view.camera(chest, WIDTH * fineness, HEIGHT * fineness)
        self._backdrop = Backdrop(water, self.camera, seed)
        self._parts = kit_parts(self.body, self.skin, diver.kit)
        self._glass = mask_glass(self.skin)
        self._mouth = mouth(self.skin)
        self.refresh()

    def refresh(self) -> None:
        """Take over colours that were given to vertices of `skin`."""
        self._triangles, self._colours = self._assemble()

    def _assemble(self) -> tuple[npt.NDArray[np.int64], Array]:
        """Join body and equipment; colours are NaN where the suit is painted."""
        triangles, colours = [self.body.triangles], [self.skin.eyeballs]
        count = len(self.body.vertices)
        for part in self._parts:
            triangles.append(part.triangles + count)
            colours.append(np.tile(np.array(part.colour, dtype=float), (len(part.vertices), 1)))
            count += len(part.vertices)
        return np.concatenate(triangles), np.concatenate(colours).astype(np.float32)

    def layer(self, joints: Joints, time: float, shift: float = 0.0) -> Array:
        """Draw the diver alone, ``(480, 640, 4)`` RGB and coverage, `shift` pixels to the right."""
        fine = self._diver_layer(joints, time)
        layer: Array = np.empty((HEIGHT, WIDTH, 4), np.float32)
        cv2.resize(fine, (WIDTH, HEIGHT), layer, 0, 0, cv2.INTER_AREA)
        if not shift:
            return layer
        move = np.array([[1.0, 0.0, shift], [0.0, 1.0, 0.0]])
        moved = np.empty_like(layer)
        cv2.warpAffine(layer, move, (WIDTH, HEIGHT), moved)
        return moved

    def render(
        self,
        joints: Joints,
        time: float,
        *,
        shift: float = 0.0,
        behind: Sequence[Array] = (),
        before: Sequence[Array] = (),
    ) -> npt.NDArray[np.uint8]:
        """Draw one frame, ``(480, 640, 3)`` RGB; layers of other divers come farthest first."""
        image = self._backdrop.at(time)
        for layer in (*behind, self.layer(joints, time, shift), *before):
            image *= 1 - layer[..., 3:]
            image += layer[..., :3]
        breath = self._carry(joints, "head", self._mouth[None])[0]
        draw_bubbles(image, self.camera, self.bubbles, breath, time)
        frame: npt.NDArray[np.uint8] = np.clip(image + 0.5, 0, 255).astype(np.uint8)
        return frame

    def _diver_layer(self, joints: Joints, time: float) -> Array:
        """Draw the diver alone: RGB and coverage, supersampled, nothing where no diver is."""
        points = self._points(joints)
        fragments = rasterize(self._fine, points, self._triangles)
        layer = np.zeros((self._fine.height, self._fine.width, 4), np.float32)
        flat = layer.reshape(-1, 4)
        flat[fragments.pixel, :3] = self._shade(points, fragments, time)
        flat[fragments.pixel, 3] = 1
        self._add_glass(flat, joints, fragments)
        return layer

    def pixels(self, points: Array) -> Array:
        """Give where points ``(N, 3)`` appear in the clip, ``(N, 2)`` pixels."""
        return self.camera.project(points)[0]

    def measure_seen(self, joints: Joints, side: str) -> float:
        """Return which share of a hand's pixels in the frame nothing hides, 0 to 1."""
        points = self._points(joints)
        prefixes = ("wrist", "finger", "metacarpal")
        bones = [
            number
            for number, bone in enumerate(self.body.bones)
            if bone.name.startswith(prefixes) and bone.name.endswith(side)
        ]
        on_hand = np.zeros(len(points), bool)
        on_hand[: len(self.body.vertices)] = self.body.weights[:, bones].sum(axis=1) > 0.5
        whole = self._triangles[on_hand[self._triangles].all(axis=1)]
        seen = rasterize(self.camera, points, self._triangles).corners
        alone = len(rasterize(self.camera, points, whole).pixel)
        return float(on_hand[seen].all(axis=1).sum() / max(alone, 1))

    def _points(self, joints: Joints) -> Array:
        """Carry body and equipment into a pose, ``(V, 3)`` metres."""
        return np.concatenate(
            [self.body.skin(joints)]
            + [self._carry(joints, part.bone, part.vertices) for part in self._parts]
        )

    def _carry(self, joints: Joints, bone: str, vertices: Array) -> Array:
        number = self.body.index[bone]
        offset = vertices - self.body.bones[number].head
        moved: Array = offset @ joints.rotation[number].T + joints.position[number]
        return moved

    def _shade(self, points: Array, fragments: Fragments, time: float) -> Array:
        """Light the visible surface: two lamps, sky light, caustics, gloss and haze."""
        normals = vertex_normals(points, self._triangles)
        rest = np.zeros((len(points), len(SkinMap.COLUMNS)))
        rest[: len(self.skin.values)] = self.skin.values
        surface = fragments.interpolate(np.concatenate([points, normals, rest], axis=1))
        given = self._colours[fragments.corners[:, 0]]
        painted = self.skin.paint(self.suit, surface[:, 6:])
        albedo = np.where(np.isnan(given), painted, given)
        position = self.camera.position.astype(np.float32)
        sun, fill = SUN.astype(np.float32), FILL.astype(np.float32)
        colour = _light(surface[:, :3], surface[:, 3:6], albedo, position, sun, fill, time)
        rise = (surface[:, 2] - position[2]) / fragments.depth
        return self.water.haze(self.light * colour, fragments.depth, rise)

    def _add_glass(self, flat: Array, joints: Joints, fragments: Fragments) -> None:
        """Lay the mask's window over the face, with a slanting reflection."""
        points = self._carry(joints, self._glass.bone, self._glass.vertices)
        behind = np.full((self._fine.height, self._fine.width), np.inf, np.float32)
        behind.ravel()[fragments.pixel] = fragments.depth
        glass = rasterize(self._fine, points, self._glass.triangles, behind)
        rest = glass.interpolate(self._glass.vertices - self.skin.eyes)
        slant = rest[:, 0] + 0.55 * rest[:, 2] + 0.038
        reflection = np.exp(-((slant / 0.009) ** 2)) + 0.6 * np.exp(
            -(((slant - 0.022) / 0.004) ** 2)
        )
        share = (0.10 + 0.22 * reflection)[:, None]
        tint = np.array((*self._glass.colour, 1.0))
        flat[glass.pixel] = (1 - share) * flat[glass.pixel] + share * tint


@njit(cache=True)
def _light(places, normals, albedo, camera, sun, fill, time):  # type: ignore[no-untyped-def]
    """Light every pixel: two lamps and the sky, caustics on what faces up, gloss and rim light."""
    colour = np.empty_like(albedo)
    for pixel in range(len(places)):
        x, y, z = places[pixel]
        normal = _direction(normals[pixel])
        view = _direction((camera[0] - x, camera[1] - y, camera[2] - z))
        facing = _dot(normal, view)
        # Either side of a triangle may be seen; light the one that is.
        side = np.float32(1 if facing >= 0 else -1)
        facing, up = side * facing, side * normal[2]
        waves = np.sin(19 * x + 11 * z + 1.5 * time) + np.sin(-13 * x + 23 * z - 1.2 * time)
        waves += np.sin(31 * x - 7 * z + 2.0 * time)
        light = 0.34 + 0.1 * up + 0.07 * waves * max(up + 0.4, 0.0)
        light += 0.62 * max(side * _dot(normal, sun), 0.0)
        light += 0.20 * max(side * _dot(normal, fill), 0.0)
        half = _direction((sun[0] + view[0], sun[1] + view[1], sun[2] + view[2]))
        gloss = 24 * max(side * _dot(normal, half), 0.0) ** 28
        rim = 46 * max(1 - facing, 0.0) ** 4 * min(max(up + 0.6, 0.0), 1.0)
        for channel in range(3):
            colour[pixel, channel] = albedo[pixel, channel] * light + gloss + rim
    return colour


@njit(cache=True)
def _dot(one, other):  # type: ignore[no-untyped-def]
    return one[0] * other[0] + one[1] * other[1] + one[2] * other[2]


@njit(cache=True)
def _direction(vector):  # type: ignore[no-untyped-def]
    length = np.sqrt(_dot(vector, vector)) + 1e-12
    return vector[0] / length, vector[1] / length, vector[2] / length
