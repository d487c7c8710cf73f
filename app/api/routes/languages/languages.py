"""Routes of languages: create, list, read, change, duplicate, delete, restore."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, Any

from fastapi import APIRouter, Response
from pydantic import Field, TypeAdapter

from app.api.http.list_responses import NOT_SENT_AGAIN, KnownTags, list_response
from app.api.http.problems import ProblemError, problem_responses
from app.api.http.revisions import ExpectedRevision
from app.api.http.schemas.languages import (
    LanguageChange,
    LanguageDraft,
    LanguageSummary,
    LanguageView,
)
from app.api.http.schemas.values import Body, Identifier, Seconds, View
from app.api.ingest.intake import SenderQuota
from app.api.routes.asked_revisions import CurrentEdit, CurrentRevision
from app.api.services.language_documents import draft_of, name_of_copy
from app.api.services.language_responses import add_language, announce, answer, view_summary
from app.api.services.limited_routes import computed_briefly, edited
from app.api.services.recording_cache import recording_of
from app.api.services.running_studio import CurrentStudio, Languages
from app.api.services.stored_languages import language_of, recognizer_of
from app.recognition import Language
from app.recognition.errors import TriggerError
from app.recognition.features.trajectory_image import SIMPLIFICATION
from app.recognition.gestures.gesture import MAX_LABEL_LENGTH
from app.recognition.gestures.profile import (
    DEFAULT_PROFILE,
    MAX_SIMPLIFICATION,
    PROFILES,
    ProfileName,
)
from app.recognition.language.file_schema import TuningEntry, entry_to_tuning, tuning_to_entry
from app.recognition.language.grammar_entry import entry_to_grammar
from app.recognition.text.look_alikes import are_confusable
from app.recognition.triggers.trigger import ArmPose, Trigger, TriggerKind
from app.store import ClipStore, LanguageStore

router = APIRouter(prefix="/languages", tags=["languages"])


@router.post("", status_code=201, responses=problem_responses(409))
def create_language(
    draft: LanguageDraft, studio: CurrentStudio, quota: SenderQuota, response: Response
) -> LanguageView:
    """Make an empty language."""
    _require_readable(draft.name, studio.languages)
    language = Language(name=draft.name, author=draft.author)
    made = draft_of(language, "New language")
    return add_language(studio, quota, made, language.revision, response)


@router.get(
    "", response_model=list[LanguageSummary], responses={**problem_responses(), **NOT_SENT_AGAIN}
)
def list_languages(languages: Languages, known: KnownTags) -> Response:
    """List the languages, oldest first."""
    return _listed(languages, known, None)


@router.get("/{language_id}", responses=problem_responses(404))
def get_language(asked: CurrentRevision, studio: CurrentStudio, response: Response) -> LanguageView:
    """Describe a language in its newest or an older revision."""
    return answer(studio, asked.state, response)


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
        _require_readable(change.name, edit.studio.languages, edit.language_id)
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
    asked: CurrentRevision, studio: CurrentStudio, quota: SenderQuota, response: Response
) -> LanguageView:
    """Make another language of a language's newest or an older revision."""
    original = asked.language
    taken = {each.revision.name for each in studio.languages.all()}
    name = name_of_copy(original.name, taken)
    copy = replace(original, name=name, created=None, revision=1)
    change = f"Copy of {original.name}, revision {asked.state.revision.revision}"
    return add_language(studio, quota, draft_of(copy, change), copy.revision, response)


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


def _require_readable(name: str, languages: LanguageStore, language_id: str | None = None) -> None:
    """Refuse a name that looks like another language's and is not the same."""
    for state in languages.all():
        known = state.revision.name
        if state.record.id != language_id and known != name and are_confusable(name, known):
            detail = f"the name {name!r} looks like that of the language {known!r}; choose another"
            raise ProblemError(409, "name_taken", detail, pointer="/name")


def _summaries(
    languages: LanguageStore, _all: None
) -> tuple[list[LanguageSummary], dict[str, str]]:
    return [view_summary(state) for state in languages.all()], {}


_listed = list_response(_summaries, TypeAdapter(list[LanguageSummary]), kept=1)


class ProfileView(View):
    """A profile that a language can choose."""

    name: ProfileName
    rejects: bool
    """Whether it rejects movements that are no gesture."""
    repairs_keypoints: bool
    """Whether bad keypoints are repaired first."""
    voters: list[str]


class SettingsView(View):
    """How a language is recognised, and what it would be by default."""

    profile: ProfileName
    default_profile: ProfileName
    profiles: list[ProfileView]
    tuning: TuningEntry | None
    """What differs from the profile; null: nothing."""
    simplification: float
    """Default tolerance of drawings, pixels of 224."""
    most_simplification: float
    weights: dict[str, float]
    """Each voter's normalised weight in this language, with its weight factor; empty without
    gestures."""


@router.get("/{language_id}/settings", responses=problem_responses(404))
@computed_briefly
def get_settings(asked: CurrentRevision) -> SettingsView:
    """Return profile and tuning of a language beside the defaults; `PATCH` changes them."""
    language = asked.language
    weights = dict(recognizer_of(asked.state).vote.weights) if language.gestures else {}
    return SettingsView(
        profile=language.profile,
        default_profile=DEFAULT_PROFILE,
        profiles=[
            ProfileView(**(vars(each) | {"voters": [voter.name for voter in each.voters]}))
            for each in PROFILES.values()
        ],
        tuning=tuning_to_entry(language.tuning),
        simplification=SIMPLIFICATION,
        most_simplification=MAX_SIMPLIFICATION,
        weights=weights,
    )


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


@router.put("/{language_id}/trigger", responses=problem_responses(404, 409, 412))
@edited
def change_trigger(draft: TriggerDraft, edit: CurrentEdit) -> LanguageView:
    """Choose what begins and ends a take; the takes of all clips are then found by it."""
    clips, languages = edit.studio.clips, edit.studio.languages
    start = None if draft.start is None else _pose(clips, draft.start, "/start")
    stop = None if draft.stop is None else _pose(clips, draft.stop, "/stop")

    def change(language: Language) -> Trigger:
        kept = language.trigger.start if draft.kind == "pose" else None
        try:
            return Trigger(draft.kind, start or kept, stop, draft.start_label, draft.stop_label)
        except TriggerError as error:
            raise _refusal(str(error), "/stop" if stop else "/start") from error

    words = change(language_of(languages.get(edit.language_id))).words
    return edit.answer(
        edit.save(f"Find takes {words}", lambda each: replace(each, trigger=change(each)))
    )


def _pose(clips: ClipStore, where: HeldPose, pointer: str) -> ArmPose:
    """Return the pose held in a range of a clip; a problem names its place in the request."""
    poses = recording_of(clips, where.clip_id).poses
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
