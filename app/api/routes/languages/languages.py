"""Routes of languages: create, list, read, change, duplicate, delete, restore."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from fastapi import APIRouter, Response
from pydantic import TypeAdapter

from app.api.http.list_responses import NOT_SENT_AGAIN, KnownTags, list_response
from app.api.http.problems import ProblemError, problem_responses
from app.api.http.revisions import ExpectedRevision
from app.api.http.schemas.languages import (
    LanguageChange,
    LanguageDraft,
    LanguageSummary,
    LanguageView,
)
from app.api.ingest.quotas import SenderQuota
from app.api.routes.asked_revisions import CurrentEdit, CurrentRevision
from app.api.services.language_documents import draft_of, name_of_copy
from app.api.services.language_responses import (
    announce,
    answer,
    save_language,
    view_summary,
)
from app.api.services.running_studio import CurrentStudio, Studio, edited
from app.recognition import Language
from app.recognition.language.file_schema import entry_to_tuning
from app.recognition.language.grammar_entry import entry_to_grammar
from app.recognition.text.look_alikes import are_confusable
from app.store import LanguageStore

router = APIRouter(prefix="/languages", tags=["languages"])


@router.post("", status_code=201, responses=problem_responses(409))
def create_language(
    draft: LanguageDraft, studio: CurrentStudio, quota: SenderQuota, response: Response
) -> LanguageView:
    """Make an empty language."""
    _require_readable(draft.name, studio)
    language = Language(name=draft.name, author=draft.author)
    made = draft_of(language, "New language")
    state = save_language(studio, quota, made, language.revision)
    return announce(studio, state, response)


@router.get(
    "", response_model=list[LanguageSummary], responses={**problem_responses(), **NOT_SENT_AGAIN}
)
def list_languages(studio: CurrentStudio, known: KnownTags) -> Response:
    """List the languages, oldest first."""
    return _listed(studio.languages, known, None)


@router.get("/{language_id}", responses=problem_responses(404))
def get_language(asked: CurrentRevision, response: Response) -> LanguageView:
    """Describe a language in its newest or an older revision."""
    return answer(asked.studio, asked.state, response)


@router.patch("/{language_id}", responses=problem_responses(404, 409, 412))
@edited
def change_language(change: LanguageChange, edit: CurrentEdit) -> LanguageView:
    """Rename a language or its author, change its phrases, or how it is recognised."""
    fields = change.model_dump(exclude={"grammar", "tuning"}, exclude_none=True)
    if "grammar" in change.model_fields_set:
        fields["grammar"] = None if change.grammar is None else entry_to_grammar(change.grammar)
    if "tuning" in change.model_fields_set:
        fields["tuning"] = entry_to_tuning(change.tuning)
    if change.name is not None:
        _require_readable(change.name, edit.studio, edit.language_id)
    if not fields:
        return answer(edit.studio, edit.studio.languages.get(edit.language_id), edit.response)
    return edit.answer(edit.save(_describe(fields), lambda language: replace(language, **fields)))


def _describe(fields: Mapping[str, Any]) -> str:
    """Describe a change of a language for its history."""
    words = {
        "name": "Rename to {}",
        "author": "Name {} as author",
        "grammar": "Change the phrases",
    }
    sentences = [words[field].format(value) for field, value in fields.items() if field in words]
    recognised = []
    if "profile" in fields:
        recognised.append(f"by the profile {fields['profile']}")
    if "tuning" in fields:
        recognised.append(fields["tuning"].words)
    if recognised:
        sentences.append(f"Recognise {', '.join(recognised)}")
    if "most_refused" in fields:
        sentences.append(f"Refuse at most {100 * fields['most_refused']:.3g} % of right takes")
    return ", ".join(sentences)


@router.post("/{language_id}/duplicate", status_code=201, responses=problem_responses(404))
@edited
def duplicate_language(
    asked: CurrentRevision, quota: SenderQuota, response: Response
) -> LanguageView:
    """Make another language of a language's newest or an older revision."""
    studio, original = asked.studio, asked.language
    taken = {each.revision.name for each in studio.languages.all()}
    name = name_of_copy(original.name, taken)
    copy = replace(original, name=name, created=None, revision=1)
    change = f"Copy of {original.name}, revision {asked.state.revision.revision}"
    return announce(studio, save_language(studio, quota, draft_of(copy, change)), response)


@router.delete("/{language_id}", status_code=204, responses=problem_responses(404, 412))
def delete_language(
    language_id: str, studio: CurrentStudio, expected: ExpectedRevision
) -> Response:
    """Delete a language. For a while it can be restored."""
    studio.languages.delete(language_id, expected)
    studio.broadcast.publish("languages", id=language_id)
    return Response(status_code=204)


@router.post("/{language_id}/restore", responses=problem_responses(404))
def restore_language(language_id: str, studio: CurrentStudio, response: Response) -> LanguageView:
    """Bring a deleted language back."""
    return announce(studio, studio.languages.restore(language_id), response)


def _require_readable(name: str, studio: Studio, language_id: str | None = None) -> None:
    """Refuse a name that looks like another language's and is not the same."""
    for state in studio.languages.all():
        known = state.revision.name
        if state.record.id != language_id and known != name and are_confusable(name, known):
            detail = f"the name {name!r} looks like that of the language {known!r}; choose another"
            raise ProblemError(409, "name_taken", detail, pointer="/name")


def _summaries(
    languages: LanguageStore, _all: None
) -> tuple[list[LanguageSummary], dict[str, str]]:
    return [view_summary(state) for state in languages.all()], {}


_listed = list_response(_summaries, TypeAdapter(list[LanguageSummary]), kept=1)
