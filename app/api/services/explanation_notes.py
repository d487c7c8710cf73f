"""Explanation notes: which range was recognised, and a fault of the nearest demonstration."""

from __future__ import annotations

from app.api.services.demonstration_faults import count_triggers_in_clip
from app.api.services.demonstration_sources import sources_in
from app.api.services.running_studio import Studio
from app.recognition import Language
from app.recognition.explanation.demonstration_faults import describe_count
from app.store import RecognitionRecord


def write_notes(
    studio: Studio, record: RecognitionRecord, language: Language, nearest: str | None = None
) -> list[str]:
    """Return a sentence for the range, and for each demonstration of a gesture with a fault.

    Parameters
    ----------
    studio
        Running studio with the clips.
    record
        The recognition.
    language
        The revision used.
    nearest
        Label of the gesture whose demonstrations matter; None: none do.

    """
    notes = []
    trigger = language.trigger
    if count := count_triggers_in_clip(studio, record.clip_id, record.start, record.end, trigger):
        between = "salutes" if trigger.start is None else "poses"
        contained = describe_count(trigger, count)
        notes.append(
            f"The range that was recognised contains {contained}; choose a take, or a range "
            f"between the {between}."
        )
    if nearest is not None:
        for source in sources_in(studio, language).get(nearest, []):
            if source is not None and source.faults:
                notes.append(source.faults[0].sentence)
    return notes
