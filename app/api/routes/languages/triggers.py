"""Route of a language's trigger: a salute, arm poses from clips, a gesture, or none."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from fastapi import APIRouter
from pydantic import Field

from app.api.http.problems import ProblemError, problem_responses
from app.api.http.schemas.languages import LanguageView
from app.api.http.schemas.values import Body, Identifier, Seconds
from app.api.routes.asked_revisions import CurrentEdit
from app.api.services.running_studio import Studio, edited
from app.recognition import Language
from app.recognition.errors import TriggerError
from app.recognition.gestures.gesture import MAX_LABEL_LENGTH
from app.recognition.triggers.trigger import ArmPose, Trigger, TriggerKind


class HeldPose(Body):
    """Where a pose of the arms is held."""

    clip_id: Identifier
    start: Seconds | None = None
    """Null: of the clip."""
    end: Seconds | None = None
    """Null: of the clip."""


class TriggerDraft(Body):
    """What shall begin and end the takes of a language."""

    kind: TriggerKind
    start: HeldPose | None = None
    """Of kind pose, the one that begins a take; null: the one that does already."""
    stop: HeldPose | None = None
    """The pose that ends a take; null: the one that begins it."""
    start_label: Annotated[str, Field(max_length=MAX_LABEL_LENGTH)] = ""
    """Of kind gesture, which one begins."""
    stop_label: Annotated[str, Field(max_length=MAX_LABEL_LENGTH)] = ""
    """Which one ends; empty: the same."""


router = APIRouter(prefix="/languages", tags=["languages"])


@router.put("/{language_id}/trigger", responses=problem_responses(404, 409, 412))
@edited
def change_trigger(draft: TriggerDraft, edit: CurrentEdit) -> LanguageView:
    """Choose what begins and ends a take; the takes of all clips are then found by it."""
    studio = edit.studio
    start = None if draft.start is None else _pose(studio, draft.start, "/start")
    stop = None if draft.stop is None else _pose(studio, draft.stop, "/stop")

    def change(language: Language) -> Trigger:
        kept = language.trigger.start if draft.kind == "pose" else None
        try:
            return Trigger(draft.kind, start or kept, stop, draft.start_label, draft.stop_label)
        except TriggerError as error:
            raise _refusal(str(error), "/stop" if stop else "/start") from error

    words = change(studio.language(studio.languages.get(edit.language_id))).words
    return edit.answer(
        edit.save(f"Find takes {words}", lambda each: replace(each, trigger=change(each)))
    )


def _pose(studio: Studio, where: HeldPose, pointer: str) -> ArmPose:
    """Return the pose held in a range of a clip; a problem names its place in the request."""
    poses = studio.recording(where.clip_id).poses
    first = float(poses.time[0]) if where.start is None else where.start
    last = float(poses.time[-1]) if where.end is None else where.end
    inside = poses.between(first, last)
    if not len(inside):
        raise _refusal(
            f"no frames lie between {first:g} s and {last:g} s; the clip goes from "
            f"{poses.time[0]:g} s to {poses.time[-1]:g} s",
            pointer,
        )
    try:
        return ArmPose.from_poses(inside)
    except TriggerError as error:
        raise _refusal(str(error), pointer) from error


def _refusal(reason: str, pointer: str) -> ProblemError:
    return ProblemError(422, "trigger_unusable", reason, pointer=pointer)
