"""Landmark names: MediaPipe's 33 of the body and 21 of a hand, and the groups used here.

Names are MediaPipe's own in snake_case. "Left" and "right" are the person's, not the image's.
"""

from typing import Final

FINGERS: Final = ("index_finger", "middle_finger", "ring_finger", "pinky")

FACE: Final = (
    "nose",
    "left_eye_inner",
    "left_eye",
    "left_eye_outer",
    "right_eye_inner",
    "right_eye",
    "right_eye_outer",
    "left_ear",
    "right_ear",
    "mouth_left",
    "mouth_right",
)


def name_both_sides(*parts: str) -> tuple[str, ...]:
    """Return the landmarks of parts of the body, of each the left one before the right one."""
    return tuple(f"{side}_{part}" for part in parts for side in ("left", "right"))


POSE_LANDMARKS: Final = (
    *FACE,
    *name_both_sides("shoulder", "elbow", "wrist", "pinky", "index", "thumb"),
    *name_both_sides("hip", "knee", "ankle", "heel", "foot_index"),
)
"""BlazePose's 33 body landmarks in the order of the model's output (Bazarevsky et al. 2020)."""

HAND_LANDMARKS: Final = (
    "wrist",
    *(f"thumb_{joint}" for joint in ("cmc", "mcp", "ip", "tip")),
    *(f"{finger}_{joint}" for finger in FINGERS for joint in ("mcp", "pip", "dip", "tip")),
)
"""The 21 landmarks of one hand in the order of the model's output (Zhang et al. 2020)."""

SHOULDERS: Final = ("left_shoulder", "right_shoulder")
WRISTS: Final = ("left_wrist", "right_wrist")
HIPS: Final = ("left_hip", "right_hip")

TORSO: Final = "torso"
"""Path of the torso's centre in trajectories: the body's lean and sway, without its drift. It
belongs to no recording; `Trajectory.from_poses` computes it."""

LANDMARK_GROUPS: Final[dict[str, tuple[str, ...]]] = {
    "right_hand": ("right_wrist", "right_index", "right_pinky", "right_thumb"),
    "left_hand": ("left_wrist", "left_index", "left_pinky", "left_thumb"),
    "head": FACE,
}
"""Landmarks that move together; a gesture uses at most one of each group (paper, Sec. IV-A).

The first name of a group is its usual representative: the pose model places the wrist most
steadily of a hand's four landmarks, and the nose of the head's eleven.
"""

UPPER_BODY: Final = frozenset(
    {TORSO, *SHOULDERS, *HIPS, "left_elbow", "right_elbow", "nose"}
    | {*LANDMARK_GROUPS["left_hand"], *LANDMARK_GROUPS["right_hand"]}
)
"""Landmarks that gestures are made with or measured against, without the details of the face."""

SKELETON: Final = (
    ("left_shoulder", "right_shoulder"),
    ("left_shoulder", "left_elbow"),
    ("left_elbow", "left_wrist"),
    ("right_shoulder", "right_elbow"),
    ("right_elbow", "right_wrist"),
    ("left_wrist", "left_index"),
    ("left_wrist", "left_pinky"),
    ("left_wrist", "left_thumb"),
    ("right_wrist", "right_index"),
    ("right_wrist", "right_pinky"),
    ("right_wrist", "right_thumb"),
    ("left_shoulder", "left_hip"),
    ("right_shoulder", "right_hip"),
    ("left_hip", "right_hip"),
    ("left_hip", "left_knee"),
    ("left_knee", "left_ankle"),
    ("right_hip", "right_knee"),
    ("right_knee", "right_ankle"),
    ("left_ankle", "left_foot_index"),
    ("right_ankle", "right_foot_index"),
)
"""Pairs of landmarks joined by a bone in drawings; the ten face landmarks are left out."""


def other_side(name: str) -> str:
    """Return the landmark's counterpart on the body's other side, or itself where it has none."""
    for side, other in (("left", "right"), ("right", "left")):
        words = name.split("_")
        if side in words:
            return "_".join(other if word == side else word for word in words)
    return name
