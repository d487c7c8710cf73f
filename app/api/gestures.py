"""The gestures of a language: saved from a clip, changed, taken out, shown."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from fastapi import APIRouter, Response

from app.api.demonstrations import Demonstration, demonstration_in
from app.api.language_drafts import editing
from app.api.languages import ExpectedRevision, Revision, announced
from app.api.problems import Fault, ProblemError, documented
from app.api.schemas import GestureChange, GestureDraft, LanguageView
from app.api.studio import CurrentStudio
from app.recognition import Gesture, GestureError, Language
from app.recognition.png import encode_png

router = APIRouter(prefix="/languages/{language_id}/gestures", tags=["gestures"])

WORDS = frozenset({"label", "description", "command"})
"""What of a gesture is for people and the robot, and does not change what is recognised."""

SWITCHES = ("direction", "tempo", "mirror")


@router.post("", status_code=201, responses=documented(404, 409, 412))
def add_gesture(
    language_id: str,
    draft: GestureDraft,
    studio: CurrentStudio,
    response: Response,
    expected: ExpectedRevision,
) -> LanguageView:
    """Save a demonstration as a gesture of the language."""
    demonstration = demonstration_in(studio.recording(draft.clip_id), draft.start, draft.end)
    gesture = Gesture.from_demonstration(
        draft.label,
        demonstration.poses,
        salient=draft.salient or None,
        description=draft.description,
        command=draft.command,
    )

    def edited(language: Language) -> Language:
        _require_free(language, gesture.label)
        return language.with_gesture(gesture)

    edit = editing(f"Add {gesture.label}", edited)
    return announced(studio, studio.languages.edit(language_id, edit, expected), response)


@router.patch("/{label:path}", responses=documented(404, 409, 412))
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
        where = change.demonstration
        recording = studio.recording(where.clip_id)
        demonstration = demonstration_in(recording, where.start, where.end)
    changed = partial(_with_change, label=label, change=change, demonstration=demonstration)
    edit = editing(f"Change {label}", changed)
    return announced(studio, studio.languages.edit(language_id, edit, expected), response)


@router.delete("/{label:path}", responses=documented(404, 412))
def remove_gesture(
    language_id: str,
    label: str,
    studio: CurrentStudio,
    response: Response,
    expected: ExpectedRevision,
) -> LanguageView:
    """Take a gesture out; the revisions before still have it."""

    def edited(language: Language) -> Language:
        return language.without(_found(language, label).label)

    edit = editing(f"Remove {label}", edited)
    return announced(studio, studio.languages.edit(language_id, edit, expected), response)


@router.get(
    "/{label:path}/image",
    response_class=Response,
    responses={
        **documented(404),
        200: {"description": "The trajectory image", "content": {"image/png": {}}},
    },
)
def get_gesture_image(
    language_id: str, label: str, studio: CurrentStudio, revision: Revision = None
) -> Response:
    """Send a gesture's trajectory image."""
    language = studio.language(studio.languages.get(language_id, revision))
    image = encode_png(_found(language, label).image)
    # A revision never changes, so its pictures can be kept.
    headers = {"Cache-Control": "private, max-age=86400"} if revision is not None else {}
    return Response(image, media_type="image/png", headers=headers)


def _with_change(
    language: Language, *, label: str, change: GestureChange, demonstration: Demonstration | None
) -> Language:
    gesture = _found(language, label)
    if change.label is not None and change.label.strip() != gesture.label:
        _require_free(language, change.label.strip())
    # The command may be set to null on purpose; all else that is null was left out.
    fields = {
        name: getattr(change, name)
        for name in change.model_fields_set & WORDS
        if name == "command" or getattr(change, name) is not None
    }
    changed = _shown_anew(gesture, demonstration) if demonstration is not None else gesture
    positions = {
        name: position for name in SWITCHES if (position := getattr(change, name)) is not None
    }
    changed = replace(changed, switches=replace(changed.switches, **positions), **fields)
    if change.salient:
        changed = _with_salient(changed, change.salient)
    gestures = [changed if member is gesture else member for member in language.gestures]
    return replace(language, gestures=gestures)


def _shown_anew(gesture: Gesture, demonstration: Demonstration) -> Gesture:
    """Make a gesture from another demonstration; what it says and what counts stays."""
    made = Gesture.from_demonstration(gesture.label, demonstration.poses)
    return replace(
        made,
        description=gesture.description,
        command=gesture.command,
        switches=gesture.switches,
    )


def _with_salient(gesture: Gesture, names: list[str]) -> Gesture:
    """Draw and describe a gesture anew with other salient keypoints."""
    try:
        return gesture.with_salient(names)
    except GestureError as error:
        fault = Fault(pointer="/salient", detail=str(error))
        raise ProblemError(422, "gesture_unusable", str(error), errors=[fault]) from error


def _found(language: Language, label: str) -> Gesture:
    for gesture in language.gestures:
        if gesture.label == label:
            return gesture
    raise ProblemError(404, "not_found", f"there is no gesture {label[:80]!r} in this language")


def _require_free(language: Language, label: str) -> None:
    if label in (gesture.label for gesture in language.gestures):
        detail = f"the language has a gesture {label!r} already; choose another label"
        fault = Fault(pointer="/label", detail=detail)
        raise ProblemError(409, "label_taken", detail, errors=[fault])
