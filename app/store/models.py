"""Database tables as SQLModel classes; rows leave the store as detached, read-only values."""

from __future__ import annotations

import json
import re
from datetime import UTC, datetime, timedelta
from enum import StrEnum
from typing import Any, ClassVar, Final, Literal
from uuid import uuid4

from sqlalchemy import (
    BigInteger,
    CheckConstraint,
    Column,
    DateTime,
    Integer,
    Text,
    UniqueConstraint,
)
from sqlalchemy.types import TypeDecorator
from sqlmodel import Field, SQLModel

VIDEO = "video"
"""Name of the clip source whose file is the video that players show."""

UPRIGHT = {90: "turned.right", 180: "turned.over", 270: "turned.left"}
"""Names of the files of videos whose pictures are turned clockwise by so many degrees."""


OWN_ID: Final = re.compile(r"[0-9a-f]{32}")
"""An id that `new_id` has made; only such an id becomes a path."""


def now() -> datetime:
    """Return the present moment in UTC."""
    return datetime.now(UTC)


def new_id() -> str:
    """Return a fresh id: 32 hex digits, never derived from what a user typed."""
    return uuid4().hex


class UtcDateTime(TypeDecorator[datetime]):
    """A moment in UTC; SQLite stores no time zone, so it is added when read."""

    impl = DateTime
    cache_ok = True

    def process_bind_param(self, value: datetime | None, dialect: object) -> datetime | None:
        """Store UTC without a zone."""
        return None if value is None else value.astimezone(UTC).replace(tzinfo=None)

    def process_result_value(self, value: datetime | None, dialect: object) -> datetime | None:
        """Add the zone."""
        return None if value is None else value.replace(tzinfo=UTC)


class Json(TypeDecorator[Any]):
    """A value of lists, objects, texts and numbers, stored as JSON text."""

    impl = Text
    cache_ok = True

    def process_bind_param(self, value: Any, dialect: object) -> str | None:
        """Write JSON."""
        return None if value is None else json.dumps(value, ensure_ascii=False, allow_nan=False)

    def process_result_value(self, value: str | None, dialect: object) -> Any:
        """Read JSON."""
        return None if value is None else json.loads(value)


ByteCount = BigInteger().with_variant(Integer(), "sqlite")
"""Type of a number of bytes: 64 bits, which SQLite's integers always have."""


class JobStatus(StrEnum):
    """Where a job stands; the last three are final."""

    QUEUED = "queued"
    RUNNING = "running"
    DONE = "done"
    FAILED = "failed"
    CANCELLED = "cancelled"

    @property
    def final(self) -> bool:
        """Whether nothing happens to the job any more."""
        return self in (JobStatus.DONE, JobStatus.FAILED, JobStatus.CANCELLED)


class _Row(SQLModel):
    """Base of the rows with an id of their own."""

    id: str = Field(default_factory=new_id, primary_key=True, max_length=32)
    created: datetime = Field(default_factory=now, sa_type=UtcDateTime)


class _OwnedRow(SQLModel):
    """Base of the rows that take of somebody's quota."""

    owner: str = Field(
        default="", max_length=80, index=True, sa_column_kwargs={"server_default": ""}
    )
    """Name of the token that made it, to which quotas apply."""


class Clip(_Row, _OwnedRow, table=True):
    """One video, topic of a dive recording, or keypoint file that a user added.

    Its file and the results of its job are in the folder `id` of the clip folder.
    """

    __tablename__ = "clip"

    name: str = Field(max_length=200)
    """The name shown; never used as a path."""
    media_type: str = Field(max_length=64)
    size: int = Field(sa_type=ByteCount)
    """Bytes."""
    width: int
    """Pixels, upright."""
    height: int
    duration: float | None = None
    """Seconds; ``None`` where the container does not say."""
    frames: int | None = None
    """Frames the container states, then those decoded; ``None`` while unknown."""
    topics: list[dict[str, Any]] = Field(
        default=[], sa_column=Column(Json, nullable=False, server_default="[]")
    )
    """Usable topics of a dive recording (`app.bags.TopicSummary`); empty for other clips."""
    topic: str | None = Field(default=None, max_length=255)
    """Name of the topic that this clip is made of; ``None`` before the choice, or for a video."""
    source: str = Field(default=VIDEO, max_length=16, sa_column_kwargs={"server_default": VIDEO})
    """Kind of the received file: the name of its `app.clip_sources.ClipSource`."""
    options: dict[str, Any] | None = Field(default=None, sa_type=Json)
    """How the file is read (`app.clip_sources.ReadOptions`)."""
    idempotency_key: str | None = Field(default=None, max_length=255, unique=True)
    job_id: str = Field(default="", max_length=32, sa_column_kwargs={"server_default": ""})
    """Its newest job; no foreign key, because jobs refer to clips."""
    created: datetime = Field(default_factory=now, sa_type=UtcDateTime, index=True)
    deleted: datetime | None = Field(default=None, sa_type=UtcDateTime)

    @property
    def video_is_made(self) -> bool:
        """Whether its video is made by its job, and is not the received file."""
        return self.source != VIDEO or self.turn != 0

    @property
    def video_name(self) -> str:
        """Name of the file of its video."""
        return UPRIGHT.get(self.turn, VIDEO)

    @property
    def turn(self) -> int:
        """Degrees, clockwise, by which its pictures are turned."""
        return int((self.options or {}).get("turn", 0))

    @property
    def received_size(self) -> int:
        """Bytes that were sent: those of the chapters, if the file was joined of them."""
        return sum((self.options or {}).get("chapters", ())) or self.size

    @property
    def needs_topic(self) -> bool:
        """Whether somebody must choose a topic before its job can begin."""
        return bool(self.topics) and self.topic is None


class Job(_Row, table=True):
    """The extraction of poses and hands from one clip."""

    __tablename__ = "job"
    __table_args__ = (
        CheckConstraint(
            "status IN ('queued', 'running', 'done', 'failed', 'cancelled')", name="job_status"
        ),
    )

    clip_id: str = Field(foreign_key="clip.id", ondelete="CASCADE", index=True, max_length=32)
    client: str = Field(max_length=64)
    """Address that requested it; the queue limit is per client."""
    status: str = Field(default=JobStatus.QUEUED.value, max_length=16, index=True)
    attempts: int = 0
    """Number of starts; a job that ended the server several times is given up."""
    frames: int | None = None
    """Frames decoded, once it is done."""
    error_code: str | None = Field(default=None, max_length=64)
    error: str | None = Field(default=None, sa_column=Column(Text))
    warnings: list[str] = Field(default=[], sa_type=Json)
    """Warnings about the clip for the user, as sentences."""
    salute_warnings: list[str] = Field(
        default=[], sa_column=Column(Json, nullable=False, server_default="[]")
    )
    """Those that concern only languages with the salute as trigger, which `warnings` lacks."""
    created: datetime = Field(default_factory=now, sa_type=UtcDateTime, index=True)
    started: datetime | None = Field(default=None, sa_type=UtcDateTime)
    server: str | None = Field(default=None, max_length=32)
    """The server that runs it, see `JobStore`."""
    lease: datetime | None = Field(default=None, sa_type=UtcDateTime)
    """End of that server's ownership, unless it renews the lease."""
    finished: datetime | None = Field(default=None, sa_type=UtcDateTime)


class LanguageRecord(_Row, table=True):
    """A language's identity; its content is in its revisions."""

    __tablename__ = "language"

    head: int
    """Number of the newest revision."""
    sample: bool = False
    """Whether it was added as a sample."""
    created: datetime = Field(default_factory=now, sa_type=UtcDateTime, index=True)
    deleted: datetime | None = Field(default=None, sa_type=UtcDateTime)


class LanguageRevision(_OwnedRow, table=True):
    """One state of a language, written once and never changed."""

    __tablename__ = "language_revision"

    language_id: str = Field(
        foreign_key="language.id", ondelete="CASCADE", primary_key=True, max_length=32
    )
    revision: int = Field(primary_key=True)
    name: str = Field(max_length=200)
    """The language's name in this revision, for lists."""
    labels: list[str] = Field(sa_type=Json)
    """The gestures' labels, for lists."""
    change: str = Field(max_length=300)
    """Change made by this revision, for the history."""
    author: str = Field(default="", max_length=200, sa_column_kwargs={"server_default": ""})
    """Author of the language according to this revision."""
    document: str = Field(sa_column=Column(Text, nullable=False))
    """The whole language file."""
    size: int = Field(default=0, sa_type=ByteCount, sa_column_kwargs={"server_default": "0"})
    """Bytes of the document."""
    created: datetime = Field(default_factory=now, sa_type=UtcDateTime)


class _TakeRow(_Row):
    """Base of the rows about a take in a clip for a language, and removed with either."""

    language_id: str = Field(
        foreign_key="language.id", ondelete="CASCADE", index=True, max_length=32
    )
    clip_id: str = Field(foreign_key="clip.id", ondelete="CASCADE", index=True, max_length=32)
    start: float
    """Seconds in the clip."""


class _KnownTake(_TakeRow):
    """Base of the takes whose gesture is known."""

    expected: str = Field(max_length=200)
    """The label that it should be recognised as; empty: none of the gestures."""
    added_by: str = Field(default="", max_length=80, sa_column_kwargs={"server_default": ""})
    """Name of the token that added it; empty: not known, or none is needed."""


class _Answer(SQLModel):
    """Base of the rows about how a take was recognised."""

    label: str | None = Field(default=None, max_length=200)
    """The label recognised; ``None``: a pair, or rejected."""
    pair: list[str] | None = Field(default=None, sa_type=Json)
    """The two gestures between which the take lies; ``None``: no two."""


class RecognitionRecord(_TakeRow, _OwnedRow, table=True):
    """One recognition as it was answered, kept even if its language changes."""

    __tablename__ = "recognition"

    revision: int
    end: float
    profile: str = Field(max_length=32)
    expected: str | None = Field(default=None, max_length=200)
    """The label the user meant, if known."""
    result: str = Field(sa_column=Column(Text, nullable=False))
    """`Recognition.to_dict` as JSON."""
    size: int = Field(default=0, sa_type=ByteCount, sa_column_kwargs={"server_default": "0"})
    """Bytes of the result."""
    created: datetime = Field(default_factory=now, sa_type=UtcDateTime, index=True)


class LabelledTake(_KnownTake, table=True):
    """A take whose gesture is known: a query of its language's test set."""

    __tablename__ = "labelled_take"
    __table_args__ = (UniqueConstraint("language_id", "clip_id", "start", name="labelled_range"),)

    end: float
    former: list[str] | None = Field(default=None, sa_type=Json)
    """Digests of the demonstrations of the movement that it shows, since its gesture got another
    one; ``None``: it has not."""


class LabelledResult(_Answer, table=True):
    """Result of a labelled take with one revision of its language."""

    __tablename__ = "labelled_result"

    take_id: str = Field(
        foreign_key="labelled_take.id", ondelete="CASCADE", primary_key=True, max_length=32
    )
    revision: int = Field(primary_key=True)
    recognition_id: str | None = Field(default=None, max_length=32)
    """The recognition; ``None`` if there is none, for the reason in `fault`."""
    nearest: str | None = Field(default=None, max_length=200)
    confidence: float = 0.0
    fault: str | None = Field(default=None, sa_column=Column(Text))
    created: datetime = Field(default_factory=now, sa_type=UtcDateTime)


class PracticeTake(_KnownTake, _Answer, table=True):
    """A gesture that a diver was asked to show, and its recognition."""

    __tablename__ = "practice_take"

    end: ClassVar[None] = None
    """It is the take of its clip that begins at `start`."""
    former: ClassVar[None] = None
    diver: str = Field(max_length=80)
    revision: int
    recognition_id: str = Field(max_length=32)


class Invitation(_Row, table=True):
    """A link by which other people add their takes to one language, and can do nothing else."""

    __tablename__ = "invitation"

    language_id: str = Field(
        foreign_key="language.id", ondelete="CASCADE", index=True, max_length=32
    )
    sha256: str = Field(max_length=64, unique=True)
    """Digest of its token, which is stored nowhere."""
    owner: str = Field(max_length=80)
    """Name of the token that made it: what comes in is that one's, and takes of its quota."""
    most_takes: int
    """Takes that may be sent, also those that are returned."""
    most_bytes: int = Field(sa_type=ByteCount)
    """Bytes of these takes together."""
    takes: int = 0
    """Takes sent so far."""
    bytes: int = Field(default=0, sa_type=ByteCount)
    expires: datetime = Field(sa_type=UtcDateTime)
    withdrawn: datetime | None = Field(default=None, sa_type=UtcDateTime)

    @property
    def closed(self) -> Literal["withdrawn", "expired"] | None:
        """Why it is not valid any more: ``withdrawn``, ``expired``, or None while it is valid."""
        if self.withdrawn is not None:
            return "withdrawn"
        return "expired" if self.expires <= now() else None


ANSWER_TIME: Final = timedelta(minutes=10)
"""Time in which a diver who is asked about a take may answer, before it waits for its owner."""


class InvitedTake(_Row, table=True):
    """A take that somebody sent by an invitation."""

    __tablename__ = "invited_take"
    __table_args__ = (
        CheckConstraint(
            "status IN ('waiting', 'asked', 'added', 'removed', 'returned')",
            name="invited_take_status",
        ),
    )

    invitation_id: str = Field(
        foreign_key="invitation.id", ondelete="CASCADE", index=True, max_length=32
    )
    clip_id: str = Field(max_length=32)
    """Its clip. The clip is stored after this row, and that of a returned take is deleted."""
    label: str = Field(max_length=200)
    """The gesture that it shows."""
    diver: str = Field(max_length=80)
    size: int = Field(sa_type=ByteCount)
    """Bytes."""
    status: str = Field(default="waiting", max_length=16, index=True)
    """``waiting`` for being judged, and for the owner if it has a reason; ``asked`` of the person
    who shows; ``added`` as a demonstration, ``removed``, or ``returned``."""
    reason: str | None = Field(default=None, sa_column=Column(Text, nullable=True))
    """Why it was returned and what to do, or why it is doubted, for the person who shows."""
    read_as: str | None = Field(default=None, max_length=200)
    """The label that the language read in a doubted take; None: none."""
    asked: datetime | None = Field(default=None, sa_type=UtcDateTime)
    """When the person who shows was asked about it."""
    claimed: datetime | None = Field(default=None, sa_type=UtcDateTime)
    """When a server last began to judge it."""

    @property
    def held(self) -> bool:
        """Whether it is neither added nor returned, because it is doubted."""
        return self.status in ("asked", "waiting") and self.reason is not None

    @property
    def standing(self) -> str:
        """Its status; a question that stayed without an answer waits for the owner."""
        late = self.asked is not None and self.asked + ANSWER_TIME <= now()
        return "waiting" if late and self.status == "asked" else self.status


class DemonstrationSource(SQLModel, table=True):
    """The clip that a demonstration was taken from; removed with the clip."""

    __tablename__ = "demonstration_source"

    trajectory: str = Field(primary_key=True, max_length=64)
    """Digest of the demonstration's trajectory, which is the same in every file and revision."""
    clip_id: str = Field(foreign_key="clip.id", ondelete="CASCADE", index=True, max_length=32)
    start: float
    """Seconds in the clip, as requested."""
    end: float
    keep_transit: bool
    """Whether the hand's way from and to the salute was kept."""


class SeededSample(SQLModel, table=True):
    """A sample language that was added once; after deletion it is not added again."""

    __tablename__ = "seeded_sample"

    name: str = Field(primary_key=True, max_length=200)
    created: datetime = Field(default_factory=now, sa_type=UtcDateTime)


class AuditEntry(SQLModel, table=True):
    """One change made by a named token, or one use of the command line."""

    __tablename__ = "audit_entry"

    id: int | None = Field(default=None, primary_key=True)
    time: datetime = Field(default_factory=now, sa_type=UtcDateTime)
    name: str = Field(max_length=80, index=True)
    """Name of the token; empty if none is needed."""
    role: str = Field(max_length=16)
    address: str = Field(max_length=64)
    method: str = Field(max_length=16)
    path: str = Field(max_length=300)
    """Path of the request with its query, which names a gesture; what a command was given."""
    status: int
    """HTTP status of the response; 0 of a command."""
    request_id: str = Field(max_length=64)
    """Id of the request, as in the log."""


class SignIn(SQLModel, table=True):
    """The session of a browser; neither its cookie nor its token can be told from the row."""

    __tablename__ = "sign_in"

    id: str = Field(primary_key=True, max_length=64)
    """SHA-256 of the cookie."""
    name: str = Field(max_length=80, index=True)
    """Name of the token."""
    proof: str = Field(max_length=64)
    """HMAC of the token's digest, with the cookie as key."""
    created: datetime = Field(default_factory=now, sa_type=UtcDateTime, index=True)


class UploadReservation(SQLModel, table=True):
    """The share of its owner's quota that a resumable upload under way takes."""

    __tablename__ = "upload_reservation"

    id: str = Field(primary_key=True, max_length=32)
    """Id of the upload."""
    owner: str = Field(max_length=80, index=True)
    size: int = Field(sa_type=ByteCount)
    """Bytes of the whole file."""
    touched: datetime = Field(sa_type=UtcDateTime)
    """Approximate time at which its last bytes arrived."""


class ChangeCount(SQLModel, table=True):
    """The one row that counts the changes if several servers share the database."""

    __tablename__ = "change_count"

    id: int = Field(default=1, primary_key=True)
    changes: int = Field(sa_type=ByteCount)
