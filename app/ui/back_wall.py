"""Back wall of the space-time cube: shows the trajectory image behind the trails."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.recognition import PoseSequence
from app.recognition.features.contour import BinaryImage
from app.recognition.features.trajectory_image import MARGIN, SIZE, Drawing
from app.ui.geometry import CubeGeometry


@dataclass(frozen=True, eq=False)
class Wall:
    """A trajectory image and its position.

    Attributes
    ----------
    image
        Trajectory image as the recogniser draws it.
    centre
        x and y, in heights of the video.
    side
        Its width and height, in the same unit.

    """

    image: BinaryImage
    centre: tuple[float, float]
    side: float

    @classmethod
    def from_drawing(
        cls, cube: CubeGeometry, poses: PoseSequence, salient: tuple[str, ...], drawing: Drawing
    ) -> Wall:
        """Centre `drawing` on the trails of the salient landmarks, at their scale.

        A drawing is normalised, without position and scale; both come from the recording.

        Parameters
        ----------
        cube
            The recording's layout.
        poses
            The recording, for its torso length.
        salient
            Landmarks that the drawing shows; each is seen at least once.
        drawing
            The trajectory image; not empty.

        """
        paths = cube.points[:, [cube.landmarks.index(name) for name in salient], :2]
        low, high = np.nanmin(paths, axis=(0, 1)), np.nanmax(paths, axis=(0, 1))
        middle = (low + high) / 2
        extent = float((high - low).max())
        torso, drawn = poses.torso_length(), drawing.trajectory
        if drawn is not None and drawn.unit == "torso_length" and torso is not None:
            size = np.nanmax(drawn.xy, axis=(0, 1)) - np.nanmin(drawn.xy, axis=(0, 1))
            extent = float(size.max()) * torso / poses.frame_size[1]
        side = extent * SIZE / (SIZE - 1 - 2 * MARGIN)
        return cls(drawing.image, (float(middle[0]), float(middle[1])), side)
