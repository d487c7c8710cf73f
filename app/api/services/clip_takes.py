"""Clip takes: finds the takes of a clip between a language's triggers, or by spotting."""

from __future__ import annotations

from functools import lru_cache

from app.api.http.schemas.clips import TakeView
from app.api.services.recording_cache import RecordingFile, load_recording
from app.api.services.running_studio import Studio
from app.recognition import Language, OsgError, Recognizer
from app.recognition.recording.segmentation import takes_in
from app.recognition.spotting import Spotter
from app.recognition.triggers.trigger import SALUTE, Trigger
from app.store import LanguageState

CACHED_CLIPS = 64
"""Number of clips whose takes are cached: spotting takes a fifth of a clip's duration, and trimming
some milliseconds a take."""


def trigger_of(studio: Studio, language_id: str | None) -> Trigger:
    """Return the trigger of a language's newest revision; without a language, the salute.

    Raises
    ------
    NotFound
        When there is no such language.

    """
    if language_id is None:
        return SALUTE
    return studio.language(studio.languages.get(language_id)).trigger


def find_takes(
    studio: Studio, clip_id: str, state: LanguageState | None, *, so_far: bool = False
) -> tuple[TakeView, ...]:
    """Return the takes of a clip by a language's trigger; without a trigger, the spotted gestures.

    With `so_far`, those that have ended in a clip whose other frames are being read.

    Raises
    ------
    NotFound, ProblemError
        As `Studio.recording_file`.

    """
    recording = studio.recording_file(clip_id, so_far=so_far)
    trigger = SALUTE if state is None else studio.language(state).trigger
    if state is not None and trigger.spots:
        takes = _spot(recording, state.revision.document)
    else:
        takes = _segment(recording, trigger)
    return takes if recording.whole else tuple(take for take in takes if take.closed)


@lru_cache(CACHED_CLIPS)
def _segment(recording: RecordingFile, trigger: Trigger) -> tuple[TakeView, ...]:
    """Find the takes between held triggers."""
    return tuple(
        TakeView.model_validate(take)
        for take in takes_in(load_recording(recording), trigger=trigger)
    )


@lru_cache(CACHED_CLIPS)
def _spot(recording: RecordingFile, document: str) -> tuple[TakeView, ...]:
    """Spot a language's gestures; return none if none of them can be spotted."""
    try:
        spotter = Spotter(Recognizer(Language.from_json(document)))
    except OsgError:
        return ()
    return tuple(
        TakeView(
            start=found.start,
            end=found.end,
            closed=True,
            stroke_start=found.start,
            stroke_end=found.end,
        )
        for found in spotter.listen(load_recording(recording).poses)
    )
