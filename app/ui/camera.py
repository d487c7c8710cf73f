"""Cameras of the scene: square to the picture, or beside the space-time cube."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
import viser
from viser import CameraHandle

Point = tuple[float, float, float]

DISTANCE = 2.5
"""Distance of the flat camera from the picture, in heights of the video: far enough that the layers
hardly shift against each other."""


ROUNDING = 0.02
"""Difference of the widths by heights of a frame and its picture that whole pixels make."""


@dataclass(frozen=True)
class CameraPose:
    """Position and direction of a camera.

    Attributes
    ----------
    position, target
        Positions of the camera and of its target, in the scene's units.
    fov
        Vertical field of view, in radians.

    """

    position: Point
    target: Point
    fov: float

    @classmethod
    def of(cls, camera: CameraHandle) -> CameraPose:
        """Return the pose of a browser's camera."""
        return cls(_point(camera.position), _point(camera.look_at), float(camera.fov))

    def blend(self, other: CameraPose, share: float) -> CameraPose:
        """Return the pose at `share` of the way to another one."""
        return CameraPose(
            _between(self.position, other.position, share),
            _between(self.target, other.target, share),
            self.fov + share * (other.fov - self.fov),
        )

    def holding(self, picture: float, window: float) -> CameraPose:
        """Return a pose on the same line from which the whole picture is seen.

        `picture` and `window` are widths by heights; in the page's frame they are equal.
        """
        back = max(1.0, picture / window) if abs(picture - window) > ROUNDING else 1.0
        x, y, z = (
            at + back * (own - at) for own, at in zip(self.position, self.target, strict=True)
        )
        return CameraPose((x, y, z), self.target, self.fov)

    def start_with(self, server: viser.ViserServer) -> None:
        """Let browsers that connect begin with this pose."""
        initial = server.initial_camera
        initial.position, initial.look_at, initial.fov = self.position, self.target, self.fov
        initial.up = (0.0, -1.0, 0.0)

    def apply(self, client: viser.ClientHandle) -> None:
        """Move the camera of a browser."""
        with client.atomic():
            # Moving it shifts its target as well, which is set afterwards.
            client.camera.position = self.position
            client.camera.look_at = self.target
            client.camera.up_direction = (0.0, -1.0, 0.0)
            client.camera.fov = self.fov
        client.flush()


FLAT: Final = CameraPose((0.0, 0.0, -DISTANCE), (0.0, 0.0, 0.0), 2 * math.atan(0.5 / DISTANCE))
"""Camera square to the picture, whose height fills the view."""

CUBE: Final = CameraPose((-2.75, -1.15, -1.85), (0.0, 0.28, 0.66), 0.57)
"""Camera left of and above the video: picture, trails and back wall are visible, none edge-on."""


def ease(share: float) -> float:
    """Return the share of the way covered after `share` of the time, slow at both ends."""
    return share * share * (3 - 2 * share)


def _between(start: Point, end: Point, share: float) -> Point:
    return _point(np.asarray(start) + share * (np.asarray(end) - np.asarray(start)))


def _point(values: np.ndarray) -> Point:
    x, y, z = (float(value) for value in values)
    return x, y, z
