"""Routes of a clip: upload, read, extract again, delete, restore, and what its timeline shows."""

from __future__ import annotations

import filecmp
import json
from functools import partial
from typing import Annotated, Any

import numpy as np
from fastapi import APIRouter, Header, Request, Response
from fastapi.responses import FileResponse
from starlette.concurrency import run_in_threadpool

from app.api.http.downloads import JPEG, keep_single_range, send_picture
from app.api.http.problems import ProblemError, file_responses, problem_responses
from app.api.http.schemas import clips as schemas
from app.api.http.schemas.values import SoFar, TriggerLanguage, View
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
from app.api.services.demonstration_sources import find_takes
from app.api.services.limited_routes import computed_briefly
from app.api.services.recording_cache import recording_of
from app.api.services.running_studio import Clips, CurrentStudio, Languages, Studio
from app.api.services.stored_languages import trigger_of
from app.api.workers.pictures import thumbnails_in
from app.clip_sources.source import MADE_VIDEO
from app.recognition import PoseError, Recording
from app.recognition.poses.landmarks import WRISTS
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.recording.extraction import find_turn
from app.recognition.recording.segmentation import list_unseen
from app.recognition.recording.video import Turn
from app.store import ClipWithJob, Job, JobStatus
from app.store.tokens import digest
from app.store.uploads import room_of

CURVE_DIGITS = 3
"""Decimals of a curve's value: more than a curve forty pixels high can show."""


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
    await require_quota(quota, studio.quotas, least_size(request))
    with studio.clips.receiving() as partial:
        upload = await receive_file(request, partial, studio.settings, reserved=reserved)
        name, fields = upload.name, upload.fields
        room = room_of(upload.size, joined=fields.chapters is not None)
        await require_quota(quota, studio.quotas, room)
        async with joined(partial, studio, name=name, fields=fields) as whole:
            made = await inspect(whole, studio.workers, name=name, fields=fields)
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
def get_clip(clip_id: str, clips: Clips) -> schemas.ClipView:
    """Describe one clip."""
    return view_clip(clips.get(clip_id))


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
    return await _submit(await _add_job(request, clip_id, studio), studio)


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
    return await _submit(await _add_job(request, clip_id, studio), studio)


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
    job = await _add_job(request, clip_id, studio, anew=True)
    await run_in_threadpool(studio.clips.turn, clip_id, choice.degrees)
    return await _submit(job, studio)


async def _add_job(request: Request, clip_id: str, studio: Studio, *, anew: bool = False) -> Job:
    """Store another job of a clip, which `_submit` starts; refuse where none is needed."""
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
def get_video(request: Request, clip_id: str, clips: Clips) -> FileResponse:
    """Send the clip as it was uploaded, or a range of it.

    Of a dive recording or a keypoint file, the video that its job made of it.
    """
    clip = clips.get(clip_id).clip
    video = clips.video(clip_id)
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
def get_poster(clip_id: str, clips: Clips) -> Response:
    """Send a still picture of the clip: its first frame until its job begins, if it is a video."""
    clips.get(clip_id)
    missing = "there is no still picture of this clip yet"
    return send_picture(clips.poster(clip_id), "no_poster", missing)


@router.get(
    "/{clip_id}/poses", response_model=schemas.PosesView, responses=problem_responses(404, 409)
)
@computed_briefly
def get_poses(clip_id: str, clips: Clips) -> Response:
    """Return the landmarks in every frame."""
    poses = recording_of(clips, clip_id).poses
    confidence = poses.confidence
    content = {
        "landmarks": list(poses.landmarks),
        "time": np.round(poses.time, TIME_DIGITS).tolist(),
        "xy": _with_nulls(poses.xy, PIXEL_DIGITS),
        "confidence": None if confidence is None else _with_nulls(confidence, CONFIDENCE_DIGITS),
        "frame_size": list(poses.frame_size),
    }
    # Serialised here, because pydantic would validate a million numbers again.
    text = json.dumps(content, separators=(",", ":"), allow_nan=False)
    return Response(text, media_type="application/json")


@router.get("/{clip_id}/takes", responses=problem_responses(404, 409))
@computed_briefly
def get_takes(
    clip_id: str,
    clips: Clips,
    languages: Languages,
    language_id: TriggerLanguage = None,
    so_far: SoFar = False,
) -> list[schemas.TakeView]:
    """List what lies between the salutes, or other triggers of a language."""
    state = None if language_id is None else languages.get(language_id)
    return list(find_takes(clips, clip_id, state, so_far=so_far))


class TimelineView(View):
    """What lies along a clip's time, one value a frame."""

    time: list[float]
    """Seconds, by the container."""
    salute: list[float]
    """Score of the salute, or of the language's other trigger, 0 to 1."""
    speed: dict[str, list[float | None]]
    """Per wrist, torso lengths a second; null where it was not seen."""
    unseen: list[list[float]]
    """First and last second of each span in which a salute may have been missed: a hole, or a part
    of a take in which too little was seen."""
    unit: str
    """Of the speed's lengths: torso_length, or extent without a torso."""
    thumbnails: int
    """How many the filmstrip has."""
    turn: Turn
    """Degrees, clockwise, by which the picture must be turned for the diver to be upright."""


@router.get(
    "/{clip_id}/timeline", response_model=TimelineView, responses=problem_responses(404, 409)
)
@computed_briefly
def get_timeline(
    clip_id: str,
    clips: Clips,
    languages: Languages,
    language_id: TriggerLanguage = None,
    so_far: SoFar = False,
) -> Response:
    """Return the curves along the clip, one value a frame."""
    recording = recording_of(clips, clip_id, so_far=so_far)
    trigger = trigger_of(languages, language_id)
    scores = np.maximum(*trigger.score(recording.poses, recording.salute))
    has_thumbnails = clips.filmstrip(clip_id).is_file()
    speeds, unit = wrist_speeds(recording)
    content = {
        "time": np.round(recording.poses.time, TIME_DIGITS).tolist(),
        "salute": np.round(scores, CURVE_DIGITS).tolist(),
        "speed": {name: _with_nulls(speed, CURVE_DIGITS) for name, speed in speeds.items()},
        "unseen": [[each.start, each.end] for each in list_unseen(recording, trigger)],
        "unit": unit,
        "thumbnails": thumbnails_in(len(recording.poses)) if has_thumbnails else 0,
        "turn": find_turn(recording.poses) if shows_pictures(clips.get(clip_id).clip) else 0,
    }
    return Response(json.dumps(content, allow_nan=False), media_type="application/json")


@router.get(
    "/{clip_id}/filmstrip",
    response_class=Response,
    responses=file_responses("Thumbnails side by side", JPEG),
)
def get_filmstrip(clip_id: str, clips: Clips) -> Response:
    """Send the thumbnails along the clip, once its poses are found."""
    clips.get(clip_id)
    missing = "there are no thumbnails of this clip yet"
    return send_picture(clips.filmstrip(clip_id), "no_filmstrip", missing)


def wrist_speeds(recording: Recording) -> tuple[dict[str, FloatArray], str]:
    """Return each wrist's speed ``(T,)``, and the unit of its lengths.

    NaN where a wrist was not seen, and throughout if nobody is in view or the wrist is missing.
    """
    count = len(recording.poses)
    speeds = {name: np.full(count, np.nan) for name in WRISTS}
    try:
        trajectory = Trajectory.from_poses(recording.poses)
    except PoseError:
        return speeds, "torso_length"
    # Other programs' keypoints may have no wrist.
    for name in set(WRISTS) & set(trajectory.landmarks):
        path = trajectory.xy[:, trajectory.landmarks.index(name)]
        moves = (
            np.gradient(path, trajectory.time, axis=0) if count > 1 else np.full_like(path, np.nan)
        )
        speeds[name] = np.asarray(np.hypot(moves[:, 0], moves[:, 1]))
    return speeds, trajectory.unit


def _with_nulls(values: FloatArray, digits: int) -> list[Any]:
    rounded = np.round(values, digits)
    return list(np.where(np.isnan(rounded), None, rounded).tolist())  # type: ignore[call-overload]
