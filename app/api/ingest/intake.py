"""Intake of a received file: probe it, store it as a clip, queue its job, publish the change."""

from __future__ import annotations

import functools
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from fastapi import Depends, Request
from starlette.concurrency import run_in_threadpool

from app.api.http.problems import ProblemError
from app.api.http.schemas.clips import ClipAccepted
from app.api.ingest.fields import UploadFields
from app.api.ingest.multipart import require_space
from app.api.services.identities import identity_of
from app.api.services.running_studio import Studio
from app.api.workers.tasks import Join
from app.api.workers.worker_messages import Failed, Probed
from app.api.workers.worker_processes import Workers
from app.clip_sources import ReadOptions, sources_of_upload, supported_kinds
from app.recognition.recording.file_kinds import find_file_kind, read_head
from app.store import Clip, Quota, QuotaStore, Upload

UNSUPPORTED, STORAGE_UNAVAILABLE = "unsupported_media_type", "storage_unavailable"


@dataclass(frozen=True, eq=False)
class Inspected:
    """A received file that can be used.

    Attributes
    ----------
    clip
        The clip that it would be, not yet stored.
    picture
        JPEG of its first frame, to show while its job waits; None for what is no video.

    """

    clip: Clip
    picture: bytes | None


def client_of(request: Request) -> str:
    """Return to whom the queue limit applies: an invitation, or an address.

    People who were invited may have the address of their host.
    """
    if (invitation := getattr(request.state, "invitation", None)) is not None:
        return f"invitation {invitation.id}"
    return request.client.host[:64] if request.client else "local"


async def require_place_in_queue(request: Request, studio: Studio) -> int:
    """Refuse a request whose sender has too many waiting jobs, before its body is read.

    A resumable upload counts as a job from its beginning.

    Returns
    -------
    Number of bytes that the resumable uploads of all senders have announced and not yet sent.

    """
    most, client = studio.settings.limits.max_jobs_per_client, client_of(request)
    uploads = await run_in_threadpool(studio.uploads.active)
    begun = sum(upload.client == client for upload in uploads)
    if begun + await run_in_threadpool(studio.jobs.count_open, client) >= most:
        raise ProblemError(
            429,
            "queue_full",
            f"{most} clips are waiting already; try again when some of them are done",
            headers={"Retry-After": "30", "Connection": "close"},
        )
    return bytes_to_come(uploads)


def bytes_to_come(uploads: Sequence[Upload]) -> int:
    """Return how many bytes these uploads will still take."""
    return sum(upload.to_come for upload in uploads)


@asynccontextmanager
async def joined(
    partial: Path, studio: Studio, *, name: str, fields: UploadFields
) -> AsyncIterator[Path]:
    """Yield a received file, or the video into which its chapters are joined.

    That one lies beside them until the end of the context, in which its clip is stored.

    Raises
    ------
    ProblemError
        422 when they cannot be joined, 503 or 507 when the disk is too full for it.

    """
    if not (chapters := fields.options.chapters):
        yield partial
        return
    # One at a time: the next one looks at what this one leaves of the disk.
    async with studio.turns.joins:
        uploads = await run_in_threadpool(studio.uploads.active)
        others = [each for each in uploads if each.path != partial]
        size, reserved = partial.stat().st_size, bytes_to_come(others)
        require_space(studio.clips.folder, size, studio.settings, reserved=reserved)
        with studio.clips.receiving() as target:
            ended = await studio.workers.run(Join(file=partial, chapters=chapters, target=target))
            if isinstance(ended, Failed):
                raise _refusal(ended, name)
            yield target


async def inspect(
    partial: Path,
    workers: Workers,
    *,
    name: str,
    fields: UploadFields | None = None,
    one_take: bool = False,
) -> Inspected:
    """Probe a received file.

    Parameters
    ----------
    partial
        The file.
    workers
        Start the process that probes it.
    name
        The name to show.
    fields
        Values from its sender. Without a topic, the only one of a dive recording is taken, or the
        topic is chosen later.
    one_take
        See `ReadOptions.one_take`.

    Raises
    ------
    ProblemError
        415 when the kind of the file is unknown; 422 when the file cannot be read, has no such
        topic, or needs more `fields`.

    """
    if (size := partial.stat().st_size) == 0:
        raise ProblemError(422, "video_unreadable", f"{name} is empty; record or export it again")
    given = fields or UploadFields()
    wanted = given.options.model_copy(update={"one_take": one_take})
    head = await run_in_threadpool(read_head, partial)
    candidates = sources_of_upload(head, name)
    for source in candidates:
        if given.topic is not None and not source.has_topics:
            continue
        options = source.upload_options(head, name, wanted)
        probed = await workers.probe(source, partial, options)
        if isinstance(probed, Probed):
            clip = Clip(
                name=name,
                size=size,
                source=source.name,
                media_type=source.media_type(head),
                **_facts(name, options, probed),
            )
            return Inspected(clip, probed.picture)
        # An archive may turn out to be of another kind than its beginning suggests.
        if probed.code != UNSUPPORTED or source is candidates[-1]:
            raise _refusal(probed, name)
    if given.topic is not None:
        raise ProblemError(
            422, "topic_unusable", f"{name} is no dive recording and has no topics; leave it out"
        )
    kind = find_file_kind(head)
    raise ProblemError(415, UNSUPPORTED, f"{name} is {supported_kinds(kind)}")


async def store(
    inspected: Inspected,
    partial: Path,
    studio: Studio,
    request: Request,
    *,
    upload_id: str | None = None,
) -> ClipAccepted:
    """Store an inspected file as its clip, queue its job, and publish the change.

    The clip is its sender's, unless it names an owner: whoever began a resumable upload.
    The job of a dive recording whose topic is not chosen yet is stored as failed, for that reason.
    What the upload `upload_id` has reserved of the quota passes to the clip.

    Raises
    ------
    QuotaExceeded
        When the clip exceeds its sender's quota; the file stays where it is.

    """
    clip, quota = inspected.clip, quota_of(request)
    clip.owner = clip.owner or quota.owner
    client = client_of(request)
    add = functools.partial(
        studio.clips.add,
        clip,
        partial,
        client,
        quota,
        upload_id=upload_id,
        picture=inspected.picture,
    )
    added = await run_in_threadpool(studio.keep_within, quota, add)
    if not added.clip.needs_topic:
        await studio.extractions.submit(added.job)
    studio.broadcast.publish("clips", id=added.clip.id)
    return ClipAccepted(id=added.clip.id, job_id=added.job.id)


def _facts(name: str, options: ReadOptions, probed: Probed) -> dict[str, Any]:
    """Return the fields of a probed clip that are stored."""
    topic = options.topic
    named = {each.name: each for each in probed.topics}
    if topic is None and len(named) == 1:
        (topic,) = named
    if topic is not None and topic not in named:
        raise ProblemError(
            422,
            "topic_unusable",
            f"{name} has no topic {topic!r} that a clip can be made of; it has {', '.join(named)}",
            topics=[each.model_dump() for each in probed.topics],
        )
    shown = probed if topic is None else named[topic]
    kept = options.model_dump(mode="json", exclude_defaults=True, exclude={"topic"})
    return {
        "width": shown.width,
        "height": shown.height,
        "duration": shown.duration,
        "frames": shown.frames,
        "topics": [each.model_dump() for each in probed.topics],
        "topic": topic,
        "options": kept or None,
    }


def _refusal(probed: Failed, name: str) -> ProblemError:
    status = {UNSUPPORTED: 415, STORAGE_UNAVAILABLE: 503}.get(probed.code, 422)
    return ProblemError(status, probed.code, f"{name}: {probed.detail}")


def quota_of(request: Request) -> Quota:
    """Return the quota of a request's sender; nothing limits it if no token is needed."""
    identity = identity_of(request.scope)
    return Quota(identity.name, identity.quota_bytes, identity.quota_clips)


SenderQuota = Annotated[Quota, Depends(quota_of)]
"""Type of a route's parameter that receives the quota of the request's sender."""


async def require_quota(quota: Quota, quotas: QuotaStore, size: int) -> None:
    """Refuse, early, a clip of at least `size` bytes that exceeds its sender's quota.

    The quota is checked again when the clip or its upload is stored.

    Raises
    ------
    QuotaExceeded
        When it does not fit, even if what the sender deleted is purged.

    """
    if quota.bytes or quota.clips:
        kept = await run_in_threadpool(quotas.usage, quota.owner, deleted=False)
        quota.require(kept, size, clips=1)
