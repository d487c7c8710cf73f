"""Pictures of misread takes, for readers who judge what is wrong without reading any sentence.

Above: the gesture's demonstration, the take, and the gesture that it is nearest to, as the paths of
the wrists from blue to red. Below: frames of the clip or of the body, in time; under a clip when a
salute was seen.
"""

from __future__ import annotations

from pathlib import Path
from typing import Final

import cv2
import numpy as np
import numpy.typing as npt

from app.recognition import PoseSequence, Recording
from app.recognition.explanation.strokes import find_drawing_landmarks
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory

Picture = npt.NDArray[np.uint8]

WIDTH, PANEL, TILE = 1260, 330, 210
FRAMES: Final = 12
WHITE = (255, 255, 255)

BONES: Final = (
    ("left_shoulder", "right_shoulder"),
    ("left_hip", "right_hip"),
    *(
        (f"{side}_{one}", f"{side}_{other}")
        for side in ("left", "right")
        for one, other in (("shoulder", "elbow"), ("elbow", "wrist"), ("shoulder", "hip"))
    ),
)


def write(picture: Picture, words: str, at: tuple[int, int]) -> None:
    """Write words into a picture."""
    cv2.putText(picture, words, at, cv2.FONT_HERSHEY_SIMPLEX, 0.5, (0, 0, 0), 1, cv2.LINE_AA)


def draw_paths(trajectory: Trajectory | None, salient: tuple[str, ...], title: str) -> Picture:
    """Draw the paths of the drawing hands."""
    picture = np.full((PANEL, WIDTH // 3, 3), 255, np.uint8)
    write(picture, title, (8, 18))
    names = () if trajectory is None else find_drawing_landmarks(trajectory, salient)
    if trajectory is None or not names:
        write(picture, "no movement", (8, 60))
        return picture
    paths = trajectory.select(names).xy
    low = np.nanmin(paths, axis=(0, 1))
    scale = (PANEL - 70) / max(float(np.nanmax(paths - low)), 1e-6)
    for path in np.moveaxis((paths - low) * scale + (40, 40), 1, 0):
        seen = np.isfinite(path).all(axis=1)
        for step in range(1, len(path)):
            if seen[step - 1] and seen[step]:
                share = step / len(path)
                colour = (255 * (1 - share), 60, 255 * share)
                ends = [tuple(map(int, path[at])) for at in (step - 1, step)]
                cv2.arrowedLine(picture, ends[0], ends[1], colour, 2, cv2.LINE_AA, tipLength=0.3)
        if seen.any():
            first = path[np.flatnonzero(seen)[0]]
            cv2.circle(picture, tuple(map(int, first)), 6, (0, 160, 0), -1)
    return picture


def draw_body(picture: Picture, points: FloatArray, landmarks: tuple[str, ...]) -> None:
    """Draw a body ``(K, 2)`` in pixels."""
    for one, other in BONES:
        if {one, other} <= {*landmarks}:
            ends = points[[landmarks.index(one), landmarks.index(other)]]
            if np.isfinite(ends).all():
                a, b = (tuple(map(int, end)) for end in ends)
                cv2.line(picture, a, b, (0, 220, 255), 3, cv2.LINE_AA)
    for name, point in zip(landmarks, points, strict=True):
        if name.endswith(("wrist", "hand", "hand_tip")) and np.isfinite(point).all():
            colour = (255, 80, 0) if name.startswith("left") else (0, 0, 255)
            cv2.circle(picture, tuple(map(int, point)), 6, colour, -1)


def tile_frames(frames: list[Picture]) -> Picture:
    """Put frames beside each other in two rows."""
    tiles = [cv2.resize(frame, (TILE, TILE * 3 // 4)) for frame in frames]
    tiles += [np.full_like(tiles[0], 255)] * (-len(tiles) % 6)
    rows = [np.concatenate(tiles[at : at + 6], axis=1) for at in range(0, len(tiles), 6)]
    return np.asarray(np.concatenate(rows), dtype=np.uint8)


def draw_clip(path: Path, recording: Recording) -> Picture:
    """Draw frames of a clip with what was found in them, and when a salute was seen."""
    poses = recording.poses
    chosen = np.linspace(0, len(poses) - 1, FRAMES).astype(int).tolist()
    capture, frames = cv2.VideoCapture(str(path)), list[Picture]()
    for number in range(len(poses)):
        found, frame = capture.read()
        if found and number in chosen:
            picture = np.asarray(frame, dtype=np.uint8)
            draw_body(picture, poses.xy[number], poses.landmarks)
            for hand in recording.hands[number]:
                for point in hand.xy:
                    cv2.circle(picture, tuple(map(int, point[:2])), 3, (0, 255, 0), -1)
            write(picture, f"{poses.time[number]:.1f} s", (8, 24))
            frames.append(picture)
    capture.release()
    bar = np.full((70, WIDTH, 3), 255, np.uint8)
    write(bar, "above: frames with a hand found (grey), below: with a salute (green)", (8, 16))
    for number, (hands, score) in enumerate(zip(recording.hands, recording.salute, strict=True)):
        at = int(number / len(poses) * WIDTH)
        wide = max(2, WIDTH // len(poses))
        if hands:
            cv2.rectangle(bar, (at, 24), (at + wide, 44), (150, 150, 150), -1)
        if score >= 0.5:
            cv2.rectangle(bar, (at, 48), (at + wide, 68), (0, 160, 0), -1)
    return np.asarray(np.concatenate([tile_frames(frames), bar]), dtype=np.uint8)


def draw_bodies(poses: PoseSequence) -> Picture:
    """Draw a body as it is at some moments."""
    frames = []
    low = np.nanmin(poses.xy, axis=(0, 1))
    scale = 400 / max(float(np.nanmax(poses.xy - low)), 1e-6)
    for number in np.linspace(0, len(poses) - 1, FRAMES).astype(int).tolist():
        frame = np.full((480, 640, 3), 90, np.uint8)
        draw_body(frame, (poses.xy[number] - low) * scale + (120, 40), poses.landmarks)
        write(frame, f"{poses.time[number] - poses.time[0]:.1f} s", (8, 24))
        frames.append(frame)
    return tile_frames(frames)
