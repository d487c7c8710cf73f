"""Routes of the sample clips that come with the program."""

from __future__ import annotations

import shutil

from fastapi import APIRouter, Request
from starlette.concurrency import run_in_threadpool

from app.api.http.problems import ProblemError, problem_responses
from app.api.http.schemas.clips import ClipAccepted
from app.api.http.schemas.samples import SampleChoice, SampleView
from app.api.ingest.intake import inspect, require_place_in_queue, store
from app.api.ingest.multipart import display_name
from app.api.ingest.quotas import SenderQuota, require_quota
from app.api.services.running_studio import CurrentStudio

router = APIRouter(prefix="/samples", tags=["samples"])


@router.get("", responses=problem_responses())
def list_samples(studio: CurrentStudio) -> list[SampleView]:
    """List the sample clips."""
    clips = studio.samples.clips()
    return [SampleView(name=name, size=file.stat().st_size) for name, file in clips.items()]


@router.post("", status_code=202, responses=problem_responses(404, 415, 429))
async def import_sample(
    request: Request, chosen: SampleChoice, studio: CurrentStudio, quota: SenderQuota
) -> ClipAccepted:
    """Add a sample clip to the clips, as if it had been uploaded."""
    samples = await run_in_threadpool(studio.samples.clips)
    if chosen.name not in samples:
        raise ProblemError(404, "not_found", f"there is no sample clip {chosen.name!r}")
    sample = samples[chosen.name]
    size = sample.stat().st_size
    await require_place_in_queue(request, studio)
    await require_quota(quota, studio, size)
    with studio.clips.receiving() as partial:
        await run_in_threadpool(shutil.copyfile, sample, partial)
        made = await inspect(partial, studio, name=display_name(sample.name), size=size)
        return await store(made, partial, studio, request)
