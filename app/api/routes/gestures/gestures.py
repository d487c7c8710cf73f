"""Routes of a language's gestures and of their demonstrations: add, change, remove, draw.

A gesture is addressed by ``?label=``, because browsers resolve ``.`` and ``..`` in a path before
they send it. The label as the last part of the path works too, for every other label.
"""

from __future__ import annotations

from functools import partial
from typing import Annotated

import numpy as np
from fastapi import APIRouter, Path, Response

from app.api.http.problems import ProblemError, problem_responses
from app.api.http.schemas.clips import PosesView
from app.api.http.schemas.gestures import (
    DemonstrationDraft,
    DemonstrationView,
    GestureChange,
    GestureDraft,
    GesturesDraft,
)
from app.api.http.schemas.languages import LanguageView
from app.api.routes.asked_revisions import CurrentEdit, CurrentRevision
from app.api.services import gesture_edits
from app.api.services.language_responses import view_demonstrations
from app.api.services.limited_routes import computed_briefly, edited
from app.api.services.running_studio import KnownDemonstrations
from app.api.services.trajectory_images import IMAGE_RESPONSES, Marks, send_trajectory_image
from app.recognition import Language, LanguageError
from app.recognition.gestures.demonstration import MAX_DEMONSTRATIONS
from app.recognition.poses.trajectory import Trajectory

Index = Annotated[
    int, Path(ge=0, lt=MAX_DEMONSTRATIONS, description="Place of the demonstration, from 0")
]


router = APIRouter(prefix="/languages/{language_id}", tags=["gestures"])

TORSO_PIXELS = 160
"""Height in pixels of the torso in a demonstration drawn without its clip: the picture of a diver
from the head to the knees is then about 640 pixels high, as a clip's picture."""

BORDER = 40
"""Pixels around the drawing: room for the half of the head beyond its middle, which is followed."""


@router.post("/gestures", status_code=201, responses=problem_responses(404, 409, 412))
@edited
def add_gesture(draft: GestureDraft, edit: CurrentEdit) -> LanguageView:
    """Save a demonstration as a new gesture of the language."""
    demonstration = gesture_edits.demonstration_at(edit.studio.clips, draft, edit.trigger)
    gesture = gesture_edits.gesture_from(draft, demonstration)

    def edit_language(language: Language) -> Language:
        gesture_edits.require_free(language.labels, gesture.label)
        return language.with_gesture(gesture)

    state = edit.save(f"Add {gesture.label}", edit_language)
    edit.studio.demonstrations.keep(state, gesture.label, draft, demonstration)
    return edit.answer(state)


@router.post("/gestures/batch", status_code=201, responses=problem_responses(404, 409, 412))
@edited
def add_gestures(draft: GesturesDraft, edit: CurrentEdit) -> LanguageView:
    """Save several demonstrations as new gestures in one revision: all of them, or none."""
    made = gesture_edits.gestures_from(edit.studio.clips, draft.gestures, edit.trigger)
    gestures = [gesture for gesture, _ in made]
    title = f"Add {', '.join(gesture.label for gesture in gestures)}"
    state = edit.save(title, partial(gesture_edits.add_gestures_to, gestures=gestures))
    for where, (gesture, demonstration) in zip(draft.gestures, made, strict=True):
        edit.studio.demonstrations.keep(state, gesture.label, where, demonstration)
    return edit.answer(state)


@router.patch("/gestures", responses=problem_responses(404, 409, 412))
@router.patch("/gestures/{label:path}", responses=problem_responses(404, 409, 412))
@edited
def change_gesture(label: str, change: GestureChange, edit: CurrentEdit) -> LanguageView:
    """Change what a gesture says, what of it counts, or the demonstration that shows it."""
    where, demonstration = change.demonstration, None
    if where is not None:
        demonstration = gesture_edits.demonstration_at(edit.studio.clips, where, edit.trigger)
    changed = partial(
        gesture_edits.change_gesture_of, label=label, change=change, demonstration=demonstration
    )
    state = edit.save(f"Change {label}", changed)
    if where is not None and demonstration is not None:
        now = label if change.label is None else change.label.strip()
        index = -1 if change.further else 0
        edit.studio.demonstrations.keep(state, now, where, demonstration, index=index)
    return edit.answer(state)


@router.delete("/gestures", responses=problem_responses(404, 409, 412))
@router.delete("/gestures/{label:path}", responses=problem_responses(404, 409, 412))
@edited
def remove_gesture(label: str, edit: CurrentEdit) -> LanguageView:
    """Take a gesture out that no phrase needs; the revisions before still have it."""

    def edit_language(language: Language) -> Language:
        gesture_edits.gesture_in(language, label)
        try:
            return language.without(label)
        except LanguageError as error:
            raise ProblemError(409, "gesture_needed", str(error)) from error

    return edit.answer(edit.save(f"Remove {label}", edit_language))


@router.get("/gestures/image", response_class=Response, responses=IMAGE_RESPONSES)
@router.get("/gestures/{label:path}/image", response_class=Response, responses=IMAGE_RESPONSES)
def get_gesture_image(label: str, asked: CurrentRevision, marks: Marks = False) -> Response:
    """Send a gesture's trajectory image."""
    gesture = gesture_edits.gesture_in(asked.language, label)
    return send_trajectory_image(gesture, asked.number, marks)


@router.get("/gestures/demonstration", responses=problem_responses(404))
@router.get("/gestures/{label:path}/demonstration", responses=problem_responses(404))
@computed_briefly
def get_demonstration(label: str, asked: CurrentRevision) -> PosesView:
    """Return a gesture's demonstration as the language keeps it, laid out for drawing."""
    trajectory = gesture_edits.gesture_in(asked.language, label).trajectory
    if trajectory is None:
        detail = f"{label[:80]!r} was imported without its demonstration: only its image is known"
        raise ProblemError(404, "no_demonstration", detail)
    return _lay_out(trajectory)


def _lay_out(trajectory: Trajectory) -> PosesView:
    """Scale a trajectory to fill a picture, x right, y down."""
    known = trajectory.xy[np.isfinite(trajectory.xy).all(axis=2)]
    low, high = known.min(axis=0), known.max(axis=0)
    # Without a torso the unit is the largest extent, which is drawn as high as two torsos.
    scale = TORSO_PIXELS * (1 if trajectory.unit == "torso_length" else 2)
    xy = (trajectory.xy - low) * scale + BORDER
    size = np.ceil((high - low) * scale) + 2 * BORDER
    return PosesView(
        landmarks=list(trajectory.landmarks),
        time=trajectory.time.tolist(),
        xy=[
            [[*point] if np.isfinite(point).all() else [None, None] for point in row] for row in xy
        ],
        confidence=None,
        frame_size=[int(size[0]), int(size[1])],
    )


@router.get("/demonstrations", responses=problem_responses(404))
def list_demonstrations(
    label: str, asked: CurrentRevision, demonstrations: KnownDemonstrations
) -> list[DemonstrationView]:
    """List the demonstrations of a gesture."""
    gesture = gesture_edits.gesture_in(asked.language, label)
    sources = demonstrations.view(asked.language)[label]
    return view_demonstrations(asked.state, gesture, sources)


@router.post("/demonstrations", status_code=201, responses=problem_responses(404, 409, 412))
@edited
def add_demonstration(draft: DemonstrationDraft, edit: CurrentEdit) -> LanguageView:
    """Add a take to a gesture as one more demonstration, by the same diver or another."""
    demonstration = gesture_edits.demonstration_at(edit.studio.clips, draft, edit.trigger)
    changed = partial(gesture_edits.add_demonstration_to, draft=draft, demonstration=demonstration)
    state = edit.save(f"Add a demonstration of {draft.label}", changed)
    edit.studio.demonstrations.keep(state, draft.label, draft, demonstration, index=-1)
    return edit.answer(state)


@router.delete("/demonstrations/{index}", responses=problem_responses(404, 409, 412))
@edited
def remove_demonstration(index: Index, label: str, edit: CurrentEdit) -> LanguageView:
    """Remove a demonstration of a gesture that has others; without the first, the next is first."""
    changed = partial(gesture_edits.remove_demonstration_from, label=label, index=index)
    return edit.answer(edit.save(f"Remove a demonstration of {label}", changed))


@router.get("/demonstrations/{index}/image", response_class=Response, responses=IMAGE_RESPONSES)
def get_demonstration_image(
    index: Index, label: str, asked: CurrentRevision, marks: Marks = False
) -> Response:
    """Send the trajectory image of a demonstration."""
    gesture = gesture_edits.gesture_in(asked.language, label)
    shown = gesture_edits.require_demonstration(gesture, index)
    return send_trajectory_image(shown, asked.number, marks)
