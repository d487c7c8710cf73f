"""Taking in a file as a clip, wherever it came from: looked into, stored, queued, announced."""

from __future__ import annotations

import json
from pathlib import Path

from fastapi import Request
from starlette.concurrency import run_in_threadpool

from app.api.extraction.keypoint_source import KeypointSource
from app.api.extraction.messages import Failed, KeypointsProbed, Probed, TopicSeen
from app.api.http.media_types import HEAD_BYTES, video_type
from app.api.http.problems import ProblemError
from app.api.http.schemas import ClipAccepted
from app.api.ingest.fields import UploadFields
from app.api.services.context import Studio
from app.bags.bag_kind import bag_kind
from app.keypoint_files import Ending, keypoint_ending
from app.store import Clip

MADE_VIDEO = "video/mp4"
"""What is played of a clip that came without a video of its own."""


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


async def examined(
    partial: Path, studio: Studio, *, name: str, size: int, fields: UploadFields | None = None
) -> Clip:
    """Look into a received file.

    Parameters
    ----------
    partial
        The file.
    studio
        What looks into it.
    name, size
        What to call it, and its bytes.
    fields
        What its sender tells of it. Of a dive recording without a topic the only one is meant, or
        it is chosen later.

    Returns
    -------
    The clip that the file would be, not yet stored.

    Raises
    ------
    ProblemError
        415 when it is neither video, dive recording nor keypoint file, 422 when it is one that
        cannot be read, has no such topic, or does not tell enough without `fields`.

    """
    if size == 0:
        raise ProblemError(422, "video_unreadable", f"{name} is empty; record or export it again")
    told = fields or UploadFields()
    head = await run_in_threadpool(_head, partial)
    ending = keypoint_ending(head, name)
    if bag_kind(head) is not None:
        clip = await _examined_bag(partial, studio, name, size, told.topic)
        if isinstance(clip, Clip):
            return clip
        if ending is None:
            raise _refused(clip, name)
    if told.topic is not None:
        raise ProblemError(
            422, "topic_unusable", f"{name} is no dive recording and has no topics; leave it out"
        )
    if ending is not None:
        return await _examined_keypoints(partial, studio, name, size, ending, told)
    return await _examined_video(partial, studio, name, size, video_type(head))


async def _examined_video(
    partial: Path, studio: Studio, name: str, size: int, media_type: str | None
) -> Clip:
    if media_type is None:
        raise ProblemError(
            415,
            "unsupported_media_type",
            f"{name} is neither a video, a dive recording nor a keypoint file this app knows, "
            "whatever its name says; send MP4, MOV, WebM, MKV, AVI, MPEG-TS, a rosbag2 (MCAP, "
            "sqlite3, zip), or keypoints (CSV, JSON, SLEAP, or OpenPose's folder as zip)",
        )
    probed = await studio.runner.probe(partial)
    if isinstance(probed, Failed):
        raise _refused(probed, name)
    return _clip(name, size, media_type, probed)


async def _examined_bag(
    partial: Path, studio: Studio, name: str, size: int, topic: str | None
) -> Clip | Failed:
    """Look into a dive recording; an archive may turn out to hold none."""
    probed = await studio.runner.probe_bag(partial)
    if isinstance(probed, Failed):
        if probed.code == "unsupported_media_type":
            return probed
        raise _refused(probed, name)
    if topic is None and len(probed.topics) == 1:
        topic = probed.topics[0].name
    named = {each.name: each for each in probed.topics}
    if topic is not None and topic not in named:
        raise ProblemError(
            422,
            "topic_unusable",
            f"{name} has no topic {topic!r} that a clip can be made of; it has {', '.join(named)}",
            topics=[each.model_dump() for each in probed.topics],
        )
    shown = named[topic] if topic is not None else probed.topics[0]
    clip = _clip(name, size, MADE_VIDEO, shown)
    clip.topics = json.dumps([each.model_dump() for each in probed.topics])
    clip.topic = topic
    return clip


async def _examined_keypoints(
    partial: Path, studio: Studio, name: str, size: int, ending: Ending, fields: UploadFields
) -> Clip:
    told = KeypointSource(
        ending=ending,
        frame_rate=fields.keypoints.frame_rate,
        frame_size=fields.keypoints.frame_size,
    )
    probed = await studio.runner.probe_keypoints(partial, told)
    if isinstance(probed, Failed):
        raise _refused(probed, name)
    clip = _clip(name, size, MADE_VIDEO, probed)
    clip.keypoints = told.model_dump_json()
    return clip


def _clip(
    name: str, size: int, media_type: str, seen: Probed | TopicSeen | KeypointsProbed
) -> Clip:
    return Clip(
        name=name,
        media_type=media_type,
        size=size,
        width=seen.width,
        height=seen.height,
        duration=seen.duration,
        frames=seen.frames,
    )


async def take_in(clip: Clip, partial: Path, studio: Studio, client: str) -> ClipAccepted:
    """Store an examined file as `clip`, queue its job, and tell the open pages.

    The job of a dive recording whose topic nobody chose has failed already, for that reason.
    """
    added = await run_in_threadpool(studio.clips.add, clip, partial, client)
    if not added.clip.needs_topic:
        await studio.runner.submit(added.job)
    studio.broadcast.publish("clips", id=added.clip.id)
    return ClipAccepted(id=added.clip.id, job_id=added.job.id)


def _refused(probed: Failed, name: str) -> ProblemError:
    status = 415 if probed.code == "unsupported_media_type" else 422
    return ProblemError(status, probed.code, f"{name}: {probed.detail}")


def _head(path: Path) -> bytes:
    with path.open("rb") as file:
        return file.read(HEAD_BYTES)
