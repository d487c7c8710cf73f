"""Schemas of invitations: for whoever invites, and for whoever is invited."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Final, Literal, Self

from pydantic import Field, StrictBool

from app.api.http.schemas.values import Body, View
from app.recognition.gestures.demonstration import MAX_DEMONSTRATIONS
from app.recognition.triggers.trigger import TriggerKind
from app.store import InvitedTake
from app.store.invitations import LONGEST_DAYS

MOST_TAKE_BYTES: Final = 64 * 1024 * 1024
"""Largest clip of one take: ten seconds of the finest video that a phone records by itself."""

TAKES_OF_A_GESTURE: Final = 3
"""Takes that an invitation allows a person for one gesture, because some are returned."""

MEAN_TAKE_BYTES: Final = 16 * 1024 * 1024
"""Bytes that an invitation allows for each take on average: ten seconds of ordinary video."""

TakeStatus = Literal["waiting", "asked", "added", "removed", "returned"]


class InvitationDraft(Body):
    """Whom to invite, for how long."""

    people: Annotated[int, Field(ge=1, lt=MAX_DEMONSTRATIONS)] = 2
    """How many; they share the link."""
    days: Annotated[int, Field(ge=1, le=LONGEST_DAYS)] = 7
    """Until it is over."""
    takes: Annotated[int, Field(ge=1, le=2000)] | None = Field(
        default=None,
        description=f"Most takes, also returned ones; null: {TAKES_OF_A_GESTURE} of each gesture "
        "for each person",
    )
    bytes: Annotated[int, Field(ge=1, le=2**40)] | None = Field(
        default=None, description=f"Most bytes of all takes; null: {MEAN_TAKE_BYTES} for each"
    )


class InvitedTakeView(View):
    """A take that somebody sent by an invitation."""

    id: str
    label: str
    """The gesture that it shows."""
    diver: str
    """Who shows it."""
    status: TakeStatus
    """`waiting`: it is looked at, or with a `reason` waits for the owner; `asked`: of the person
    who shows."""
    reason: str | None
    """Why it was returned, and what to do; or why it is doubted; else null."""

    @classmethod
    def of(cls, take: InvitedTake) -> Self:
        """Return what is shown of a take."""
        return cls(**take.model_dump() | {"status": take.standing})


class InvitedAnswer(Body):
    """What the person who shows says about a take that is asked about."""

    confirmed: StrictBool
    """It is the gesture; false: another take will be shown."""


class ReceivedTakeView(InvitedTakeView):
    """A take for whoever invited."""

    clip_id: str


class ReceivedTakeChange(Body):
    """What becomes of a take that is held, was added, or was removed."""

    status: Literal["added", "removed"]


class ReceivedTakeOutlook(View):
    """A take that is held, and what the language would read with it."""

    start: float
    """Seconds in its clip."""
    end: float
    image: str
    """Its drawing with start dot and arrow: a data URI of a PNG."""
    known: int
    """Known takes of the test set and of practice."""
    repaired: int
    """Of these, those that are read right only with it."""
    broken: int
    """Those that are read right only without it."""


class InvitationView(View):
    """An invitation and what came in by it; its link is told only once, when it is made."""

    id: str
    created: datetime
    expires: datetime
    closed: Literal["withdrawn", "expired"] | None
    """Null while it is valid."""
    most_takes: int
    most_bytes: int
    takes: int
    """Takes sent so far, also returned ones."""
    bytes: int
    """Bytes of these takes together."""
    shown: list[ReceivedTakeView]
    """These takes, the oldest first."""


class NewInvitationView(InvitationView):
    """An invitation that was just made, with the link that is stored nowhere."""

    link: str
    qr: str
    """The link as a QR code: an SVG document."""


class InvitedGestureView(View):
    """A gesture to show."""

    label: str
    description: str
    image: str
    """Its drawing with start dot and arrow: a data URI of a PNG."""
    seconds: float | None
    """How long it lasts; null: not known."""
    held_shapes: int
    """Hand shapes that are held: 0 in a movement."""


class InvitedView(View):
    """What somebody sees who was invited: the gestures of one language, and nothing else."""

    id: str
    """The invitation's."""
    language: str
    """Name of the language."""
    trigger: TriggerKind
    """What begins and ends a take."""
    expires: datetime
    takes_left: int
    most_bytes: int
    """Largest clip of one take."""
    gestures: list[InvitedGestureView]
