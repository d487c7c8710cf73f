"""Schemas of jobs."""

from __future__ import annotations

from datetime import datetime

from app.api.http.schemas.values import View
from app.api.workers.worker_messages import Pose
from app.store import JobStatus


class JobView(View):
    """How far a job is."""

    id: str
    clip_id: str
    status: JobStatus
    stage: str
    """queued, starting, poses, saving, or the final status."""
    done: int
    """Frames."""
    total: int
    """Frames; an estimate where the container does not count them."""
    eta_s: float | None
    """Seconds left at the present rate."""
    time: float | None
    """Seconds after the clip's first frame, of the frame that `pose` was found in; null in every
    stage but poses."""
    pose: Pose | None
    """The newest pose: of each of the 33 landmarks of the body (in the order of `landmarks` in a
    clip's poses) x and y as fractions of the picture's width and height, x right, y down; null: not
    seen. Null as a whole where nobody is in the frame."""
    kept: int
    """How often the poses so far were kept, to be shown before the end of the job."""
    error: str | None
    error_code: str | None
    created: datetime
    started: datetime | None
    finished: datetime | None
