"""A clip and all that was recognised in it as MCAP, for tools that know nothing of us."""

from __future__ import annotations

import json
from pathlib import Path
from urllib.parse import quote

from fastapi import APIRouter
from fastapi.responses import FileResponse
from starlette.background import BackgroundTask
from starlette.concurrency import run_in_threadpool

from app.api.extraction.mcap_request import RecognitionWish, SessionWishes
from app.api.extraction.messages import Failed
from app.api.http.problems import ProblemError, documented
from app.api.services.context import CurrentStudio, Studio

MEDIA_TYPE = "application/octet-stream"
"""MCAP has no registered media type."""

MOST_RECOGNITIONS = 500
"""In one session, the newest: as many as `GET /recognitions` lists."""

router = APIRouter(prefix="/clips", tags=["clips"])


@router.get(
    "/{clip_id}/session.mcap",
    response_class=FileResponse,
    responses={
        **documented(404, 409),
        200: {"description": "An MCAP file with its schemas inside", "content": {MEDIA_TYPE: {}}},
    },
)
async def get_session(clip_id: str, studio: CurrentStudio) -> FileResponse:
    """Send keypoints, salute, takes, recognitions and video of a clip as one MCAP file.

    Its messages are JSON with their schemas beside them, in Foxglove's own terms where it has some.
    """
    name, wishes = await run_in_threadpool(_wishes, studio, clip_id)
    # The name of a file that is still being written: what a crash leaves is swept at the start.
    target = studio.clips.new_partial()
    try:
        ended = await studio.runner.write_session(clip_id, wishes, target)
        if isinstance(ended, Failed):
            raise ProblemError(503, ended.code, f"the session cannot be written: {ended.detail}")
    except BaseException:
        target.unlink(missing_ok=True)
        raise
    shown = quote(f"{Path(name).stem}.mcap", safe="")
    disposition = f"attachment; filename=\"session.mcap\"; filename*=utf-8''{shown}"
    return FileResponse(
        target,
        media_type=MEDIA_TYPE,
        headers={"Content-Disposition": disposition},
        background=BackgroundTask(target.unlink, missing_ok=True),
    )


def _wishes(studio: Studio, clip_id: str) -> tuple[str, bytes]:
    """Return the clip's name, and what is to be in its session."""
    studio.recording(clip_id)  # raises while its poses are not found
    clip = studio.clips.get(clip_id).clip
    wishes = SessionWishes(
        clip=clip.name,
        recognitions=[
            RecognitionWish(
                start=record.start,
                end=record.end,
                language=studio.languages.get(record.language_id, record.revision).revision.name,
                revision=record.revision,
                expected=record.expected,
                result=json.loads(record.result),
            )
            for record in studio.recognitions.all(clip_id=clip_id, limit=MOST_RECOGNITIONS)
        ],
    )
    return clip.name, wishes.model_dump_json().encode()
