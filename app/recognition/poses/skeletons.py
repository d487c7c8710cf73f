"""Skeletons: the landmark sets of other pose estimators, translated to `POSE_LANDMARKS`.

A set is a tuple in the order of its source; None stands for a landmark without counterpart.
OpenPose's neck and mid-hip have none: they follow from the shoulders and the hips.
"""

from __future__ import annotations

import re
from collections.abc import Collection
from typing import Final

from app.recognition.poses.landmarks import POSE_LANDMARKS, UPPER_BODY, name_both_sides

LandmarkSet = tuple[str | None, ...]

COCO_17: Final = (
    "nose",
    *name_both_sides("eye", "ear", "shoulder", "elbow", "wrist", "hip", "knee", "ankle"),
)
"""COCO's keypoints (Lin et al. 2014), which YOLO-pose, RTMPose, MoveNet and HRNet find."""

COCO_18: Final[LandmarkSet] = (
    "nose",
    None,  # neck
    "right_shoulder",
    "right_elbow",
    "right_wrist",
    "left_shoulder",
    "left_elbow",
    "left_wrist",
    "right_hip",
    "right_knee",
    "right_ankle",
    "left_hip",
    "left_knee",
    "left_ankle",
    "right_eye",
    "left_eye",
    "right_ear",
    "left_ear",
)
"""OpenPose's COCO model."""

SKELETON_2D: Final[LandmarkSet] = (
    *COCO_18[:14],
    "left_eye",
    "right_eye",
    "left_ear",
    "right_ear",
)
"""ROS4HRI's `hri_msgs/Skeleton2D`: documented as OpenPose's COCO model, but in the message's own
constants the left eye and the left ear come first."""

BODY_25: Final[LandmarkSet] = (
    *COCO_18[:8],
    None,  # middle of the hips
    *COCO_18[8:],
    "left_foot_index",  # big toe
    None,  # left small toe
    "left_heel",
    "right_foot_index",
    None,  # right small toe
    "right_heel",
)
"""OpenPose's default model (Cao et al. 2019)."""

_SIDES: Final = {"left": "left", "l": "left", "right": "right", "r": "right"}

_PARTS: Final = {
    **{name: name for name in ("nose", "mouth_left", "mouth_right")},
    **{
        part: part
        for name in POSE_LANDMARKS
        if (part := re.sub("^(left|right)_", "", name)) != name
    },
    "big_toe": "foot_index",
}
"""Other programs' names of a landmark without its side, in snake_case, and the names used here."""


def translate_landmark(name: str) -> str | None:
    """Return the landmark for another program's landmark name.

    The side may stand before or behind, as a word or a letter, in any case: ``left_wrist``,
    ``LWrist``, ``wristL``, ``Wrist.L`` and ``LEFT_WRIST`` are the same.

    Returns
    -------
    One of `POSE_LANDMARKS`, or None where the name means none of them.

    """
    words = _words(name)
    plain = "_".join(words)
    if plain in POSE_LANDMARKS:
        return plain
    for side, part in ((words[0], words[1:]), (words[-1], words[:-1])) if words else ():
        known = _PARTS.get("_".join(part))
        if side in _SIDES and known is not None:
            found = f"{_SIDES[side]}_{known}"
            return found if found in POSE_LANDMARKS else None
    return None


def find_missing_landmarks(landmarks: Collection[str]) -> tuple[str, ...]:
    """Return the landmarks of `UPPER_BODY` that a source lacks, in `POSE_LANDMARKS`' order."""
    return tuple(name for name in POSE_LANDMARKS if name in UPPER_BODY and name not in landmarks)


def _words(name: str) -> list[str]:
    """Split a name at punctuation and at changes of case, in lower case."""
    parted = re.sub(
        r"(?<=[a-z0-9])(?=[A-Z])|(?<=\b[LR])(?=[A-Z][a-z])|(?<=\bleft)(?=[a-z])|(?<=\bright)(?=[a-z])",
        " ",
        name,
    )
    return [word.lower() for word in re.split(r"[^A-Za-z0-9]+", parted) if word]
