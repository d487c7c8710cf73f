"""Stored recognitions, loaded as result, as context of an explanation, or as response."""

from __future__ import annotations

import json
from typing import Any

from app.api.http.schemas.recognitions import GestureTrial, RecognitionView
from app.api.services.clip_ranges import demonstration_in, surroundings_in
from app.api.services.gesture_edits import change_gesture_of, demonstration_at
from app.api.services.studio import Studio
from app.recognition import Language, Recognition, Recognizer
from app.recognition.explanation.context import RecognitionContext
from app.recognition.language.schema import TuningEntry
from app.recognition.language.tuning_entry import entry_to_tuning
from app.store import LanguageState, RecognitionRecord


def load_situation(record: RecognitionRecord, studio: Studio) -> RecognitionContext:
    """Return the situation in which a recognition was made, by the language as it was then."""
    state = studio.languages.get(record.language_id, record.revision)
    recording = studio.recording(record.clip_id)
    view = view_recognition(record)
    return RecognitionContext(
        recognizer=make_recognizer(studio, state, record.profile, view.tuning, view.trial),
        poses=demonstration_in(recording, record.start, record.end).poses,
        whole=surroundings_in(recording, record.start, record.end),
    )


def make_recognizer(
    studio: Studio,
    state: LanguageState,
    profile: str,
    tuning: TuningEntry | None,
    trial: GestureTrial | None,
) -> Recognizer:
    """Return a recogniser of a revision, with a tuning and a changed gesture where given.

    The revision is not edited: a changed gesture is in a copy of the language.

    Raises
    ------
    ProblemError
        404 when the language has no gesture of the trial's label, 422 when it cannot be changed so.

    """
    if tuning is None and trial is None:
        return studio.recognizer(state, profile)
    language = studio.language(state) if trial is None else try_gesture(studio, state, trial)
    tuned = None if tuning is None else entry_to_tuning(tuning)
    return Recognizer(language, profile, tuning=tuned)


def try_gesture(studio: Studio, state: LanguageState, trial: GestureTrial) -> Language:
    """Return a copy of a revision in which one gesture is changed; errors as `make_recognizer`."""
    change = trial.change.model_copy(update={"label": None})
    shown = change.demonstration
    demonstration = None if shown is None else demonstration_at(studio, shown)
    return change_gesture_of(studio.language(state), trial.label, change, demonstration)


def load_language(record: RecognitionRecord, studio: Studio) -> Language:
    """Return the language that a recognition used, with the changed gesture of a trial."""
    state = studio.languages.get(record.language_id, record.revision)
    trial = view_recognition(record).trial
    return studio.language(state) if trial is None else try_gesture(studio, state, trial)


def load_recognition(record: RecognitionRecord) -> Recognition:
    """Return the recogniser's answer as it was when `record` was made."""
    result: dict[str, Any] = json.loads(record.result)
    return Recognition.from_dict(result)


def view_recognition(record: RecognitionRecord) -> RecognitionView:
    """Return a stored recognition as the API shows it."""
    return RecognitionView(**(json.loads(record.result) | record.model_dump(exclude={"result"})))
