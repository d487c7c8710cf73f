"""Messages from a worker process to the server, one JSON object per line; long ones in parts."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Base64Bytes, BaseModel, ConfigDict, Field, TypeAdapter

from app.recognition.poses.frame import Pose
from app.recognition.text.described import DESCRIBED

Count = Annotated[int, Field(ge=0, lt=2**31)]
"""A number that every database can keep."""

Line = Annotated[str, AfterValidator(lambda text: text.replace("\0", "\ufffd"))]
"""A text that every database can keep."""

MOST_PICTURE_BYTES = 64 * 1024
"""Most bytes of a picture in a message: 62 kB are 320 x 320 pixels of noise."""


def _require_jpeg(picture: bytes) -> bytes:
    """Check a picture without decoding it: the server opens nothing that a file may have made."""
    if len(picture) > MOST_PICTURE_BYTES or picture[:3] != b"\xff\xd8\xff":
        raise ValueError(f"no JPEG of at most {MOST_PICTURE_BYTES} bytes")
    return picture


Picture = Annotated[Base64Bytes, AfterValidator(_require_jpeg)]
"""A small JPEG, in base64."""

PART_CHARACTERS = 15_000
"""Most characters in a line, each of up to four bytes: asyncio reads lines of at most 64 KiB."""

MORE, LAST = b"+", b"="
"""Beginnings of the lines of a message in parts; every other line is a whole message."""


class _Said(BaseModel):
    """Something that a process says, which a file may have taken over: no infinite numbers."""

    model_config = ConfigDict(allow_inf_nan=False)


class TopicSeen(_Said):
    """A topic of a dive recording that a clip can be made of."""

    model_config = DESCRIBED

    name: Annotated[Line, Field(max_length=255)]
    """As in ROS, with its leading slash."""
    type: Line
    """Of its messages, such as sensor_msgs/msg/Image."""
    use: Literal["pictures", "keypoints"]
    messages: Count
    duration: float
    """Seconds from its first message to its last."""
    width: Count
    """Pixels of the upright picture."""
    height: Count

    @property
    def frames(self) -> int:
        """Frames of the clip that it would be: each message is one."""
        return self.messages


class Probed(_Said):
    """Facts that a file states about its clip (`app.clip_sources.ClipFacts`).

    `picture` is the first frame of a video, made small.
    """

    kind: Literal["probed"] = "probed"
    width: Count
    height: Count
    duration: float | None
    frames: Count | None
    topics: tuple[TopicSeen, ...] = ()
    picture: Picture | None = None


class Progress(_Said):
    """How far work is.

    Attributes
    ----------
    stage
        ``starting``, ``poses`` or ``saving`` of a clip; other work names its own.
    done, total
        Frames or other pieces of work; `total` is an estimate if the container does not count them.
    eta_s
        Seconds still to go at the present rate; None before there is one.
    time
        Time of the newest frame, in seconds after the first; None if no frame is shown.
    pose
        The body in that frame; None if it shows nobody.
    kept
        Recordings of the frames so far that were written, each in place of the one before.

    """

    stage: str
    done: Count = 0
    total: Count = 0
    eta_s: float | None = None
    time: float | None = None
    pose: Pose | None = None
    kept: Count = 0


class Progressed(Progress):
    """Progress of a process; the server estimates the time left."""

    kind: Literal["progressed"] = "progressed"
    stage: Annotated[str, Field(max_length=32)]


class RecognizedTake(_Said):
    """The answer about one take: `Recognition.to_dict` in `answer`, or why there is none.

    Attributes
    ----------
    start, end
        Seconds of the recognised part, without transit.

    """

    start: float
    end: float
    answer: dict[str, Any] | None = None
    fault: Line | None = None


class Answered(_Said):
    """The answer about the take with that index; a process that is started again repeats them."""

    kind: Literal["answered"] = "answered"
    index: Count
    take: RecognizedTake


class Finished(_Said):
    """The work is done: files are on disk; `result` is what it found, if that is no file.

    A clip that was read has `frames` over so many `seconds`, the last one included.
    """

    kind: Literal["finished"] = "finished"
    frames: Count = 0
    seconds: Annotated[float, Field(ge=0, allow_inf_nan=False)] | None = None
    warnings: tuple[Line, ...] = ()
    salute_warnings: tuple[Line, ...] = ()
    result: Any = None


class Failed(_Said):
    """The clip or language file cannot be used; `pointer` is the place of the fault in the file."""

    kind: Literal["failed"] = "failed"
    code: Annotated[str, Field(pattern="^[a-z_]{1,64}$")]
    detail: Line
    pointer: str | None = None


Message = Probed | Progressed | Answered | Finished | Failed

_MESSAGE: TypeAdapter[Message] = TypeAdapter(Annotated[Message, Field(discriminator="kind")])


def dump(message: Message) -> Iterator[str]:
    """Yield the lines for `message`, without line breaks."""
    text = message.model_dump_json()
    if len(text) <= PART_CHARACTERS:
        yield text
        return
    starts = range(0, len(text), PART_CHARACTERS)
    for start in starts:
        begins = LAST if start == starts[-1] else MORE
        yield begins.decode() + text[start : start + PART_CHARACTERS]


def parse(line: bytes) -> Message:
    """Return the message of a line, or of the parts of several.

    Raises
    ------
    ValueError
        When this is no message.

    """
    return _MESSAGE.validate_json(line)
