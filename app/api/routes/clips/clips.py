"""Routes of a clip: upload, read, extract again, delete, restore."""

from __future__ import annotations

import filecmp
import json
from functools import partial
from typing import Annotated

import numpy as np
from fastapi import APIRouter, Header, Request, Response
from fastapi.responses import FileResponse
from starlette.concurrency import run_in_threadpool

from app.api.http.downloads import JPEG, keep_single_range, send_picture
from app.api.http.problems import ProblemError, file_responses, problem_responses
from app.api.http.schemas import clips as schemas
from app.api.http.schemas.values import SoFar, TriggerLanguage
from app.api.ingest.fields import UploadFields
from app.api.ingest.intake import (
    SenderQuota,
    client_of,
    inspect,
    joined,
    require_place_in_queue,
    require_quota,
    store,
)
from app.api.ingest.multipart import file_form, least_size, receive_file
from app.api.services.clip_responses import shows_pictures, view_clip
from app.api.services.clip_takes import find_takes
from app.api.services.running_studio import CurrentStudio, Studio, computed_briefly
from app.clip_sources.source import MADE_VIDEO
from app.store import ClipWithJob, Job, JobStatus
from app.store.tokens import digest
from app.store.uploads import room_of

PIXEL_DIGITS = 2
"""Decimals of a coordinate: no pose model resolves a hundredth of a pixel."""

TIME_DIGITS = 6
"""Decimals of a second: containers count in microseconds at the finest."""

CONFIDENCE_DIGITS = 3
"""Decimals of a confidence: the models' own rounding noise is larger."""

router = APIRouter(prefix="/clips", tags=["clips"])


@router.post(
    "",
    status_code=202,
    responses=problem_responses(408, 409, 415, 429),
    openapi_extra=file_form(**UploadFields.model_json_schema()["properties"]),
)
async def upload_clip(
    request: Request,
    studio: CurrentStudio,
    quota: SenderQuota,
    idempotency_key: Annotated[str | None, Header(max_length=255, min_length=1)] = None,
) -> schemas.ClipAccepted:
    """Store a clip and queue the extraction of its poses.

    Another program's keypoint file is taken too (CSV, JSON, SLEAP, .pose, OpenPose's folder as
    zip); its video is the skeleton, drawn. What the file lacks is refused as `frame_rate_needed`
    or `frame_size_needed`.

    A dive recording (rosbag2) is taken too: of the topic named, or of the only one that can be
    used. Where there are several, the job fails with the code `topic_needed` and the clip lists
    them; choose by `POST /clips/{id}/topic`.

    An upload that repeats an earlier one's `Idempotency-Key` and file answers with that one's clip;
    another file with the same key is refused as `idempotency_key_reused`.
    """
    if idempotency_key and quota.owner:
        # A key belongs to a name: nobody learns of another one's clips by it.
        idempotency_key = digest(f"{quota.owner}\n{idempotency_key}")
    if idempotency_key and (
        earlier := await run_in_threadpool(studio.clips.by_idempotency_key, idempotency_key)
    ):
        return await _repeat(request, studio, earlier)
    reserved = await require_place_in_queue(request, studio)
    await require_quota(quota, studio, least_size(request))
    with studio.clips.receiving() as partial:
        upload = await receive_file(request, partial, studio.settings, reserved=reserved)
        name, fields = upload.name, upload.fields
        room = room_of(upload.size, joined=fields.chapters is not None)
        await require_quota(quota, studio, room)
        async with joined(partial, studio, name=name, fields=fields) as whole:
            made = await inspect(whole, studio, name=name, fields=fields)
            made.clip.idempotency_key = idempotency_key
            return await store(made, whole, studio, request)


async def _repeat(request: Request, studio: Studio, earlier: ClipWithJob) -> schemas.ClipAccepted:
    """Answer an upload whose key was used before; its file must be the same."""
    # The body is read to its end, because a browser receives no answer in the middle of a body.
    with studio.clips.receiving() as partial:
        upload = await receive_file(request, partial, studio.settings)
        received = await run_in_threadpool(studio.clips.received, earlier.clip)
        async with joined(partial, studio, name=upload.name, fields=upload.fields) as whole:
            same = await run_in_threadpool(filecmp.cmp, whole, received, shallow=False)
    if not same:
        detail = "this Idempotency-Key was used for another file; send this one with its own key"
        raise ProblemError(422, "idempotency_key_reused", detail)
    if earlier.clip.deleted is not None:
        detail = (
            f"the clip of this Idempotency-Key was deleted; restore it by POST "
            f"/api/v1/clips/{earlier.clip.id}/restore, or send another key"
        )
        raise ProblemError(409, "clip_deleted", detail, clip_id=earlier.clip.id)
    return schemas.ClipAccepted(id=earlier.clip.id, job_id=earlier.job.id)


@router.get("/{clip_id}", responses=problem_responses(404))
def get_clip(clip_id: str, studio: CurrentStudio) -> schemas.ClipView:
    """Describe one clip."""
    return view_clip(studio.clips.get(clip_id))


@router.delete("/{clip_id}", status_code=204, responses=problem_responses(404))
async def delete_clip(clip_id: str, studio: CurrentStudio) -> Response:
    """Delete a clip and end its job. For a while it can be restored."""
    found = await run_in_threadpool(studio.clips.get, clip_id)
    await run_in_threadpool(studio.clips.delete, clip_id)
    await studio.extractions.cancel(found.job)
    studio.broadcast.publish("clips", id=clip_id)
    return Response(status_code=204)


@router.post("/{clip_id}/restore", responses=problem_responses(404))
def restore_clip(clip_id: str, studio: CurrentStudio) -> schemas.ClipView:
    """Bring a deleted clip back."""
    studio.clips.restore(clip_id)
    studio.broadcast.publish("clips", id=clip_id)
    return view_clip(studio.clips.get(clip_id))


@router.post("/{clip_id}/jobs", status_code=202, responses=problem_responses(404, 409, 429))
async def retry_clip(request: Request, clip_id: str, studio: CurrentStudio) -> schemas.ClipAccepted:
    """Extract the poses again, after a job that failed or was cancelled."""
    clip = (await run_in_threadpool(studio.clips.get, clip_id)).clip
    if clip.needs_topic:
        raise ProblemError(409, "topic_needed", "choose first which topic the clip is made of")
    await require_place_in_queue(request, studio)
    return await _another_job(request, clip_id, studio)


@router.post("/{clip_id}/topic", status_code=202, responses=problem_responses(404, 409, 429))
async def choose_topic(
    request: Request, clip_id: str, choice: schemas.TopicChoice, studio: CurrentStudio
) -> schemas.ClipAccepted:
    """Choose the topic of a dive recording that a clip is made of, and extract its poses."""
    found = await run_in_threadpool(studio.clips.get, clip_id)
    known = [topic["name"] for topic in found.clip.topics]
    if choice.topic not in known:
        detail = f"this clip has no topic {choice.topic!r}; it has {', '.join(known) or 'none'}"
        raise ProblemError(422, "topic_unusable", detail)
    if found.job.status in (JobStatus.QUEUED, JobStatus.RUNNING, JobStatus.DONE):
        detail = f"this clip is made of {found.clip.topic} already; upload the recording again"
        raise ProblemError(409, "job_not_needed", detail)
    await require_place_in_queue(request, studio)
    await run_in_threadpool(studio.clips.choose_topic, clip_id, choice.topic)
    return await _another_job(request, clip_id, studio)


@router.post("/{clip_id}/turn", status_code=202, responses=problem_responses(404, 409, 429))
async def turn_clip(
    request: Request, clip_id: str, choice: schemas.TurnChoice, studio: CurrentStudio
) -> schemas.ClipAccepted:
    """Turn the pictures of a clip whose camera was held another way, and extract its poses anew.

    What was recognised in the clip before stays as it is.
    """
    found = await run_in_threadpool(studio.clips.get, clip_id)
    if found.job.status != JobStatus.DONE:
        raise ProblemError(409, "clip_not_ready", "wait until the poses of this clip are found")
    if not shows_pictures(found.clip):
        detail = "this clip holds keypoints and no pictures; turn them where they were made"
        raise ProblemError(409, "no_pictures", detail)
    await require_place_in_queue(request, studio)
    # The job is stored first, because of two who turn at the same time only one may.
    job = await _queue_again(request, clip_id, studio, anew=True)
    await run_in_threadpool(studio.clips.turn, clip_id, choice.degrees)
    return await _submit(job, studio)


async def _another_job(request: Request, clip_id: str, studio: Studio) -> schemas.ClipAccepted:
    return await _submit(await _queue_again(request, clip_id, studio), studio)


async def _queue_again(
    request: Request, clip_id: str, studio: Studio, *, anew: bool = False
) -> Job:
    retry = partial(studio.jobs.retry, clip_id, client_of(request), anew=anew)
    job = await run_in_threadpool(retry)
    if job is None:
        detail = "the poses of this clip are extracted, or are being extracted, already"
        raise ProblemError(409, "job_not_needed", detail)
    return job


async def _submit(job: Job, studio: Studio) -> schemas.ClipAccepted:
    await studio.extractions.submit(job)
    studio.broadcast.publish("clips", id=job.clip_id)
    return schemas.ClipAccepted(id=job.clip_id, job_id=job.id)


@router.get(
    "/{clip_id}/video",
    response_class=FileResponse,
    responses={
        **file_responses("The clip's own bytes", "video/*", refusals=(404, 409, 416)),
        206: {"description": "The range asked for", "content": {"video/*": {}}},
    },
)
def get_video(request: Request, clip_id: str, studio: CurrentStudio) -> FileResponse:
    """Send the clip as it was uploaded, or a range of it.

    Of a dive recording or a keypoint file, the video that its job made of it.
    """
    clip = studio.clips.get(clip_id).clip
    video = studio.clips.video(clip_id)
    if clip.video_is_made and not video.is_file():
        detail = "the video of this clip is made while its poses are found; wait for its job"
        raise ProblemError(409, "clip_not_ready", detail)
    keep_single_range(request, video.stat().st_size if clip.video_is_made else clip.size)
    return FileResponse(
        video,
        media_type=MADE_VIDEO if clip.video_is_made else clip.media_type,
        filename=f"{clip.name}.mp4" if clip.video_is_made else clip.name,
        content_disposition_type="inline",
        headers={"Cache-Control": "private, max-age=3600"},
    )


@router.get(
    "/{clip_id}/poster",
    response_class=Response,
    responses=file_responses("A small still picture", JPEG),
)
def get_poster(clip_id: str, studio: CurrentStudio) -> Response:
    """Send a still picture of the clip: its first frame until its job begins, if it is a video."""
    studio.clips.get(clip_id)
    missing = "there is no still picture of this clip yet"
    return send_picture(studio.clips.poster(clip_id), "no_poster", missing)


@router.get(
    "/{clip_id}/poses", response_model=schemas.PosesView, responses=problem_responses(404, 409)
)
@computed_briefly
def get_poses(clip_id: str, studio: CurrentStudio) -> Response:
    """Return the landmarks in every frame."""
    poses = studio.recording(clip_id).poses
    xy, confidence = np.round(poses.xy, PIXEL_DIGITS), poses.confidence
    content = {
        "landmarks": list(poses.landmarks),
        "time": np.round(poses.time, TIME_DIGITS).tolist(),
        "xy": np.where(np.isnan(xy), None, xy).tolist(),  # type: ignore[call-overload]
        "confidence": None
        if confidence is None
        else np.round(confidence, CONFIDENCE_DIGITS).tolist(),
        "frame_size": list(poses.frame_size),
    }
    # Serialised here, because pydantic would validate a million numbers again.
    text = json.dumps(content, separators=(",", ":"), allow_nan=False)
    return Response(text, media_type="application/json")


@router.get("/{clip_id}/takes", responses=problem_responses(404, 409))
@computed_briefly
def get_takes(
    clip_id: str,
    studio: CurrentStudio,
    language_id: TriggerLanguage = None,
    so_far: SoFar = False,
) -> list[schemas.TakeView]:
    """List what lies between the salutes, or other triggers of a language."""
    state = None if language_id is None else studio.languages.get(language_id)
    return list(find_takes(studio, clip_id, state, so_far=so_far))
