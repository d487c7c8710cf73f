"""Clips of a diver made of coloured markers, for the models in `marker_models`."""

from __future__ import annotations

from pathlib import Path

import av
import numpy as np
from av.video.stream import VideoStream

from app.recognition.poses.skeletons import COCO_17
from tests.recognition.estimation.marker_models import BODY_COLOURS, draw_markers
from tests.recognition.strategies import BODY, Shape, recording

SIZE = (640, 480)
RATE = 15

RESTING = {
    **BODY,
    "left_eye": (0.12, -1.1),
    "right_eye": (-0.12, -1.1),
    "left_ear": (0.3, -1.0),
    "right_ear": (-0.3, -1.0),
    "left_knee": (0.2, 0.85),
    "right_knee": (-0.2, 0.85),
    "left_ankle": (0.2, 1.2),
    "right_ankle": (-0.2, 1.2),
}
"""Resting places of a diver's COCO keypoints; no two markers touch."""


def marker_clip(path: Path, shape: Shape, *, frames: int = 30) -> Path:
    """Write a lossless clip of a diver in the left half, whose right hand follows `shape`."""
    poses = recording(shape, frames=frames, torso=110.0, centre=(200.0, 230.0), landmarks=COCO_17)
    resting = np.array([RESTING[name] for name in COCO_17]) * 110.0 + (200.0, 230.0)
    places = np.tile(resting, (frames, 1, 1))
    hand = COCO_17.index("right_wrist")
    places[:, hand] = poses.xy[:, hand]

    with av.open(str(path), "w") as container:
        stream = container.add_stream("ffv1", rate=RATE)
        assert isinstance(stream, VideoStream)
        (stream.width, stream.height), stream.pix_fmt = SIZE, "bgr0"
        for moment in places:
            image = np.zeros((SIZE[1], SIZE[0], 3), np.uint8)
            draw_markers(image, moment, BODY_COLOURS, 7)
            frame = av.VideoFrame.from_ndarray(image, format="rgb24").reformat(format="bgr0")
            container.mux(stream.encode(frame))
        container.mux(stream.encode())
    return path
