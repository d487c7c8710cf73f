"""Languages: make, list, duplicate, change, delete and restore."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, Any
from urllib.parse import quote

from fastapi import APIRouter, Depends, Header, Query, Response
from pydantic import TypeAdapter

from app.api.http.list_responses import NOT_SENT_AGAIN, KnownTags, listing
from app.api.http.problems import ProblemError, documented
from app.api.http.schemas import (
    GestureView,
    LanguageChange,
    LanguageDraft,
    LanguageSummary,
    LanguageView,
    SourceView,
)
from app.api.services.context import CurrentStudio, Studio
from app.api.services.demonstration_sources import sources_in
from app.api.services.language_documents import draft_of, editing, name_of_copy
from app.recognition import Language
from app.recognition.gestures.gesture import Gesture
from app.recognition.language.grammar_entry import entry_to_grammar, grammar_to_entry
from app.recognition.language.tuning_entry import entry_to_tuning, tuning_to_entry
from app.store import LanguageState, LanguageStore

_REVISION_TAG = re.compile(r'(?:W/)?"(\d{1,9})"', re.ASCII)


def _expected_revision(
    if_match: Annotated[
        str | None, Header(description="The ETag of the revision that the change was made from")
    ] = None,
) -> int | None:
    if if_match is None or if_match.strip() == "*":
        return None
    if match := _REVISION_TAG.fullmatch(if_match.strip()):
        return int(match[1])
    detail = f"If-Match {if_match[:80]!r} names no revision; send the ETag of the language"
    raise ProblemError(412, "revision_conflict", detail)


ExpectedRevision = Annotated[int | None, Depends(_expected_revision)]
"""The revision that the caller changes, from ``If-Match``; None accepts the newest one."""

Revision = Annotated[int | None, Query(ge=0, le=2**31 - 1)]

router = APIRouter(prefix="/languages", tags=["languages"])


@router.post("", status_code=201, responses=documented())
def create_language(
    draft: LanguageDraft, studio: CurrentStudio, response: Response
) -> LanguageView:
    """Make an empty language."""
    language = Language(name=draft.name, author=draft.author)
    state = studio.languages.create(draft_of(language, "New language"), language.revision)
    return announced(studio, state, response)


@router.get("", response_model=list[LanguageSummary], responses={**documented(), **NOT_SENT_AGAIN})
def list_languages(studio: CurrentStudio, known: KnownTags) -> Response:
    """List the languages, oldest first."""
    return _listed(studio.languages, known)


@router.get("/{language_id}", responses=documented(404))
def get_language(
    language_id: str, studio: CurrentStudio, response: Response, revision: Revision = None
) -> LanguageView:
    """Describe a language in its newest or an older revision."""
    return answered(studio, studio.languages.get(language_id, revision), response)


@router.patch("/{language_id}", responses=documented(404, 412))
def change_language(
    language_id: str,
    change: LanguageChange,
    studio: CurrentStudio,
    response: Response,
    expected: ExpectedRevision,
) -> LanguageView:
    """Rename a language or its author, change its phrases, or how it is recognised."""
    fields = change.model_dump(exclude={"grammar", "tuning"}, exclude_none=True)
    if "grammar" in change.model_fields_set:
        fields["grammar"] = None if change.grammar is None else entry_to_grammar(change.grammar)
    if "tuning" in change.model_fields_set:
        fields["tuning"] = entry_to_tuning(change.tuning)
    if not fields:
        return answered(studio, studio.languages.get(language_id), response)
    edit = editing(_change_words(fields), lambda language: replace(language, **fields))
    return announced(studio, studio.languages.edit(language_id, edit, expected), response)


def _change_words(fields: Mapping[str, Any]) -> str:
    """Say for the history what changes about a language."""
    words = {
        "name": "Rename to {}",
        "author": "Name {} as author",
        "grammar": "Change the phrases",
    }
    told = [words[field].format(value) for field, value in fields.items() if field in words]
    recognised = []
    if "profile" in fields:
        recognised.append(f"by the profile {fields['profile']}")
    if "tuning" in fields:
        recognised.append(fields["tuning"].words)
    if recognised:
        told.append(f"Recognise {', '.join(recognised)}")
    return ", ".join(told)


@router.post("/{language_id}/duplicate", status_code=201, responses=documented(404))
def duplicate_language(
    language_id: str, studio: CurrentStudio, response: Response, revision: Revision = None
) -> LanguageView:
    """Make another language of a language's newest or an older revision."""
    state = studio.languages.get(language_id, revision)
    taken = {each.revision.name for each in studio.languages.all()}
    original = studio.language(state)
    name = name_of_copy(original.name, taken)
    copy = replace(original, name=name, created=None, revision=1)
    change = f"Copy of {original.name}, revision {state.revision.revision}"
    return announced(studio, studio.languages.create(draft_of(copy, change)), response)


@router.delete("/{language_id}", status_code=204, responses=documented(404, 412))
def delete_language(
    language_id: str, studio: CurrentStudio, expected: ExpectedRevision
) -> Response:
    """Delete a language. For a while it can be restored."""
    studio.languages.delete(language_id, expected)
    studio.broadcast.publish("languages", id=language_id)
    return Response(status_code=204)


@router.post("/{language_id}/restore", responses=documented(404))
def restore_language(language_id: str, studio: CurrentStudio, response: Response) -> LanguageView:
    """Bring a deleted language back."""
    return announced(studio, studio.languages.restore(language_id), response)


def announced(studio: Studio, state: LanguageState, response: Response) -> LanguageView:
    """Tell the open pages that a language changed, and answer with it."""
    studio.broadcast.publish("languages", id=state.record.id)
    return answered(studio, state, response)


def answered(studio: Studio, state: LanguageState, response: Response) -> LanguageView:
    """Answer with a language, its ETag in the head."""
    response.headers["ETag"] = tag_of(state)
    language = studio.language(state)
    sources = sources_in(studio, language)
    return LanguageView(
        **_summary_of(state).model_dump(),
        gestures=[
            gesture_view(state, gesture, sources.get(gesture.label))
            for gesture in language.gestures
        ],
        grammar=None if language.grammar is None else grammar_to_entry(language.grammar),
        profile=language.profile,
        tuning=tuning_to_entry(language.tuning),
        tuning_words=language.tuning.words,
    )


def tag_of(state: LanguageState) -> str:
    """Return the ETag of a revision."""
    return f'"{state.revision.revision}"'


def _summaries(languages: LanguageStore) -> list[LanguageSummary]:
    return [_summary_of(state) for state in languages.all()]


_listed = listing(_summaries, TypeAdapter(list[LanguageSummary]))


def _summary_of(state: LanguageState) -> LanguageSummary:
    record, row = state.record, state.revision
    return LanguageSummary(
        id=record.id,
        name=row.name,
        revision=row.revision,
        author=row.author,
        change=row.change,
        labels=json.loads(row.labels),
        sample=record.sample,
        created=record.created,
        updated=row.created,
    )


def gesture_view(
    state: LanguageState, gesture: Gesture, source: SourceView | None = None
) -> GestureView:
    """Return what to tell about a gesture of a revision, and of its demonstration's source."""
    # The revision in the address lets browsers keep the picture until the gesture changes.
    place = f"/api/v1/languages/{state.record.id}/gestures/{quote(gesture.label, safe='')}/image"
    switches = gesture.switches
    return GestureView(
        direction=switches.direction,
        tempo=switches.tempo,
        mirror=switches.mirror,
        label=gesture.label,
        description=gesture.description,
        command=gesture.command,
        salient=list(gesture.salient),
        thumbnail=f"{place}?revision={state.revision.revision}",
        has_trajectory=gesture.trajectory is not None,
        source=source,
    )
