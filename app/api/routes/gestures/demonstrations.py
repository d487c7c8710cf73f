"""Routes of a gesture's demonstrations: list, add, remove, image.

A gesture is addressed by ``?label=``, because a label can be any text.
"""

from __future__ import annotations

from functools import partial
from typing import Annotated

from fastapi import APIRouter, Path, Response

from app.api.http.problems import problem_responses
from app.api.http.revisions import Revision
from app.api.http.schemas.gestures import DemonstrationDraft, DemonstrationView
from app.api.http.schemas.languages import LanguageView
from app.api.routes.language_edits import CurrentEdit
from app.api.services import gesture_edits
from app.api.services.demonstration_sources import keep_source, sources_in
from app.api.services.language_responses import view_demonstrations
from app.api.services.running_studio import CurrentStudio, edited
from app.api.services.trajectory_images import IMAGE_RESPONSES, Marks, send_trajectory_image
from app.recognition.gestures.demonstration import MAX_DEMONSTRATIONS

router = APIRouter(prefix="/languages/{language_id}/demonstrations", tags=["gestures"])

Index = Annotated[
    int, Path(ge=0, lt=MAX_DEMONSTRATIONS, description="Place of the demonstration, from 0")
]


@router.get("", responses=problem_responses(404))
def list_demonstrations(
    language_id: str, label: str, studio: CurrentStudio, revision: Revision = None
) -> list[DemonstrationView]:
    """List the demonstrations of a gesture."""
    state = studio.languages.get(language_id, revision)
    language = studio.language(state)
    gesture = gesture_edits.gesture_in(language, label)
    return view_demonstrations(state, gesture, sources_in(studio, language)[label])


@router.post("", status_code=201, responses=problem_responses(404, 409, 412))
@edited
def add_demonstration(
    draft: DemonstrationDraft, studio: CurrentStudio, edit: CurrentEdit
) -> LanguageView:
    """Add a take to a gesture as one more demonstration, by the same diver or another."""
    demonstration = gesture_edits.demonstration_at(studio, draft, edit.trigger)
    changed = partial(gesture_edits.add_demonstration_to, draft=draft, demonstration=demonstration)
    state = edit.save(f"Add a demonstration of {draft.label}", changed)
    keep_source(studio, state, draft.label, draft, demonstration, index=-1)
    return edit.answer(state)


@router.delete("/{index}", responses=problem_responses(404, 409, 412))
@edited
def remove_demonstration(
    index: Index, label: str, studio: CurrentStudio, edit: CurrentEdit
) -> LanguageView:
    """Remove a demonstration of a gesture that has others; without the first, the next is first."""
    changed = partial(gesture_edits.remove_demonstration_from, label=label, index=index)
    return edit.answer(edit.save(f"Remove a demonstration of {label}", changed))


@router.get("/{index}/image", response_class=Response, responses=IMAGE_RESPONSES)
def get_demonstration_image(
    language_id: str,
    index: Index,
    label: str,
    studio: CurrentStudio,
    revision: Revision = None,
    marks: Marks = False,
) -> Response:
    """Send the trajectory image of a demonstration."""
    language = studio.language(studio.languages.get(language_id, revision))
    shown = gesture_edits.require_demonstration(gesture_edits.gesture_in(language, label), index)
    return send_trajectory_image(shown, revision, marks)
