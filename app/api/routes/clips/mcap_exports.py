"""Routes of the bag export: a clip and its recognitions as one MCAP file."""

from __future__ import annotations

import tempfile
from functools import partial
from pathlib import Path
from typing import Annotated

from fastapi import APIRouter, Query, Request
from fastapi.responses import FileResponse
from starlette.background import BackgroundTask
from starlette.concurrency import run_in_threadpool

from app.api.http.downloads import attachment_as_written
from app.api.http.problems import ProblemError, file_responses, problem_responses
from app.api.http.schemas.values import Body, Identifier, View
from app.api.jobs.job import Job, events_about, run_task
from app.api.routes.awaited_jobs import await_job
from app.api.services.recording_cache import recording_file
from app.api.services.running_studio import CurrentStudio, Studio
from app.api.services.stored_languages import language_of
from app.api.services.stored_recognitions import load_recognition
from app.api.workers.tasks import Export
from app.api.workers.worker_messages import Failed
from app.bags.export_writer import NamedRecognition
from app.recognition.language.file_schema import trigger_to_entry
from app.recognition.triggers.trigger import SALUTE
from app.store.models import new_id

MEDIA_TYPE = "application/octet-stream"
"""MCAP has no registered media type."""

MOST_RECOGNITIONS = 500
"""Most recognitions in one bag, the newest: as many as `GET /recognitions` lists."""

ExportName = Annotated[
    str | None,
    Query(max_length=64, description="Name of an export that was written for this client"),
]

router = APIRouter(prefix="/clips", tags=["clips"])


class SessionExportRequest(Body):
    """An export to write."""

    id: Identifier
    """Chosen by the client: names the export and its events."""


class WrittenSessionView(View):
    """An export that was written."""

    id: str
    name: str
    """Name of the file when it is saved."""
    size: int
    """Bytes."""


@router.post("/{clip_id}/session.mcap", status_code=201, responses=problem_responses(404, 409))
async def write_session(
    request: Request, clip_id: str, wanted: SessionExportRequest, studio: CurrentStudio
) -> WrittenSessionView:
    """Write the MCAP file of a clip, to be fetched from the same address with `export`.

    How far it is comes as `exports` among the events; closing the request cancels it. The file is
    kept for ten minutes, and sent once.
    """
    content = await run_in_threadpool(_export, studio, clip_id)
    target = await _write(request, studio, clip_id, wanted.id, content)
    size = target.stat().st_size
    studio.exports.keep(clip_id, wanted.id, target)
    return WrittenSessionView(id=wanted.id, name=_name(content), size=size)


@router.get(
    "/{clip_id}/session.mcap",
    response_class=FileResponse,
    responses=file_responses(
        "An MCAP file with its schemas inside", MEDIA_TYPE, refusals=(404, 409)
    ),
)
async def get_session(
    request: Request, clip_id: str, studio: CurrentStudio, export: ExportName = None
) -> FileResponse:
    """Send keypoints, salute, takes, recognitions and video of a clip as one MCAP file.

    Its messages are JSON with their schemas beside them, in Foxglove's own terms where it has some.
    It is written first, which closing the request cancels, unless `export` names one that is here:
    another server of several, and a second request, write it again.
    """
    content = await run_in_threadpool(_export, studio, clip_id)
    name = export or new_id()
    target = studio.exports.take(clip_id, name)
    if target is None:
        target = await _write(request, studio, clip_id, name, content)
    disposition = attachment_as_written(_name(content), "session.mcap")
    return FileResponse(
        target,
        media_type=MEDIA_TYPE,
        headers={"Content-Disposition": disposition},
        background=BackgroundTask(target.unlink, missing_ok=True),
    )


async def _write(
    request: Request, studio: Studio, clip_id: str, export_id: str, content: Export
) -> Path:
    """Write an export while its client waits, and return the file, which the caller must remove."""
    # The name marks a partial file, so that after a crash the next start removes it.
    target = studio.clips.new_partial()
    key = f"session {target.name}"
    # In a folder of its own, because the process may write into the folder of its file.
    with tempfile.TemporaryDirectory(prefix=".unpacked-", dir=target.parent) as folder:
        written = Path(folder) / target.name
        task = content.model_copy(update={"target": written})
        event = events_about("exports", id=export_id)
        job = Job("bag_export", key, event, partial(run_task, studio.workers, task))
        ended = await await_job(request, studio.runner, job)
        if isinstance(ended, Failed):
            raise ProblemError(503, ended.code, f"the MCAP file cannot be written: {ended.detail}")
        return written.replace(target)


def _name(content: Export) -> str:
    """Return the name under which a browser saves the file."""
    return f"{Path(content.clip).stem}.mcap"


def _export(studio: Studio, clip_id: str) -> Export:
    """Collect the content of a clip's bag; its file is still to be named."""
    recording = recording_file(studio.clips, clip_id)
    clip = studio.clips.get(clip_id).clip
    records = studio.recognitions.all(clip_id=clip_id, limit=MOST_RECOGNITIONS)
    # Takes are cut by the trigger of the language used last.
    trigger = SALUTE
    if records:
        last = studio.languages.get(records[0].language_id, records[0].revision)
        trigger = language_of(last).trigger
    return Export(
        clip=clip.name,
        video=studio.clips.video(clip_id),
        recording=recording.path,
        target=Path(),
        trigger=trigger_to_entry(trigger),
        recognitions=tuple(
            NamedRecognition(
                start=record.start,
                end=record.end,
                language=studio.languages.get(record.language_id, record.revision).revision.name,
                revision=record.revision,
                expected=record.expected,
                result=load_recognition(record),
            )
            for record in records
        ),
    )
