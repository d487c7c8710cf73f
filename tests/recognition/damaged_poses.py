"""Recordings with typical errors of pose models."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from app.recognition import PoseSequence
from app.recognition.preprocessing.repair import pair_sides


def with_sides_exchanged(poses: PoseSequence, frames: Iterable[int]) -> PoseSequence:
    """Exchange left and right landmarks in some frames."""
    left, right = pair_sides(poses.landmarks)
    order = np.arange(len(poses.landmarks))
    order[[*left, *right]] = [*right, *left]
    rows = list(frames)
    xy = poses.xy.copy()
    xy[rows] = xy[rows][:, order]
    return replace(poses, xy=xy)
