"""Explanation notes: which range was recognised, and a fault of the nearest demonstration."""

from __future__ import annotations

from collections.abc import Iterator

from app.api.services.demonstration_faults import count_triggers_in_clip
from app.api.services.demonstration_sources import sources_in
from app.api.services.running_studio import Studio
from app.recognition import Language
from app.recognition.explanation.demonstration_faults import describe_count
from app.recognition.triggers.trigger import Trigger
from app.store import RecognitionRecord


def write_notes(
    studio: Studio, record: RecognitionRecord, language: Language, *labels: str
) -> list[str]:
    """Return a sentence for the range and for each demonstration with a fault.

    Parameters
    ----------
    studio
        Running studio with the clips.
    record
        The recognition.
    language
        The revision used.
    labels
        Labels of the gestures whose demonstrations matter: the expected and the nearest one.

    """
    return [
        *_describe_range(studio, record, language.trigger),
        *_describe_demonstrations(studio, language, labels),
    ]


def _describe_range(studio: Studio, record: RecognitionRecord, trigger: Trigger) -> Iterator[str]:
    count = count_triggers_in_clip(studio, record.clip_id, record.start, record.end, trigger)
    if count:
        between = "salutes" if trigger.start is None else "poses"
        contained = describe_count(trigger, count)
        yield (
            f"The range that was recognised contains {contained}; choose a take, or a range "
            f"between the {between}."
        )


def _describe_demonstrations(
    studio: Studio, language: Language, labels: tuple[str, ...]
) -> Iterator[str]:
    sources = sources_in(studio, language)
    for label in dict.fromkeys(labels):
        for source in sources.get(label, []):
            if source is not None and source.faults:
                yield source.faults[0].sentence
