"""Job protocol: work that takes long, reports its progress and can be cancelled."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, TypeVar

from app.api.events.broadcast import Event
from app.api.workers.worker_messages import Pose

Result = TypeVar("Result", covariant=True)


class JobCancelled(Exception):
    """Raised to everybody who waits for a job that was cancelled."""


@dataclass(frozen=True)
class Progress:
    """How far a running job is.

    Attributes
    ----------
    stage
        Stage of an extraction: ``starting``, ``poses`` or ``saving``; other jobs name their own.
    done, total
        Frames or other pieces of work; `total` may be an estimate.
    eta_s
        Seconds still to go at the present rate, or None before there is one.
    time
        For an extraction: time of the newest frame with landmarks, in seconds after the clip's
        first frame; None in the other stages.
    pose
        The body in that frame, or None if it shows nobody.

    """

    stage: str
    done: int = 0
    total: int = 0
    eta_s: float | None = None
    time: float | None = None
    pose: Pose | None = None


def progress_of(event: Event) -> Progress | None:
    """Return the progress in an event; None if it has none."""
    told = event.data.get("progress")
    return None if told is None else Progress(**told)


Report = Callable[[Progress], None]
"""Receives the progress, from any thread; raises `JobCancelled` when the job must end."""


class Job(Protocol[Result]):
    """One piece of work.

    Attributes
    ----------
    key
        Identity: a job whose key is already running waits for that run.
    resumable
        Whether the next start of the server runs it again, so that a stop need not cancel it.

    """

    @property
    def key(self) -> str:
        """Identity among the running jobs."""
        ...

    @property
    def resumable(self) -> bool:
        """Whether the next start of the server runs it again."""
        ...

    def event(self, progress: Progress) -> Event:
        """Return the event to publish about the progress."""
        ...

    async def run(self, report: Report) -> Result:
        """Do the work; cancelling the task or an exception of `report` ends it."""
        ...
