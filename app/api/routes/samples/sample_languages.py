"""Routes of the sample languages: list them, add one again."""

from __future__ import annotations

from fastapi import APIRouter, Response

from app.api.http.problems import ProblemError, problem_responses
from app.api.http.schemas.languages import LanguageView
from app.api.http.schemas.samples import SampleChoice, SampleLanguageView
from app.api.ingest.quotas import SenderQuota
from app.api.services.language_documents import draft_of
from app.api.services.language_responses import announce, save_language
from app.api.services.running_studio import CurrentStudio
from app.api.services.sample_library import SEEDED

router = APIRouter(prefix="/samples/languages", tags=["samples"])


@router.get("", responses=problem_responses())
def list_sample_languages(studio: CurrentStudio) -> list[SampleLanguageView]:
    """List the sample languages, whether or not they are among the languages."""
    return [
        SampleLanguageView(name=name, title=language.name, labels=list(language.labels))
        for name, language in studio.samples.languages().items()
    ]


@router.post("", status_code=201, responses=problem_responses(404))
def add_sample_language(
    chosen: SampleChoice, studio: CurrentStudio, quota: SenderQuota, response: Response
) -> LanguageView:
    """Add a sample language to the languages, as it was brought at the first start."""
    language = studio.samples.languages().get(chosen.name)
    if language is None:
        raise ProblemError(404, "not_found", f"there is no sample language {chosen.name!r}")
    draft = draft_of(language, SEEDED)
    state = save_language(studio, quota, draft, language.revision, sample=chosen.name)
    return announce(studio, state, response)
