"""Routes of the sample clips and languages that come with the program."""

from __future__ import annotations

import shutil
from typing import Annotated

from fastapi import APIRouter, Request, Response
from pydantic import Field
from starlette.concurrency import run_in_threadpool

from app.api.http.problems import ProblemError, problem_responses
from app.api.http.schemas.clips import ClipAccepted
from app.api.http.schemas.languages import LanguageView
from app.api.http.schemas.values import Body, View
from app.api.ingest.intake import SenderQuota, inspect, require_place_in_queue, require_quota, store
from app.api.ingest.multipart import display_name
from app.api.services.language_documents import draft_of
from app.api.services.language_responses import add_language
from app.api.services.running_studio import CurrentStudio, SampleLibrary
from app.api.services.sample_library import SEEDED


class SampleView(View):
    """A clip that comes with the program."""

    name: str
    size: int
    """Bytes."""


class SampleLanguageView(View):
    """A language that comes with the program."""

    name: str
    """By which it is asked for."""
    title: str
    """The language's own name."""
    labels: list[str]


class SampleChoice(Body):
    """Which sample to add."""

    name: Annotated[str, Field(min_length=1, max_length=200)]


router = APIRouter(prefix="/samples", tags=["samples"])


@router.get("", responses=problem_responses())
def list_samples(samples: SampleLibrary) -> list[SampleView]:
    """List the sample clips."""
    clips = samples.clips()
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
    await require_quota(quota, studio.quotas, size)
    with studio.clips.receiving() as partial:
        await run_in_threadpool(shutil.copyfile, sample, partial)
        made = await inspect(partial, studio.workers, name=display_name(sample.name))
        return await store(made, partial, studio, request)


@router.get("/languages", responses=problem_responses())
def list_sample_languages(samples: SampleLibrary) -> list[SampleLanguageView]:
    """List the sample languages, whether or not they are among the languages."""
    return [
        SampleLanguageView(name=name, title=language.name, labels=list(language.labels))
        for name, language in samples.languages().items()
    ]


@router.post("/languages", status_code=201, responses=problem_responses(404))
def add_sample_language(
    chosen: SampleChoice, studio: CurrentStudio, quota: SenderQuota, response: Response
) -> LanguageView:
    """Add a sample language to the languages, as it was brought at the first start."""
    language = studio.samples.languages().get(chosen.name)
    if language is None:
        raise ProblemError(404, "not_found", f"there is no sample language {chosen.name!r}")
    draft = draft_of(language, SEEDED)
    return add_language(studio, quota, draft, language.revision, response, chosen.name)
