"""The clips that come with the program, to try it without one's own."""

from __future__ import annotations

from fastapi import APIRouter, Request
from starlette.concurrency import run_in_threadpool

from app.api.clips import add_file
from app.api.problems import ProblemError, documented
from app.api.schemas import ClipAccepted, SampleChoice, SampleView
from app.api.studio import CurrentStudio

router = APIRouter(prefix="/samples", tags=["samples"])


@router.get("", responses=documented())
def list_samples(studio: CurrentStudio) -> list[SampleView]:
    """List the sample clips."""
    return [SampleView(name=clip.name, size=clip.size) for clip in studio.samples.clips().values()]


@router.post("", status_code=202, responses=documented(404, 415, 429))
async def import_sample(
    request: Request, chosen: SampleChoice, studio: CurrentStudio
) -> ClipAccepted:
    """Add a sample clip to the clips, as if it had been uploaded."""
    samples = await run_in_threadpool(studio.samples.clips)
    if chosen.name not in samples:
        raise ProblemError(404, "not_found", f"there is no sample clip {chosen.name!r}")
    return await add_file(request, studio, samples[chosen.name].path)
