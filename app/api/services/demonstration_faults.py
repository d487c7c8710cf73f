"""Demonstration faults: what is wrong with ranges of clips as demonstrations, cached."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

from app.api.http.schemas.gestures import NewDemonstration
from app.api.services.recording_cache import RecordingFile, load_recording, whole_recording
from app.api.services.running_studio import Studio
from app.recognition import Language, OsgError
from app.recognition.explanation.demonstration_faults import (
    ClipOutline,
    DemonstrationFault,
    find_demonstration_faults,
)
from app.recognition.gestures.gesture import Gesture
from app.recognition.triggers.trigger import SALUTE, Trigger
from app.store import DemonstrationSource, JobStatus

CACHED_CLIPS = 512
"""Number of clips whose outlines and faults are cached: the demonstrations of several large
languages."""


def count_triggers_in_clip(
    studio: Studio, clip_id: str, start: float, end: float, trigger: Trigger = SALUTE
) -> int:
    """Return how many triggers a range of a clip contains; 0 while its poses are not extracted."""
    file = _find_recording(studio, clip_id)
    return 0 if file is None else _outline_of(file, trigger).count_triggers(start, end)


def faults_of_source(
    studio: Studio,
    source: DemonstrationSource | NewDemonstration,
    gesture: Gesture,
    trigger: Trigger,
) -> tuple[DemonstrationFault, ...]:
    """Return the faults of a demonstration whose clip is known, the gravest first.

    Parameters
    ----------
    studio
        Running studio with the clips.
    source
        Where the demonstration comes from.
    gesture
        The gesture with this demonstration alone.
    trigger
        The language's.

    """
    file = _find_recording(studio, source.clip_id)
    if file is None:
        return ()
    counts = gesture.switches.hand_shape == "on"
    where = (source.start, source.end, source.keep_transit)
    return _faults_of(file, where, trigger, gesture.salient, counts)


def faults_of_language(
    studio: Studio, language: Language, sources: dict[str, list[DemonstrationSource | None]]
) -> dict[str, list[tuple[DemonstrationFault, ...]]]:
    """Return by label the faults of each demonstration of a language; none where not known.

    `sources` are those of `demonstration_sources.find_sources`.
    """
    return {
        gesture.label: [
            () if source is None else faults_of_source(studio, source, each, language.trigger)
            for each, source in zip(
                gesture.single_demonstrations(), sources[gesture.label], strict=True
            )
        ]
        for gesture in language.gestures
    }


def _find_recording(studio: Studio, clip_id: str) -> RecordingFile | None:
    """Return the file of a clip's recording; None while its poses are not extracted."""
    if studio.clips.get(clip_id).job.status != JobStatus.DONE:
        return None
    return whole_recording(studio.clips.recording(clip_id))


@lru_cache(CACHED_CLIPS)
def _outline_of(file: RecordingFile, trigger: Trigger) -> ClipOutline:
    return ClipOutline.of(load_recording(file), trigger)


@lru_cache(CACHED_CLIPS)
def _faults_of(
    file: RecordingFile,
    where: tuple[float | None, float | None, bool],
    trigger: Trigger,
    salient: Sequence[str],
    counts: bool,
) -> tuple[DemonstrationFault, ...]:
    start, end, keep_transit = where
    try:
        return find_demonstration_faults(
            load_recording(file),
            start,
            end,
            outline=_outline_of(file, trigger),
            trigger=trigger,
            keep_transit=keep_transit,
            salient=salient,
            hand_counts=counts,
        )
    except OsgError:
        return ()
