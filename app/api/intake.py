"""Taking in a file as a clip, wherever it came from: looked into, stored, queued, announced."""

from __future__ import annotations

from pathlib import Path

from fastapi import Request
from starlette.concurrency import run_in_threadpool

from app.api.extraction.messages import Failed
from app.api.media_types import HEAD_BYTES, video_type
from app.api.problems import ProblemError
from app.api.schemas import ClipAccepted
from app.api.studio import Studio
from app.store import Clip


def client_of(request: Request) -> str:
    """Return the address that a queue limit counts by."""
    return request.client.host[:64] if request.client else "local"


async def require_place_in_queue(request: Request, studio: Studio) -> None:
    """Refuse, before its body is read, a request whose sender has too many jobs waiting."""
    most = studio.settings.max_jobs_per_client
    if await run_in_threadpool(studio.jobs.count_open, client_of(request)) >= most:
        raise ProblemError(
            429,
            "queue_full",
            f"{most} clips are waiting already; try again when some of them are done",
            headers={"Retry-After": "30", "Connection": "close"},
        )


async def examined(partial: Path, studio: Studio, *, name: str, size: int) -> Clip:
    """Look into a received file.

    Returns
    -------
    The clip that the file would be, not yet stored.

    Raises
    ------
    ProblemError
        415 when it is no video, 422 when it is one that cannot be read.

    """
    if size == 0:
        raise ProblemError(422, "video_unreadable", f"{name} is empty; record or export it again")
    media_type = video_type(await run_in_threadpool(_head, partial))
    if media_type is None:
        raise ProblemError(
            415,
            "unsupported_media_type",
            f"{name} is not a video this app knows, whatever its name says; "
            "send MP4, MOV, WebM, MKV, AVI or MPEG-TS",
        )
    probed = await studio.runner.probe(partial)
    if isinstance(probed, Failed):
        raise ProblemError(422, probed.code, f"{name}: {probed.detail}")
    return Clip(
        name=name,
        media_type=media_type,
        size=size,
        width=probed.width,
        height=probed.height,
        duration=probed.duration,
        frames=probed.frames,
    )


async def take_in(clip: Clip, partial: Path, studio: Studio, client: str) -> ClipAccepted:
    """Store an examined file as `clip`, queue its job, and tell the open pages."""
    added = await run_in_threadpool(studio.clips.add, clip, partial, client)
    await studio.runner.submit(added.job)
    studio.broadcast.publish("clips", id=added.clip.id)
    return ClipAccepted(id=added.clip.id, job_id=added.job.id)


def _head(path: Path) -> bytes:
    with path.open("rb") as file:
        return file.read(HEAD_BYTES)
