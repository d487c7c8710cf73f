"""Routes of a language's revisions: list, revert, diff."""

from __future__ import annotations

from fastapi import APIRouter

from app.api.http.problems import problem_responses
from app.api.http.revisions import Revision
from app.api.http.schemas import languages as schemas
from app.api.http.schemas.gestures import GestureView
from app.api.routes.asked_revisions import CurrentEdit
from app.api.services.language_diff import compare_gestures, describe_changes
from app.api.services.language_responses import view_gesture
from app.api.services.limited_routes import computed_briefly, edited
from app.api.services.running_studio import Languages
from app.api.services.stored_languages import language_of
from app.recognition.gestures.gesture import Gesture
from app.store import LanguageRevision, LanguageState

router = APIRouter(prefix="/languages/{language_id}", tags=["revisions"])


@router.get("/revisions", responses=problem_responses(404))
def list_revisions(language_id: str, languages: Languages) -> list[schemas.RevisionView]:
    """List what was done to a language, newest first."""
    return [_revision_view(row) for row in languages.revisions(language_id)]


@router.post("/revert", responses=problem_responses(404, 412))
@edited
def revert_language(to: schemas.LanguageRevert, edit: CurrentEdit) -> schemas.LanguageView:
    """Make a new revision with the content of an older one."""
    older = language_of(edit.studio.languages.get(edit.language_id, to.revision))
    return edit.answer(edit.save(f"Go back to revision {to.revision}", lambda _newest: older))


@router.get("/comparison", responses=problem_responses(404))
@computed_briefly
def compare_revisions(
    language_id: str, languages: Languages, older: Revision = None, newer: Revision = None
) -> schemas.RevisionComparison:
    """Diff two revisions; without `older`, against an empty language."""
    after = languages.get(language_id, newer)
    before = None if older is None else languages.get(language_id, older)
    new = language_of(after)
    old = None if before is None else language_of(before)
    return schemas.RevisionComparison(
        older=None if before is None else _revision_view(before.revision),
        newer=_revision_view(after.revision),
        words=[] if old is None else describe_changes(old, new),
        gestures=[
            schemas.GestureComparison(
                kind=change.kind,
                before=_view(before, change.before),
                after=_view(after, change.after),
                words=list(change.words),
            )
            for change in compare_gestures(old, new)
        ],
    )


def _view(state: LanguageState | None, gesture: Gesture | None) -> GestureView | None:
    return None if state is None or gesture is None else view_gesture(state, gesture)


def _revision_view(row: LanguageRevision) -> schemas.RevisionView:
    return schemas.RevisionView(
        **row.model_dump(include={"revision", "name", "author", "change", "created"}),
        labels=row.labels,
    )
