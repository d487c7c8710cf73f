"""A recording as the messages of the pose and the hand node."""

from __future__ import annotations

from collections.abc import Iterator

from osg_interfaces.msg import BodyKeypoints, Hands
from std_msgs.msg import Header

from app.recognition import Recording
from app.recognition.poses.frame import Body
from osg_ros.topics.body_messages import to_body_message
from osg_ros.topics.stamps import to_stamp

BEGAN = 1_700_000_000_123_456_789
"""Nanoseconds since 1970 of the first picture: as a camera stamps it, with no zero at the end."""


def stamped(seconds: float) -> int:
    """Return the nanoseconds of a moment of the recording."""
    return BEGAN + round(seconds * 1e9)


def messages_of(recording: Recording) -> Iterator[tuple[BodyKeypoints, Hands]]:
    """Yield the messages of every picture; a hand that is not there salutes."""
    poses = recording.poses
    assert poses.confidence is not None
    frames = zip(
        poses.time.tolist(), poses.xy, poses.confidence, recording.salute.tolist(), strict=True
    )
    for seconds, xy, confidence, salute in frames:
        header = Header(stamp=to_stamp(stamped(seconds)), frame_id="camera")
        width, height = poses.frame_size
        hands = Hands(header=header, image_width=width, image_height=height, salute=salute)
        yield to_body_message(header, poses.frame_size, Body(xy, confidence, 1.0)), hands
