"""Schemas of clips."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Literal

from pydantic import Field

from app.api.http.schemas.values import Body, View
from app.api.workers.worker_messages import TopicSeen
from app.store import JobStatus


class ClipAccepted(View):
    """A clip was stored; its poses are extracted by the job."""

    id: str
    job_id: str


class ClipView(View):
    """A clip, and how far the extraction of its poses is."""

    id: str
    name: str
    """As the sender called the file, without what could do harm."""
    status: JobStatus
    error: str | None
    """Why there are no poses, when the job failed."""
    error_code: str | None
    warnings: list[str]
    """What was found wanting in the clip."""
    salute_warnings: list[str]
    """The same of its salutes, for languages with the salute as trigger."""
    width: int
    """Pixels of the upright picture."""
    height: int
    duration: float | None
    """Seconds, where the container says; once its poses are found, as measured."""
    frames: int | None
    """Frames decoded; before that, as the container says."""
    size: int
    """Bytes."""
    media_type: str
    topics: list[TopicSeen]
    """Of a dive recording: what a clip can be made of; empty for a video."""
    topic: str | None
    """Of a dive recording: what the clip is made of; null while nobody chose."""
    shows_pictures: bool
    """Whether its video shows the diver; else it shows the keypoints that came."""
    turn: int
    """Degrees, clockwise, by which its pictures were turned."""
    job_id: str
    created: datetime


class TopicChoice(Body):
    """Which topic of a dive recording a clip is to be made of."""

    topic: Annotated[str, Field(min_length=1, max_length=255)]


class TurnChoice(Body):
    """By how much the pictures of a clip are to be turned."""

    degrees: Literal[90, 180, 270]
    """Clockwise, from how they are shown now."""


class PosesView(View):
    """Landmarks in every frame of a clip."""

    landmarks: list[str]
    time: list[float]
    """Seconds since the first frame, one per frame."""
    xy: list[list[list[float | None]]]
    """Frames x landmarks x 2: pixels, x right, y down; null: not seen."""
    confidence: list[list[float]] | None
    """Frames x landmarks, 0 to 1."""
    frame_size: Annotated[list[int], Field(min_length=2, max_length=2)]
    """Width and height in pixels."""


class TakeView(View):
    """What lies between two salutes, in seconds of the clip."""

    start: float
    end: float
    closed: bool
    """Whether a second salute ended it."""
    stroke_start: float
    """Where the gesture begins: after the hand's way to it."""
    stroke_end: float
