"""Body messages: convert bodies to and from this project's, the published port's and ROS4HRI's."""

from __future__ import annotations

from typing import Any

import numpy as np
from osg_interfaces.msg import BodyKeypoints, Keypoint
from std_msgs.msg import Header

from app.recognition.poses.frame import Body
from app.recognition.poses.landmarks import POSE_LANDMARKS, SHOULDERS
from app.recognition.poses.sequence import FloatArray, PoseSequence

DIVER = "diver"
"""Id of the one body that the pose model tracks."""

FrameSize = tuple[int, int]
"""Width and height of a picture in pixels."""

ROS4HRI_POINTS = (
    "NOSE",
    "NECK",
    *(
        f"{side}_{part}"
        for part in ("SHOULDER", "ELBOW", "WRIST", "HIP", "KNEE", "ANKLE", "EYE", "EAR")
        for side in ("LEFT", "RIGHT")
    ),
)
"""Constants of ``hri_msgs/Skeleton2D`` with the index of each point (REP-155)."""


def to_body_message(header: Header, size: FrameSize, body: Body | None) -> BodyKeypoints:
    """Convert the diver's body in one picture to a message.

    Parameters
    ----------
    header
        Header of the picture.
    size
        Size of the picture.
    body
        The body; None when nobody was seen.

    """
    made = BodyKeypoints(header=header, image_width=size[0], image_height=size[1])
    if body is not None:
        made.body_id = DIVER
        made.score = body.score
        made.keypoints = [
            Keypoint(name=name, x=x, y=y, confidence=confidence)
            for name, (x, y), confidence in zip(
                POSE_LANDMARKS, body.xy.tolist(), body.visibility.tolist(), strict=True
            )
        ]
    return made


def read_body(message: BodyKeypoints) -> Body | None:
    """Read the body of a message, the inverse of `to_body_message`; None when nobody was seen.

    Landmarks are matched by name: one that the message lacks is NaN, unknown names are ignored.
    """
    if not message.keypoints:
        return None
    xy, visibility = np.full((len(POSE_LANDMARKS), 2), np.nan), np.zeros(len(POSE_LANDMARKS))
    for keypoint in message.keypoints:
        if keypoint.name in POSE_LANDMARKS:
            row = POSE_LANDMARKS.index(keypoint.name)
            xy[row] = keypoint.x, keypoint.y
            visibility[row] = keypoint.confidence
    return Body(xy, visibility, message.score)


def to_published_keypoints(kind: Any, part: Any, size: FrameSize, body: Body) -> Any:
    """Convert a body to the message of the published port's pose node.

    Parameters
    ----------
    kind, part
        The types ``keypoints_interfaces/PoseKeypointsArray`` and ``PoseKeypoints``.
    size
        Size of the picture; coordinates in the message are fractions of its sides.
    body
        The body found.

    """
    made = kind()
    for name, (x, y) in zip(POSE_LANDMARKS, (body.xy / size).tolist(), strict=True):
        made.keypoints.append(part(name=name.upper(), x=x, y=y))
    return made


def read_published_body(message: Any, seconds: float, size: FrameSize) -> PoseSequence:
    """Read the body of a message of the published port's pose node, as one frame.

    Parameters
    ----------
    message
        A ``keypoints_interfaces/PoseKeypointsArray``; None when nobody was seen.
    seconds
        Arrival time; the message has no stamp.
    size
        Size of the picture, which the message does not contain.

    """
    xy = np.full((1, len(POSE_LANDMARKS), 2), np.nan)
    for keypoint in () if message is None else message.keypoints:
        name = keypoint.name.lower()
        if name in POSE_LANDMARKS and np.isfinite([keypoint.x, keypoint.y]).all():
            xy[0, POSE_LANDMARKS.index(name)] = keypoint.x * size[0], keypoint.y * size[1]
    return PoseSequence(landmarks=POSE_LANDMARKS, xy=xy, time=np.array([seconds]), frame_size=size)


def to_skeleton_message(kind: Any, header: Header, size: FrameSize, body: Body) -> Any:
    """Convert a body to the skeleton of ROS4HRI.

    Parameters
    ----------
    kind
        The type ``hri_msgs/Skeleton2D``.
    header, size
        Header and size of the picture; coordinates in the message are fractions of its sides.
    body
        The body found. Points that were not seen get the confidence 0.

    """
    made = kind(header=header)
    for name in ROS4HRI_POINTS:
        (x, y), confidence = _point(body, name.lower())
        if np.isfinite([x, y]).all():
            point = made.skeleton[getattr(kind, name)]
            point.x, point.y, point.c = x / size[0], y / size[1], confidence
    return made


def _point(body: Body, name: str) -> tuple[FloatArray, float]:
    """Return a landmark's pixels and its visibility; the neck is between the shoulders."""
    rows = [POSE_LANDMARKS.index(each) for each in (SHOULDERS if name == "neck" else (name,))]
    return body.xy[rows].mean(axis=0), float(body.visibility[rows].min())
