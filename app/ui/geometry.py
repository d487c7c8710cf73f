"""Geometry of the space-time cube: positions of video, skeleton and trails.

The axes are those of a camera: x right, y down, z forward, which is time. The height of the video
is 1; the video is centred on the z axis.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import numpy.typing as npt

from app.recognition.poses.landmarks import LANDMARK_GROUPS, SKELETON
from app.recognition.poses.sequence import FloatArray, PoseSequence

Points = npt.NDArray[np.float32]

DEPTH_PER_SECOND = 0.62
"""Depth of one second: a stroke of about three seconds makes a cube one and a half videos deep."""

DEPTH_LIMITS: Final = (1.1, 1.9)
"""Least and largest depth of the cube, so that very short and long clips fit the view as well."""

UNMARKED: Final = frozenset(name for names in LANDMARK_GROUPS.values() for name in names) - {
    "left_wrist",
    "right_wrist",
}
"""Landmarks drawn without a dot: eleven dots on a mask hide the face, three on a hand the
fingers."""

MAX_TRAIL_SEGMENTS = 600
"""Most segments of one trail, which is sent again for every frame; longer ones are decimated."""


@dataclass(frozen=True, eq=False)
class CubeGeometry:
    """Positions of a recording in space and time.

    Attributes
    ----------
    landmarks
        K names.
    points
        ``(T, K, 3)``; NaN where a landmark was not seen.
    depth
        ``(T,)`` z of every moment, from 0.
    aspect
        Aspect ratio of the video, width / height.
    seconds
        Duration.

    """

    landmarks: tuple[str, ...]
    points: Points
    depth: Points
    aspect: float
    seconds: float

    @classmethod
    def from_poses(cls, poses: PoseSequence) -> CubeGeometry:
        """Compute the positions of `poses`; at least one frame."""
        width, height = poses.frame_size
        elapsed = poses.time - poses.time[0]
        seconds = float(elapsed[-1])
        total = float(np.clip(seconds * DEPTH_PER_SECOND, *DEPTH_LIMITS))
        depth = (elapsed / seconds * total if seconds else elapsed).astype(np.float32)
        flat = _flat(poses.xy, poses.frame_size)
        z = np.broadcast_to(depth[:, None, None], (*flat.shape[:2], 1))
        points = np.concatenate([flat, z], axis=2).astype(np.float32)
        return cls(poses.landmarks, points, depth, width / height, seconds)

    def flattened(self, share: float) -> CubeGeometry:
        """Return the same positions with their depth multiplied by `share`; 0: in one plane."""
        points = self.points * np.array([1, 1, share], np.float32)
        return replace(self, points=points, depth=self.depth * np.float32(share))

    @property
    def back(self) -> float:
        """The z of the back wall."""
        return float(self.depth[-1]) if len(self.depth) > 1 else DEPTH_LIMITS[0]

    def depth_at(self, seconds: float) -> float:
        """Return the z of a moment, `seconds` after the first."""
        return self.back * seconds / self.seconds if self.seconds else 0.0

    def place_frame(self, poses: PoseSequence, frame: int, depth: float) -> Points:
        """Return ``(K, 3)`` the positions of one frame of the clip at depth `depth`."""
        flat = _flat(poses.xy[frame], poses.frame_size)
        return np.column_stack([flat, np.full(len(flat), depth)]).astype(np.float32)

    def bones(self, points: Points) -> Points:
        """Return ``(N, 2, 3)`` the bones between ``(K, 3)`` points, where both ends are in view."""
        index = {name: column for column, name in enumerate(self.landmarks)}
        pairs = [(index[a], index[b]) for a, b in SKELETON if a in index and b in index]
        return _without_gaps(self._in_view(points)[np.array(pairs, dtype=int).reshape(-1, 2)])

    def joints(self, points: Points) -> Points:
        """Return ``(N, 3)`` those of ``(K, 3)`` points in view, without face and fingers."""
        shown = [column for column, name in enumerate(self.landmarks) if name not in UNMARKED]
        visible = self._in_view(points[shown])
        return visible[np.isfinite(visible).all(axis=1)]

    def trail_frames(self, stop: int | None = None) -> npt.NDArray[np.intp]:
        """Return the frames at which a trail up to frame `stop` has its corners."""
        last = len(self.depth) - 1 if stop is None else stop
        step = max(1, -(-len(self.depth) // MAX_TRAIL_SEGMENTS))
        return np.unique(np.append(np.arange(0, last + 1, step), last))

    def trail(self, landmark: str, stop: int | None = None) -> Points:
        """Return ``(N, 2, 3)`` a landmark's path up to frame `stop`, with NaN in its gaps."""
        path = self.points[self.trail_frames(stop), self.landmarks.index(landmark)]
        return np.stack([path[:-1], path[1:]], axis=1)

    def other_trails(self, salient: tuple[str, ...]) -> Points:
        """Return ``(N, 2, 3)`` the paths of arms, trunk and legs, where they are in view."""
        rest = [name for name in self.landmarks if name not in UNMARKED and name not in salient]
        trails = [_without_gaps(self._in_view(self.trail(name))) for name in rest]
        return np.concatenate(trails) if trails else np.zeros((0, 2, 3), np.float32)

    def _in_view(self, points: Points) -> Points:
        """Set points outside the video to NaN, because the pose model only guesses them."""
        x, y = np.abs(points[..., 0]), np.abs(points[..., 1])
        inside = (x <= self.aspect / 2) & (y <= 0.5)
        return np.where(inside[..., None], points, np.float32(np.nan))

    def rectangle(self, z: float) -> Points:
        """Return ``(4, 2, 3)`` the outline of the video at depth `z`."""
        x, y = self.aspect / 2, 0.5
        corners = np.array([(-x, -y, z), (x, -y, z), (x, y, z), (-x, y, z)], np.float32)
        return np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)

    def edges(self) -> Points:
        """Return ``(12, 2, 3)`` the edges of the cube."""
        x, y = self.aspect / 2, 0.5
        along = [
            ((sx * x, sy * y, 0.0), (sx * x, sy * y, self.back)) for sx in (-1, 1) for sy in (-1, 1)
        ]
        ends = [self.rectangle(0.0), self.rectangle(self.back)]
        return np.concatenate([np.array(along, np.float32), *ends])

    def ticks(self) -> list[float]:
        """Return the seconds to mark on the time axis: four to eight round values."""
        steps = (0.1, 0.25, 0.5, 1.0, 2.0, 5.0, 10.0, 30.0, 60.0, 120.0, 300.0)
        step = next((step for step in steps if self.seconds / step <= 8), 600.0)
        return [float(value) for value in np.arange(0.0, self.seconds + 1e-6, step)]


def _flat(xy: FloatArray, frame_size: tuple[int, int]) -> FloatArray:
    """Turn pixels to heights of the video about its centre."""
    width, height = frame_size
    return np.asarray((xy - np.array([width, height]) / 2) / height)


def find_complete(segments: Points) -> npt.NDArray[np.bool_]:
    """Return ``(N,)`` which of the ``(N, 2, 3)`` segments have two finite ends."""
    return np.asarray(np.isfinite(segments).all(axis=(1, 2)), dtype=np.bool_)


def _without_gaps(segments: Points) -> Points:
    return segments[find_complete(segments)]
