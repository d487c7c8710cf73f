"""Routes of recognitions: recognise, list, read, explain."""

from __future__ import annotations

import json
from typing import Annotated

import numpy as np
from fastapi import APIRouter, Query, Response

from app.api.http.problems import ProblemError, problem_responses
from app.api.http.schemas.recognitions import ExplanationView, RecognitionRequest, RecognitionView
from app.api.http.schemas.values import Label
from app.api.services.clip_ranges import demonstration_in
from app.api.services.clip_views import shows_pictures
from app.api.services.explanation_notes import write_notes
from app.api.services.stored_recognitions import (
    load_situation,
    make_recognizer,
    view_recognition,
)
from app.api.services.studio import CurrentStudio
from app.recognition import Language, PoseSequence
from app.recognition.explanation.explanation import explain
from app.recognition.language.requirements import require_landmarks
from app.store import Clip, RecognitionRecord

MOST_LISTED = 500
"""Recognitions in one answer; the page shows the newest of one clip or language."""

router = APIRouter(prefix="/recognitions", tags=["recognitions"])


@router.post("", status_code=201, responses=problem_responses(404, 409))
def recognize(request: RecognitionRequest, studio: CurrentStudio) -> RecognitionView:
    """Recognise a take, a range or all of a clip, and keep the answer."""
    state = studio.languages.get(request.language_id)
    recording = studio.recording(request.clip_id)
    language = studio.language(state)
    profile = request.profile or language.profile
    require_landmarks_of(studio.clips.get(request.clip_id).clip, recording.poses, language)
    demonstration = demonstration_in(recording, request.start, request.end)
    recognizer = make_recognizer(studio, state, profile, request.tuning, request.trial)
    result = recognizer.recognize(demonstration.poses).to_dict()
    if request.tuning is not None:
        result["tuning"] = request.tuning.model_dump()
    if request.trial is not None:
        result["trial"] = request.trial.model_dump(exclude_unset=True)
    record = studio.recognitions.add(
        RecognitionRecord(
            clip_id=request.clip_id,
            language_id=state.record.id,
            revision=state.revision.revision,
            start=demonstration.start,
            end=demonstration.end,
            profile=profile,
            expected=request.expected,
            result=json.dumps(result, allow_nan=False),
        )
    )
    studio.broadcast.publish("recognitions", id=record.id, clip_id=record.clip_id)
    return view_recognition(record)


@router.get("", responses=problem_responses())
def list_recognitions(
    studio: CurrentStudio,
    clip_id: Annotated[str | None, Query(max_length=64)] = None,
    language_id: Annotated[str | None, Query(max_length=64)] = None,
    limit: Annotated[int, Query(ge=1, le=MOST_LISTED)] = 100,
) -> list[RecognitionView]:
    """List recognitions, newest first."""
    found = studio.recognitions.all(clip_id=clip_id, language_id=language_id, limit=limit)
    return [view_recognition(record) for record in found]


@router.get("/{recognition_id}", responses=problem_responses(404))
def get_recognition(recognition_id: str, studio: CurrentStudio) -> RecognitionView:
    """Return a recognition as it was answered."""
    return view_recognition(studio.recognitions.get(recognition_id))


@router.get("/{recognition_id}/explanation", responses=problem_responses(404, 409))
def explain_recognition(
    recognition_id: str,
    studio: CurrentStudio,
    response: Response,
    expected: Annotated[Label | None, Query()] = None,
) -> ExplanationView:
    """Explain why a recognition came out as it did, and what would have turned it right.

    By the language as it was then. `expected` is the gesture that was meant, by default the one
    that the recognition was asked for with.
    """
    record = studio.recognitions.get(recognition_id)
    meant = expected or record.expected
    if meant is None:
        detail = "say which gesture was meant: add ?expected=LABEL"
        raise ProblemError(422, "expected_missing", detail)
    situation = load_situation(record, studio)
    # A recognition never changes, nor does the revision that it was made with.
    response.headers["Cache-Control"] = "private, max-age=86400"
    explanation = explain(situation, meant)
    notes = write_notes(studio, record, situation.language, meant, explanation.nearest)
    return ExplanationView(id=record.id, **explanation.to_dict(), notes=notes)


def require_landmarks_of(clip: Clip, poses: PoseSequence, language: Language) -> None:
    """Refuse a clip that came as keypoints without those that a language follows.

    What our models look at may show any landmark, and is judged when it is recognised.

    Raises
    ------
    LandmarkError
        Naming the landmark, and the gesture that follows it.

    """
    if not shows_pictures(clip):
        given = [poses.landmarks[row] for row in np.flatnonzero(poses.seen.any(axis=0))]
        require_landmarks(language, given, clip.name)
