"""Routes of a gesture's demonstrations: list, add, remove, image.

A gesture is addressed by ``?label=``, because a label can be any text.
"""

from __future__ import annotations

from functools import partial
from typing import Annotated

from fastapi import APIRouter, Path, Response

from app.api.http.problems import problem_responses
from app.api.http.schemas.gestures import DemonstrationDraft, DemonstrationView
from app.api.http.schemas.languages import LanguageView
from app.api.routes.asked_revisions import CurrentEdit, CurrentRevision
from app.api.services import gesture_edits
from app.api.services.demonstration_sources import keep_source, sources_in
from app.api.services.language_responses import view_demonstrations
from app.api.services.running_studio import edited
from app.api.services.trajectory_images import IMAGE_RESPONSES, Marks, send_trajectory_image
from app.recognition.gestures.demonstration import MAX_DEMONSTRATIONS

router = APIRouter(prefix="/languages/{language_id}/demonstrations", tags=["gestures"])

Index = Annotated[
    int, Path(ge=0, lt=MAX_DEMONSTRATIONS, description="Place of the demonstration, from 0")
]


@router.get("", responses=problem_responses(404))
def list_demonstrations(label: str, asked: CurrentRevision) -> list[DemonstrationView]:
    """List the demonstrations of a gesture."""
    gesture = gesture_edits.gesture_in(asked.language, label)
    sources = sources_in(asked.studio, asked.language)[label]
    return view_demonstrations(asked.state, gesture, sources)


@router.post("", status_code=201, responses=problem_responses(404, 409, 412))
@edited
def add_demonstration(draft: DemonstrationDraft, edit: CurrentEdit) -> LanguageView:
    """Add a take to a gesture as one more demonstration, by the same diver or another."""
    demonstration = gesture_edits.demonstration_at(edit.studio, draft, edit.trigger)
    changed = partial(gesture_edits.add_demonstration_to, draft=draft, demonstration=demonstration)
    state = edit.save(f"Add a demonstration of {draft.label}", changed)
    keep_source(edit.studio, state, draft.label, draft, demonstration, index=-1)
    return edit.answer(state)


@router.delete("/{index}", responses=problem_responses(404, 409, 412))
@edited
def remove_demonstration(index: Index, label: str, edit: CurrentEdit) -> LanguageView:
    """Remove a demonstration of a gesture that has others; without the first, the next is first."""
    changed = partial(gesture_edits.remove_demonstration_from, label=label, index=index)
    return edit.answer(edit.save(f"Remove a demonstration of {label}", changed))


@router.get("/{index}/image", response_class=Response, responses=IMAGE_RESPONSES)
def get_demonstration_image(
    index: Index, label: str, asked: CurrentRevision, marks: Marks = False
) -> Response:
    """Send the trajectory image of a demonstration."""
    gesture = gesture_edits.gesture_in(asked.language, label)
    shown = gesture_edits.require_demonstration(gesture, index)
    return send_trajectory_image(shown, asked.number, marks)
