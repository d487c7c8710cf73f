"""Routes of a language's gestures: add, change, remove, image.

A gesture is addressed by ``?label=``, because browsers resolve ``.`` and ``..`` in a path before
they send it. The label as the last part of the path works too, for every other label.
"""

from __future__ import annotations

from functools import partial
from typing import Annotated

from fastapi import APIRouter, Query, Response

from app.api.http.problems import ProblemError, problem_responses
from app.api.http.revisions import ExpectedRevision, Revision
from app.api.http.schemas.gestures import GestureChange, GestureDraft, GesturesDraft
from app.api.http.schemas.languages import LanguageView
from app.api.services.demonstration_sources import keep_source
from app.api.services.gesture_edits import (
    add_gestures_to,
    change_gesture_of,
    demonstration_at,
    gesture_from,
    gesture_in,
    gestures_from,
    require_free,
)
from app.api.services.language_documents import edit_document
from app.api.services.language_views import announce
from app.api.services.studio import CurrentStudio
from app.recognition import Language, LanguageError
from app.recognition.features.png import encode_png
from app.ui.charts import png
from app.ui.direction_marks import mark_gesture

router = APIRouter(prefix="/languages/{language_id}/gestures", tags=["gestures"])

_IMAGE = {
    **problem_responses(404),
    200: {"description": "The trajectory image", "content": {"image/png": {}}},
}


@router.post("", status_code=201, responses=problem_responses(404, 409, 412))
def add_gesture(
    language_id: str,
    draft: GestureDraft,
    studio: CurrentStudio,
    response: Response,
    expected: ExpectedRevision,
) -> LanguageView:
    """Save a demonstration as a new gesture of the language."""
    demonstration = demonstration_at(studio, draft)
    gesture = gesture_from(draft, demonstration)

    def edit_language(language: Language) -> Language:
        require_free(language, gesture.label)
        return language.with_gesture(gesture)

    edit = edit_document(f"Add {gesture.label}", edit_language)
    state = studio.languages.edit(language_id, edit, expected)
    keep_source(studio, state, gesture.label, draft, demonstration)
    return announce(studio, state, response)


@router.post("/batch", status_code=201, responses=problem_responses(404, 409, 412))
def add_gestures(
    language_id: str,
    draft: GesturesDraft,
    studio: CurrentStudio,
    response: Response,
    expected: ExpectedRevision,
) -> LanguageView:
    """Save several demonstrations as new gestures in one revision: all of them, or none."""
    made = gestures_from(studio, draft.gestures)
    gestures = [gesture for gesture, _ in made]
    title = f"Add {', '.join(gesture.label for gesture in gestures)}"
    edit = edit_document(title, partial(add_gestures_to, gestures=gestures))
    state = studio.languages.edit(language_id, edit, expected)
    for where, (gesture, demonstration) in zip(draft.gestures, made, strict=True):
        keep_source(studio, state, gesture.label, where, demonstration)
    return announce(studio, state, response)


@router.patch("", responses=problem_responses(404, 409, 412))
@router.patch("/{label:path}", responses=problem_responses(404, 409, 412))
def change_gesture(
    language_id: str,
    label: str,
    change: GestureChange,
    studio: CurrentStudio,
    response: Response,
    expected: ExpectedRevision,
) -> LanguageView:
    """Change what a gesture says, what of it counts, or the demonstration that shows it."""
    demonstration = None
    if change.demonstration is not None:
        demonstration = demonstration_at(studio, change.demonstration)
    changed = partial(change_gesture_of, label=label, change=change, demonstration=demonstration)
    edit = edit_document(f"Change {label}", changed)
    state = studio.languages.edit(language_id, edit, expected)
    if change.demonstration is not None and demonstration is not None:
        now = label if change.label is None else change.label.strip()
        index = -1 if change.further else 0
        keep_source(studio, state, now, change.demonstration, demonstration, index=index)
    return announce(studio, state, response)


@router.delete("", responses=problem_responses(404, 409, 412))
@router.delete("/{label:path}", responses=problem_responses(404, 409, 412))
def remove_gesture(
    language_id: str,
    label: str,
    studio: CurrentStudio,
    response: Response,
    expected: ExpectedRevision,
) -> LanguageView:
    """Take a gesture out that no phrase needs; the revisions before still have it."""

    def edit_language(language: Language) -> Language:
        gesture_in(language, label)
        try:
            return language.without(label)
        except LanguageError as error:
            raise ProblemError(409, "gesture_needed", str(error)) from error

    edit = edit_document(f"Remove {label}", edit_language)
    return announce(studio, studio.languages.edit(language_id, edit, expected), response)


@router.get("/image", response_class=Response, responses=_IMAGE)
@router.get("/{label:path}/image", response_class=Response, responses=_IMAGE)
def get_gesture_image(
    language_id: str,
    label: str,
    studio: CurrentStudio,
    revision: Revision = None,
    marks: Annotated[bool, Query(description="With start dot and arrow, for people")] = False,
) -> Response:
    """Send a gesture's trajectory image."""
    language = studio.language(studio.languages.get(language_id, revision))
    gesture = gesture_in(language, label)
    image = png(mark_gesture(gesture)) if marks else encode_png(gesture.image)
    # A revision never changes, so its pictures can be kept.
    headers = {"Cache-Control": "private, max-age=86400"} if revision is not None else {}
    return Response(image, media_type="image/png", headers=headers)
