"""Picture turn: by how much pictures must be turned for the diver to be upright in them."""

from __future__ import annotations

from typing import Final

import numpy as np

from app.recognition.poses.landmarks import HIPS, SHOULDERS
from app.recognition.poses.sequence import PoseSequence
from app.recognition.recording.video import Turn

TURNED_SHARE: Final = 0.8
"""Share of the frames with a body in which it must lie in one direction, to be called turned."""

TURNED_DEGREES, MOST_LEAN = 40.0, 60.0
"""Farthest of a torso from a quarter turn, in the median and in these frames: divers lean a little,
and bend, whatever way up they are."""

LEAST_TORSO: Final = 0.5
"""Least length of a torso in shoulder widths: that of somebody who points at the camera is short,
and its direction says nothing."""

FEWEST_TURNED: Final = 10
"""Fewest frames with a body from which it is told."""

HEAD_POINTS: Final[dict[Turn, str]] = {
    90: "lies on the side, the head to the left,",
    180: "is upside down",
    270: "lies on the side, the head to the right,",
}
"""How a diver is seen in a picture that must be turned by so much."""


def find_turn(poses: PoseSequence) -> Turn:
    """Return by how much the picture must be turned for the person to stand upright in it.

    0 where shoulders and hips do not lie sideways or upside down in nearly all frames.
    """
    if not {*SHOULDERS, *HIPS} <= set(poses.landmarks):
        return 0
    shoulders, hips = poses.select(SHOULDERS).xy, poses.select(HIPS).xy
    up = shoulders.mean(axis=1) - hips.mean(axis=1)
    width = np.hypot(*(shoulders[:, 0] - shoulders[:, 1]).T)
    length = np.hypot(*up.T)
    # The comparisons are False for NaN.
    up = up[(length > 0) & (length >= LEAST_TORSO * width)]
    if len(up) < FEWEST_TURNED:
        return 0
    # Clockwise in the picture, whose y points down, from upwards.
    lean = np.degrees(np.arctan2(up[:, 0], -up[:, 1]))
    for turn in HEAD_POINTS:
        off = (lean + turn + 180) % 360 - 180
        steady = (np.abs(off) <= MOST_LEAN).mean() >= TURNED_SHARE
        if steady and abs(np.median(off)) <= TURNED_DEGREES:
            return turn
    return 0
