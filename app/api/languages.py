"""Languages: make, list, change, go back, import and export."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from enum import StrEnum
from typing import Annotated
from urllib.parse import quote

from fastapi import APIRouter, Depends, Header, Query, Request, Response
from starlette.concurrency import run_in_threadpool

from app.api.language_drafts import draft_of, editing
from app.api.problems import ProblemError, documented
from app.api.schemas import (
    GestureView,
    LanguageChange,
    LanguageDraft,
    LanguageRevert,
    LanguageSummary,
    LanguageView,
    Name,
    RevisionView,
)
from app.api.studio import CurrentStudio, Studio
from app.recognition import Language
from app.recognition.gesture import Gesture
from app.recognition.osg_reference import from_reference, is_reference, to_reference
from app.store import LanguageRevision, LanguageState

_REVISION_TAG = re.compile(r'(?:W/)?"(\d{1,9})"', re.ASCII)


class FileFormat(StrEnum):
    """The language files."""

    OSG_STUDIO = "osg-studio"
    """Ours: everything."""
    OSG_REFERENCE = "osg-reference"
    """The published implementation's: images and salient keypoints only."""


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


@router.get("", responses=documented())
def list_languages(studio: CurrentStudio) -> list[LanguageSummary]:
    """List the languages, oldest first."""
    return [_summary(state) for state in studio.languages.all()]


@router.post(
    "/import",
    status_code=201,
    responses=documented(),
    openapi_extra={
        "requestBody": {
            "required": True,
            "content": {"application/json": {"schema": {"type": "object"}}},
        }
    },
)
async def import_language(
    request: Request,
    studio: CurrentStudio,
    response: Response,
    name: Annotated[Name, Query()] = "imported",
) -> LanguageView:
    """Add the language of a file: ours, or the published implementation's (then under `name`)."""
    content = await request.body()
    return await run_in_threadpool(_imported, studio, content, name, response)


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
    """Rename a language or its author."""
    fields = change.model_dump(exclude_none=True)
    if not fields:
        return answered(studio, studio.languages.get(language_id), response)
    edit = editing(f"Change {' and '.join(fields)}", lambda language: replace(language, **fields))
    return announced(studio, studio.languages.edit(language_id, edit, expected), response)


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


@router.get("/{language_id}/revisions", responses=documented(404))
def list_revisions(language_id: str, studio: CurrentStudio) -> list[RevisionView]:
    """List what was done to a language, newest first."""
    return [_revision_view(row) for row in studio.languages.revisions(language_id)]


@router.post("/{language_id}/revert", responses=documented(404, 412))
def revert_language(
    language_id: str,
    to: LanguageRevert,
    studio: CurrentStudio,
    response: Response,
    expected: ExpectedRevision,
) -> LanguageView:
    """Make a new revision that says what an older one said."""
    older = studio.language(studio.languages.get(language_id, to.revision))
    edit = editing(f"Go back to revision {to.revision}", lambda _newest: older)
    return announced(studio, studio.languages.edit(language_id, edit, expected), response)


@router.get(
    "/{language_id}/export",
    response_class=Response,
    responses={
        **documented(404),
        200: {"description": "The language file", "content": {"application/json": {}}},
    },
)
def export_language(
    language_id: str,
    studio: CurrentStudio,
    format: FileFormat = FileFormat.OSG_STUDIO,
    revision: Revision = None,
) -> Response:
    """Send the language as the file that robots load."""
    state = studio.languages.get(language_id, revision)
    document = state.revision.document
    if format is FileFormat.OSG_REFERENCE:
        document = to_reference(studio.language(state))
    name = quote(f"{state.revision.name}.json", safe="")
    headers = {
        "Content-Disposition": f"attachment; filename=\"language.json\"; filename*=utf-8''{name}",
        "ETag": _tag(state),
    }
    return Response(document, media_type="application/json", headers=headers)


def announced(studio: Studio, state: LanguageState, response: Response) -> LanguageView:
    """Tell the open pages that a language changed, and answer with it."""
    studio.broadcast.publish("languages", id=state.record.id)
    return answered(studio, state, response)


def answered(studio: Studio, state: LanguageState, response: Response) -> LanguageView:
    """Answer with a language, its ETag in the head."""
    response.headers["ETag"] = _tag(state)
    language = studio.language(state)
    return LanguageView(
        **_summary(state).model_dump(),
        author=language.author,
        gestures=[_gesture_view(state, gesture) for gesture in language.gestures],
    )


def _imported(studio: Studio, content: bytes, name: str, response: Response) -> LanguageView:
    if is_reference(content):
        language, change = from_reference(content, name), "Import of an osg-reference file"
    else:
        language, change = Language.from_json(content), "Import"
    state = studio.languages.create(draft_of(language, change), language.revision)
    return announced(studio, state, response)


def _tag(state: LanguageState) -> str:
    return f'"{state.revision.revision}"'


def _summary(state: LanguageState) -> LanguageSummary:
    record, row = state.record, state.revision
    return LanguageSummary(
        id=record.id,
        name=row.name,
        revision=row.revision,
        labels=json.loads(row.labels),
        sample=record.sample,
        created=record.created,
        updated=row.created,
    )


def _revision_view(row: LanguageRevision) -> RevisionView:
    return RevisionView(
        **row.model_dump(include={"revision", "name", "change", "created"}),
        labels=json.loads(row.labels),
    )


def _gesture_view(state: LanguageState, gesture: Gesture) -> GestureView:
    # The revision in the address lets browsers keep the picture until the gesture changes.
    place = f"/api/v1/languages/{state.record.id}/gestures/{quote(gesture.label, safe='')}/image"
    return GestureView(
        label=gesture.label,
        description=gesture.description,
        command=gesture.command,
        salient=list(gesture.salient),
        thumbnail=f"{place}?revision={state.revision.revision}",
        has_trajectory=gesture.trajectory is not None,
    )
