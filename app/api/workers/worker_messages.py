"""Messages from a worker process to the server, one JSON object per line."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, TypeAdapter

if TYPE_CHECKING:
    from app.recognition.poses.sequence import FloatArray

Count = Annotated[int, Field(ge=0, lt=2**31)]
"""A number that every database can keep."""

Line = Annotated[str, AfterValidator(lambda text: text.replace("\0", "\ufffd"))]
"""A text that every database can keep."""

Pose = tuple[tuple[float, float] | None, ...]
"""A body in one frame, for drawing: x (right) and y (down) of each of `POSE_LANDMARKS`, as
fractions of the upright picture's width and height; outside 0 to 1 beyond the picture's edge, None
if not seen."""

POSE_DIGITS = 4
"""Digits of a pose's fractions: a tenth of a pixel in a picture 1000 wide."""


class _Said(BaseModel):
    """Something that a process says, which a file may have taken over: no infinite numbers."""

    model_config = ConfigDict(allow_inf_nan=False)


class TopicSeen(_Said):
    """A topic of a dive recording that a clip can be made of."""

    name: Annotated[Line, Field(max_length=255)] = Field(
        description="As in ROS, with its leading slash"
    )
    type: Line = Field(description="Of its messages, such as sensor_msgs/msg/Image")
    use: Literal["pictures", "keypoints"]
    messages: Count
    duration: float = Field(description="Seconds from its first message to its last")
    width: Count = Field(description="Pixels of the upright picture")
    height: Count

    @property
    def frames(self) -> int:
        """Frames of the clip that it would be: each message is one."""
        return self.messages


class Probed(_Said):
    """Facts that a file states about its clip (`app.clip_sources.ClipFacts`)."""

    kind: Literal["probed"] = "probed"
    width: Count
    height: Count
    duration: float | None
    frames: Count | None
    topics: tuple[TopicSeen, ...] = ()


class Progressed(_Said):
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
    stage: Annotated[str, Field(max_length=32)]
    done: Count
    total: Count
    time: float | None = None
    pose: Pose | None = None


class Finished(_Said):
    """The recording is on disk."""

    kind: Literal["finished"] = "finished"
    frames: Count
    warnings: tuple[Line, ...]
    salute_warnings: tuple[Line, ...] = ()


class Failed(_Said):
    """The clip or language file cannot be used; `pointer` is the place of the fault in the file."""

    kind: Literal["failed"] = "failed"
    code: Annotated[str, Field(pattern="^[a-z_]{1,64}$")]
    detail: Line
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
