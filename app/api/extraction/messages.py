"""What a worker process tells the server, one JSON object per line."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, Field, TypeAdapter


class Probed(BaseModel):
    """What the clip says about itself (`app.recognition.video.VideoInfo`)."""

    kind: Literal["probed"] = "probed"
    width: int
    height: int
    duration: float | None
    frames: int | None
    rotation: int
    codec: str


class Progressed(BaseModel):
    """How far the work is."""

    kind: Literal["progressed"] = "progressed"
    stage: str
    done: int
    total: int


class Finished(BaseModel):
    """The recording is on disk."""

    kind: Literal["finished"] = "finished"
    frames: int
    warnings: tuple[str, ...]


class Failed(BaseModel):
    """The clip cannot be used."""

    kind: Literal["failed"] = "failed"
    code: str
    detail: str


Message = Probed | Progressed | Finished | Failed

_MESSAGE: TypeAdapter[Message] = TypeAdapter(Annotated[Message, Field(discriminator="kind")])


def dump(message: Message) -> str:
    """Return the line for `message`, without its end."""
    return message.model_dump_json()


def parse(line: bytes) -> Message:
    """Return the message of a line.

    Raises
    ------
    ValueError
        When it is none.

    """
    return _MESSAGE.validate_json(line)
