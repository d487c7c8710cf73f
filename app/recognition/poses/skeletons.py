"""Skeletons: the landmark sets of other pose estimators, translated to `POSE_LANDMARKS`.

A set is a tuple in the order of its source; None stands for a landmark without counterpart.
OpenPose's neck and mid-hip have none: they follow from the shoulders and the hips.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

from app.recognition.poses.frame import Side
from app.recognition.poses.landmarks import (
    HAND_LANDMARKS,
    POSE_LANDMARKS,
    UPPER_BODY,
    name_both_sides,
)

LandmarkSet = tuple[str | None, ...]

COCO_17: Final = (
    "nose",
    *name_both_sides("eye", "ear", "shoulder", "elbow", "wrist", "hip", "knee", "ankle"),
)
"""COCO's keypoints (Lin et al. 2014), which YOLO-pose, RTMPose, MoveNet and HRNet find."""

COCO_18: Final[LandmarkSet] = (
    "nose",
    None,  # neck
    *("right_shoulder", "right_elbow", "right_wrist"),
    *("left_shoulder", "left_elbow", "left_wrist"),
    *("right_hip", "right_knee", "right_ankle"),
    *("left_hip", "left_knee", "left_ankle"),
    *("right_eye", "left_eye", "right_ear", "left_ear"),
)
"""OpenPose's COCO model."""

SKELETON_2D: Final[LandmarkSet] = (*COCO_18[:14], *name_both_sides("eye", "ear"))
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

HALPE_26: Final[LandmarkSet] = (
    *COCO_17,
    *(None, None, None),  # top of the head, neck, middle of the hips
    "left_foot_index",
    "right_foot_index",
    *(None, None),  # small toes
    "left_heel",
    "right_heel",
)
"""Halpe's body with feet (Fang et al. 2022), of AlphaPose and RTMPose."""

H36M_17: Final[LandmarkSet] = (
    None,  # middle of the hips
    *("right_hip", "right_knee", "right_ankle"),
    *("left_hip", "left_knee", "left_ankle"),
    *(None, None, None, None),  # spine, thorax, neck, top of the head
    *("left_shoulder", "left_elbow", "left_wrist"),
    *("right_shoulder", "right_elbow", "right_wrist"),
)
"""Human3.6M's joints (Ionescu et al. 2014), of estimators of 3D poses."""

CROWDPOSE_14: Final[LandmarkSet] = (*COCO_17[5:], None, None)
"""CrowdPose (Li et al. 2019): COCO's body, then the top of the head and the neck."""

FACE: Final = 68
"""Keypoints of a face, between body and hands of a whole body."""


@dataclass(frozen=True)
class KeypointSet:
    """A set of keypoints that is known by its count, its name or the names in it.

    Attributes
    ----------
    title
        Its name for people.
    landmarks
        N landmarks, one a keypoint; None stands for a keypoint that is left out.
    words
        What a file's own name of the set contains, in lower case, letters and digits alone.
    by_count
        Whether N keypoints without any name are of this set, where their places agree. Other sets
        of 14 and 17 are common.
    middles
        Places of the neck and of the middle of the hips, where the set has them.
    hands
        Place of the first of a hand's 21 keypoints, by its side.

    """

    title: str
    landmarks: LandmarkSet
    words: tuple[str, ...] = ()
    by_count: bool = True
    middles: tuple[int, ...] = ()
    hands: Mapping[Side, int] = field(default_factory=dict)


def _whole_body(
    title: str, body: LandmarkSet, word: str, middles: tuple[int, ...] = ()
) -> KeypointSet:
    left = len(body) + FACE
    right = left + len(HAND_LANDMARKS)
    landmarks = (*body, *(None,) * (FACE + 2 * len(HAND_LANDMARKS)))
    hands: dict[Side, int] = {"left": left, "right": right}
    return KeypointSet(title, landmarks, (word,), middles=middles, hands=hands)


KEYPOINT_SETS: Final = (
    KeypointSet("COCO", COCO_17, ("coco",)),
    KeypointSet("OpenPose's COCO", COCO_18, ("openposecoco",), middles=(1,)),
    KeypointSet("BODY_25", BODY_25, ("body25",), middles=(1, 8)),
    KeypointSet("MediaPipe's upper body", POSE_LANDMARKS[:25], ("mediapipe",)),
    KeypointSet("Halpe", HALPE_26, ("halpe",), middles=(18, 19)),
    KeypointSet("MediaPipe", POSE_LANDMARKS, ("mediapipe",)),
    _whole_body("COCO-WholeBody", (*COCO_17, *(None,) * 6), "coco"),
    _whole_body("Halpe", HALPE_26, "halpe", (18, 19)),
    KeypointSet("H36M", H36M_17, ("h36m", "human36m"), by_count=False),
    KeypointSet("CrowdPose", CROWDPOSE_14, ("crowdpose",), by_count=False),
)
"""The known sets of keypoints."""


def find_keypoint_set(
    count: int, called: str = "", names: Sequence[str] = ()
) -> KeypointSet | None:
    """Return the known set of a file's keypoints.

    Parameters
    ----------
    count
        Number of keypoints.
    called
        The file's name of the set or of the data it comes from, in any spelling; it may be unknown.
    names
        The keypoints' names, if the file gives them: a set is known where each landmark in it has
        its name.

    """
    found = [each for each in KEYPOINT_SETS if len(each.landmarks) == count]
    wanted = re.sub(r"[^a-z0-9]", "", called.lower())
    if known := [each for each in found if any(word in wanted for word in each.words)]:
        return known[0]
    if names:
        own = [translate_landmark(name) for name in names]
        return next((each for each in found if _agrees(each.landmarks, own)), None)
    return next((each for each in found if each.by_count), None)


def _agrees(landmarks: LandmarkSet, own: LandmarkSet | list[str | None]) -> bool:
    return all(one in (None, other) for one, other in zip(landmarks, own, strict=True))


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
