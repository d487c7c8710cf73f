"""Bodies as messages: our own, the published port's, and ROS4HRI's; and ours read back."""

from __future__ import annotations

from typing import Any

import numpy as np
from osg_interfaces.msg import BodyKeypoints, Keypoint
from std_msgs.msg import Header

from app.recognition.poses.frame import Body
from app.recognition.poses.landmarks import POSE_LANDMARKS, SHOULDERS
from app.recognition.poses.sequence import FloatArray, PoseSequence

DIVER = "diver"
"""The id of the one body that the pose model follows."""

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
"""The constants of ``hri_msgs/Skeleton2D`` that tell a point's place in it (REP-155)."""


def body_message(header: Header, size: FrameSize, body: Body | None) -> BodyKeypoints:
    """Return what was seen of the diver in one picture.

    Parameters
    ----------
    header
        Of the picture.
    size
        Of the picture.
    body
        None: nobody was seen.

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


def body_in(message: BodyKeypoints) -> Body | None:
    """Return the body of a message, the inverse of `body_message`.

    Landmarks are taken by name; what the message lacks is not seen, what is unknown is left out.
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


def published_keypoints(kind: Any, part: Any, size: FrameSize, body: Body) -> Any:
    """Return a body as the published port's pose node sends it.

    Parameters
    ----------
    kind, part
        The types ``keypoints_interfaces/PoseKeypointsArray`` and ``PoseKeypoints``.
    size
        Of the picture: coordinates are fractions of its sides.
    body
        What was seen.

    """
    made = kind()
    for name, (x, y) in zip(POSE_LANDMARKS, (body.xy / size).tolist(), strict=True):
        made.keypoints.append(part(name=name.upper(), x=x, y=y))
    return made


def published_moment(message: Any, seconds: float, size: FrameSize) -> PoseSequence:
    """Return the body in a message of the published port's pose node.

    Parameters
    ----------
    message
        A ``keypoints_interfaces/PoseKeypointsArray``; None: nobody was seen.
    seconds
        When it came; the message itself does not say when the picture was taken.
    size
        Of the picture, which it does not say either.

    """
    xy = np.full((1, len(POSE_LANDMARKS), 2), np.nan)
    for keypoint in () if message is None else message.keypoints:
        name = keypoint.name.lower()
        if name in POSE_LANDMARKS and np.isfinite([keypoint.x, keypoint.y]).all():
            xy[0, POSE_LANDMARKS.index(name)] = keypoint.x * size[0], keypoint.y * size[1]
    return PoseSequence(landmarks=POSE_LANDMARKS, xy=xy, time=np.array([seconds]), frame_size=size)


def skeleton_message(kind: Any, header: Header, size: FrameSize, body: Body) -> Any:
    """Return a body as ROS4HRI's skeleton.

    Parameters
    ----------
    kind
        The type ``hri_msgs/Skeleton2D``.
    header, size
        Of the picture: coordinates are fractions of its sides.
    body
        What was seen. Points that were not seen get the confidence 0.

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
