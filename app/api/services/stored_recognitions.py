"""Stored recognitions: read again as result, as context of an explanation, and as response."""

from __future__ import annotations

import json
from typing import Any

from app.api.http.schemas import RecognitionView
from app.api.services.clip_ranges import demonstration_in, surroundings_in
from app.api.services.context import Studio
from app.recognition import Recognition, Recognizer
from app.recognition.explanation.context import RecognitionContext
from app.recognition.language.schema import TuningEntry
from app.recognition.language.tuning_entry import entry_to_tuning
from app.store import RecognitionRecord


def load_situation(record: RecognitionRecord, studio: Studio) -> RecognitionContext:
    """Return the situation in which a recognition was made, by the language as it was then."""
    state = studio.languages.get(record.language_id, record.revision)
    recording = studio.recording(record.clip_id)
    return RecognitionContext(
        recognizer=tune_recognizer(
            studio.recognizer(state, record.profile), view_recognition(record).tuning
        ),
        poses=demonstration_in(recording, record.start, record.end).poses,
        whole=surroundings_in(recording, record.start, record.end),
    )


def tune_recognizer(recognizer: Recognizer, asked: TuningEntry | None) -> Recognizer:
    """Return the recogniser with the tuning asked for; the same one where none is."""
    if asked is None:
        return recognizer
    return Recognizer(recognizer.language, recognizer.profile, tuning=entry_to_tuning(asked))


def load_recognition(record: RecognitionRecord) -> Recognition:
    """Return the recogniser's answer as it was when `record` was made."""
    result: dict[str, Any] = json.loads(record.result)
    return Recognition.from_dict(result)


def view_recognition(record: RecognitionRecord) -> RecognitionView:
    """Return a stored recognition as the API shows it."""
    return RecognitionView(**(json.loads(record.result) | record.model_dump(exclude={"result"})))
