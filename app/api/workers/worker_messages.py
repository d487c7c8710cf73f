"""Messages from a worker process to the server, one JSON object per line."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import BaseModel, Field, TypeAdapter

if TYPE_CHECKING:
    from app.recognition.poses.sequence import FloatArray

Pose = tuple[tuple[float, float] | None, ...]
"""A body in one frame, for drawing: x (right) and y (down) of each of `POSE_LANDMARKS`, as
fractions of the upright picture's width and height; outside 0 to 1 beyond the picture's edge, None
if not seen."""

POSE_DIGITS = 4
"""Digits of a pose's fractions: a tenth of a pixel in a picture 1000 wide."""


class TopicSeen(BaseModel):
    """A topic of a dive recording that a clip can be made of."""

    name: str = Field(description="As in ROS, with its leading slash")
    type: str = Field(description="Of its messages, such as sensor_msgs/msg/Image")
    use: Literal["pictures", "keypoints"]
    messages: int
    duration: float = Field(description="Seconds from its first message to its last")
    width: int = Field(description="Pixels of the upright picture")
    height: int

    @property
    def frames(self) -> int:
        """Frames of the clip that it would be: each message is one."""
        return self.messages


class Probed(BaseModel):
    """Facts that a file states about its clip (`app.clip_sources.ClipFacts`)."""

    kind: Literal["probed"] = "probed"
    width: int
    height: int
    duration: float | None
    frames: int | None
    topics: tuple[TopicSeen, ...] = ()


class Progressed(BaseModel):
    """Progress of the work, and the newest pose.

    Attributes
    ----------
    stage
        ``poses`` or ``saving``.
    done, total
        Frames; `total` is an estimate if the container does not count them.
    time
        Time of the newest frame, in seconds after the first; None if no frame is shown.
    pose
        The body in that frame; None if it shows nobody.

    """

    kind: Literal["progressed"] = "progressed"
    stage: str
    done: int
    total: int
    time: float | None = None
    pose: Pose | None = None


class Finished(BaseModel):
    """The recording is on disk."""

    kind: Literal["finished"] = "finished"
    frames: int
    warnings: tuple[str, ...]


class Failed(BaseModel):
    """The clip or language file cannot be used; `pointer` is the place of the fault in the file."""

    kind: Literal["failed"] = "failed"
    code: str
    detail: str
    pointer: str | None = None


Message = Probed | Progressed | Finished | Failed

_MESSAGE: TypeAdapter[Message] = TypeAdapter(Annotated[Message, Field(discriminator="kind")])


def pose_in(xy: FloatArray, width: int, height: int) -> Pose:
    """Return landmarks ``(K, 2)`` in pixels as fractions of a picture of `width` x `height`."""
    return tuple(
        (round(x / width, POSE_DIGITS), round(y / height, POSE_DIGITS))
        if math.isfinite(x) and math.isfinite(y)
        else None
        for x, y in xy.tolist()
    )


def dump(message: Message) -> str:
    """Return the line for `message`, without a line break."""
    return message.model_dump_json()


def parse(line: bytes) -> Message:
    """Return the message of a line.

    Raises
    ------
    ValueError
        When the line is no message.

    """
    return _MESSAGE.validate_json(line)
