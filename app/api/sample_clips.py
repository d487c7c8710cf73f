"""The clips that come with the program, to try it without one's own."""

from __future__ import annotations

from fastapi import APIRouter, Request
from starlette.concurrency import run_in_threadpool

from app.api.clips import add_file
from app.api.problems import ProblemError, documented
from app.api.schemas import ClipAccepted, SampleView
from app.api.studio import CurrentStudio

router = APIRouter(prefix="/samples", tags=["samples"])


@router.get("", responses=documented())
def list_samples(studio: CurrentStudio) -> list[SampleView]:
    """List the sample clips."""
    return [SampleView(name=clip.name, size=clip.size) for clip in studio.samples.clips().values()]


@router.post("/{name}", status_code=202, responses=documented(404, 415, 429))
async def import_sample(request: Request, name: str, studio: CurrentStudio) -> ClipAccepted:
    """Add a sample clip to the clips, as if it had been uploaded."""
    samples = await run_in_threadpool(studio.samples.clips)
    if name not in samples:
        raise ProblemError(404, "not_found", f"there is no sample clip {name[:80]!r}")
    return await add_file(request, studio, samples[name].path)
