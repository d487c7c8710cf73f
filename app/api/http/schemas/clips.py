"""Schemas of clips."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from app.api.workers.worker_messages import TopicSeen
from app.store import JobStatus


class ClipAccepted(BaseModel):
    """A clip was stored; its poses are extracted by the job."""

    id: str
    job_id: str


class ClipView(BaseModel):
    """A clip, and how far the extraction of its poses is."""

    id: str
    name: str = Field(description="As the sender called the file, without what could do harm")
    status: JobStatus
    error: str | None = Field(description="Why there are no poses, when the job failed")
    error_code: str | None
    warnings: list[str] = Field(description="What was found wanting in the clip")
    salute_warnings: list[str] = Field(
        description="The same of its salutes, for languages with the salute as trigger"
    )
    width: int = Field(description="Pixels of the upright picture")
    height: int
    duration: float | None = Field(
        description="Seconds, where the container says; once its poses are found, as measured"
    )
    frames: int | None = Field(description="Frames decoded; before that, as the container says")
    size: int = Field(description="Bytes")
    media_type: str
    topics: list[TopicSeen] = Field(
        description="Of a dive recording: what a clip can be made of; empty for a video"
    )
    topic: str | None = Field(
        description="Of a dive recording: what the clip is made of; null while nobody chose"
    )
    shows_pictures: bool = Field(
        description="Whether its video shows the diver; else it shows the keypoints that came"
    )
    turn: int = Field(description="Degrees, clockwise, by which its pictures were turned")
    job_id: str
    created: datetime


class TopicChoice(BaseModel):
    """Which topic of a dive recording a clip is to be made of."""

    model_config = ConfigDict(extra="forbid")

    topic: Annotated[str, Field(min_length=1, max_length=255)]


class TurnChoice(BaseModel):
    """By how much the pictures of a clip are to be turned."""

    model_config = ConfigDict(extra="forbid")

    degrees: Literal[90, 180, 270] = Field(description="Clockwise, from how they are shown now")


class PosesView(BaseModel):
    """Landmarks in every frame of a clip."""

    landmarks: list[str]
    time: list[float] = Field(description="Seconds since the first frame, one per frame")
    xy: list[list[list[float | None]]] = Field(
        description="Frames x landmarks x 2: pixels, x right, y down; null: not seen"
    )
    confidence: list[list[float]] | None = Field(description="Frames x landmarks, 0 to 1")
    frame_size: Annotated[list[int], Field(min_length=2, max_length=2)] = Field(
        description="Width and height in pixels"
    )


class TakeView(BaseModel):
    """What lies between two salutes, in seconds of the clip."""

    model_config = ConfigDict(frozen=True, from_attributes=True)

    start: float
    end: float
    closed: bool = Field(description="Whether a second salute ended it")
    stroke_start: float = Field(description="Where the gesture begins: after the hand's way to it")
    stroke_end: float
