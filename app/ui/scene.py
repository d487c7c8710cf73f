"""Scene of the space-time cube: video plane, skeleton, trails and back wall in viser.

Blue means "chosen" and orange "expected" throughout: the pair is distinct for every common kind of
colour blindness, and its meaning is always written as well.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Literal

import cv2
import numpy as np
import numpy.typing as npt
import viser

from app.recognition import PoseSequence
from app.recognition.features.contour import BinaryImage
from app.recognition.features.trajectory_image import MARGIN, SIZE, Drawing
from app.recognition.poses.sequence import FloatArray
from app.ui.geometry import CubeGeometry, Points, find_complete
from app.ui.palette import Rgb, load_palette, parse_colour


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


WALL_GAP = 0.03
"""Room between the last frame and the back wall, in heights of the video."""

LAYERS: Final = {"rim": 0.002, "ahead": 0.003, "trail": 0.004, "bones": 0.006, "joints": 0.009}
"""Distances of the drawn layers in front of the video plane, so that they do not flicker with
it."""

DIM = 0.5
"""Brightness of the part of a trail that is still to come."""

VIDEO_QUALITY = 80
"""JPEG quality of the clip's frames."""


class SpaceTimeCube:
    """Drawing of one recording in a viser server's scene.

    Parameters
    ----------
    server
        Server to draw in.
    theme
        Dark or light.

    """

    def __init__(self, server: viser.ViserServer, theme: Theme) -> None:
        self._server = server
        self._theme = theme
        self._whole: CubeGeometry | None = None
        self._cube: CubeGeometry | None = None
        self._depth = 0.0
        self._frame = 0
        self._salient: tuple[str, ...] = ()
        self._colours: npt.NDArray[np.uint8] = np.zeros((0, 3), np.uint8)
        self.clear()

    def clear(self) -> None:
        """Empty the scene."""
        scene = self._server.scene
        scene.reset()
        scene.set_up_direction("-y")
        scene.world_axes.visible = False
        scene.set_background_image(np.full((2, 2, 3), self._theme.background, np.uint8))
        self._whole = self._cube = None

    def recolour(self, theme: Theme) -> None:
        """Use another theme from the next `show` or `clear` on."""
        self._theme = theme

    def show(
        self,
        cube: CubeGeometry,
        salient: tuple[str, ...],
        wall: Wall | None,
        poses: PoseSequence,
        first: int,
    ) -> None:
        """Draw a range of a clip; the video plane stays blank until `seek`.

        Parameters
        ----------
        cube
            The range's positions.
        salient
            Landmarks whose trails stand out.
        wall
            The back wall; None without a trajectory image.
        poses
            Poses of the whole clip.
        first
            Index in the clip of the range's first frame.

        """
        with self._server.atomic():
            self.clear()
            self._whole, self._salient, self._frame = cube, salient, first
            self._poses, self._first = poses, first
            share = cube.depth / cube.back if len(cube.depth) > 1 else np.zeros(1)
            self._colours = map_time_colours(np.asarray(share, dtype=np.float64))
            self._draw_cube(cube)
            self._draw_trails(cube)
            if wall is not None:
                self._draw_wall(cube, wall)
            self._draw_moving_parts(cube)
        self.set_depth(self._depth)

    def set_depth(self, share: float) -> None:
        """Show the cube with `share` of its depth: 0 is the flat picture, 1 the whole cube.

        Edges, ticks, the other trails and the back wall belong to the whole cube only.
        """
        self._depth = share
        if self._whole is None:
            return
        self._cube = cube = self._whole.flattened(share)
        with self._server.atomic():
            for part in self._cube_only:
                part.visible = share == 1
            self._rim.visible = share > 0
            for name, ahead in self._ahead.items():
                whole = cube.trail(name)
                ahead.points = in_front(whole[find_complete(whole)], "ahead")
        self.seek(self._frame, None)

    def seek(self, frame: int, image: npt.NDArray[np.uint8] | None) -> None:
        """Move the video plane, the skeleton and the bright trails to a frame of the clip.

        Before the range the plane stands at the cube's front, after it at its back.
        """
        cube, self._frame = self._cube, frame
        if cube is None:
            return
        inside = min(max(frame - self._first, 0), len(cube.depth) - 1)
        z = float(cube.depth[inside])
        points = cube.place_frame(self._poses, frame, z)
        with self._server.atomic():
            if image is not None:
                self._video.image = image
            self._video.position = (0.0, 0.0, z)
            self._rim.position = (0.0, 0.0, z - LAYERS["rim"])
            self._bones.points = in_front(cube.bones(points), "bones")
            self._joints.points = in_front(cube.joints(points), "joints")
            for name, trail in self._past.items():
                segments, colours = self._bright_trail(cube, name, inside)
                trail.points = segments
                trail.colors = colours
        self._server.flush()

    def _draw_cube(self, cube: CubeGeometry) -> None:
        theme = self._theme
        edges = self._add_lines("/cube/edges", cube.edges(), theme.line)
        x, y = cube.aspect / 2, 0.5
        ticks = cube.ticks()
        marks = [((-x, y, cube.depth_at(t)), (-x - 0.025, y, cube.depth_at(t))) for t in ticks]
        lines = self._add_lines("/cube/ticks", np.array(marks, np.float32), theme.line)
        self._cube_only: list[viser.SceneNodeHandle] = [edges, lines]
        for second in ticks[:: max(1, len(ticks) // 4)]:
            text = text_image(f"{second:g} s", theme.ink)
            height = 0.048
            width = height * text.shape[1] / text.shape[0]
            place = (-x - 0.04 - width / 2, y, cube.depth_at(second))
            name = f"/cube/seconds/{second:g}"
            self._cube_only.append(self._add_image(name, text, (width, height), place))

    def _draw_trails(self, cube: CubeGeometry) -> None:
        scene = self._server.scene
        quiet = cube.other_trails(self._salient)
        if len(quiet):
            self._cube_only.append(self._add_lines("/trails/others", quiet, self._theme.quiet))
        self._past, self._ahead = {}, {}
        for name in self._salient:
            whole = cube.trail(name)
            known = find_complete(whole)
            colours = self._segment_colours(cube.trail_frames())[known]
            ahead = DIM * colours + (1 - DIM) * np.array(self._theme.background)
            self._ahead[name] = scene.add_line_segments(
                f"/trails/{name}/ahead",
                whole[known],
                to_linear(ahead.astype(np.uint8)),
                thickness=0.008,
            )
            segments, bright = self._bright_trail(cube, name, 0)
            self._past[name] = scene.add_line_segments(
                f"/trails/{name}/past", segments, bright, thickness=0.018
            )

    def _bright_trail(
        self, cube: CubeGeometry, name: str, frame: int
    ) -> tuple[Points, npt.NDArray[np.uint8]]:
        stop = min(max(frame, 1), len(cube.depth) - 1)
        segments = cube.trail(name, stop)
        known = find_complete(segments)
        colours = to_linear(self._segment_colours(cube.trail_frames(stop)))
        return in_front(segments[known], "trail"), colours[known]

    def _segment_colours(self, frames: npt.NDArray[np.intp]) -> npt.NDArray[np.uint8]:
        """Return ``(N, 2, 3)`` sRGB at both ends of a trail's segments with corners at `frames`."""
        colours = self._colours[frames]
        return np.stack([colours[:-1], colours[1:]], axis=1)

    def _draw_wall(self, cube: CubeGeometry, wall: Wall) -> None:
        z = cube.back + WALL_GAP
        paper = np.full((2, 2, 3), self._theme.wall, np.uint8)
        plane = self._add_image("/wall/plane", paper, (cube.aspect, 1.0), (0.0, 0.0, z + 0.004))
        ink = tint(wall.image, self._theme.ink)
        side = (wall.side, wall.side)
        self._cube_only += [plane, self._add_image("/wall/image", ink, side, (*wall.centre, z))]

    def _draw_moving_parts(self, cube: CubeGeometry) -> None:
        theme = self._theme
        blank = np.full((2, 2, 3), theme.wall, np.uint8)
        self._video = self._add_image("/video", blank, (cube.aspect, 1.0), (0.0, 0.0, 0.0), "jpeg")
        self._rim = self._add_lines("/rim", cube.rectangle(0.0), theme.rim, 1.6)
        bones = cube.bones(cube.points[0])
        self._bones = self._add_lines("/skeleton/bones", bones, theme.bone, 2.4)
        self._joints = self._server.scene.add_point_cloud(
            "/skeleton/joints",
            cube.joints(cube.points[0]),
            theme.joint,
            point_size=0.011,
            point_shape="circle",
            point_shading="flat",
            precision="float32",
        )

    def _add_lines(
        self, name: str, segments: Points, colour: Rgb, pixels: float = 1.0
    ) -> viser.LineSegmentsHandle:
        return self._server.scene.add_line_segments(
            name, segments, colour, thickness=pixels, thickness_units="screen"
        )

    def _add_image(
        self,
        name: str,
        image: npt.NDArray[np.uint8],
        size: tuple[float, float],
        position: tuple[float, float, float],
        encoding: Literal["png", "jpeg"] = "png",
    ) -> viser.ImageHandle:
        return self._server.scene.add_image(
            name,
            image,
            *size,
            format=encoding,
            jpeg_quality=VIDEO_QUALITY,
            position=position,
            cast_shadow=False,
            receive_shadow=False,
        )


def in_front(points: Points, layer: str) -> Points:
    """Shift points towards the viewer, by the depth of their layer."""
    return points - np.array([0, 0, LAYERS[layer]], np.float32)


def text_image(text: str, colour: Rgb) -> npt.NDArray[np.uint8]:
    """Write text into an image ``(H, W, 4)`` RGBA, transparent around it.

    viser's own labels have grey boxes of one size in every theme.
    """
    font, scale, weight, margin = cv2.FONT_HERSHEY_SIMPLEX, 1.4, 3, 6
    (width, height), below = cv2.getTextSize(text, font, scale, weight)
    alpha = np.zeros((height + below + 2 * margin, width + 2 * margin), np.uint8)
    origin = (margin, height + margin)
    cv2.putText(alpha, text, origin, font, scale, 255, weight, cv2.LINE_AA)
    return tint(alpha, colour)


def tint(alpha: npt.NDArray[np.uint8], colour: Rgb) -> npt.NDArray[np.uint8]:
    """Return an image ``(H, W, 4)`` RGBA of one colour with the opacity ``(H, W)``."""
    image = np.empty((*alpha.shape, 4), np.uint8)
    image[..., :3], image[..., 3] = colour, alpha
    return image
