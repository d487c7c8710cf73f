"""Tunings to and from their entry in the language file."""

from __future__ import annotations

from app.recognition.language_schema import TuningEntry
from app.recognition.trajectory_image import SIMPLIFICATION
from app.recognition.tuning import Tuning


def tuning_entry_of(tuning: Tuning) -> TuningEntry:
    """Return the file's entry of a tuning."""
    return TuningEntry(
        weights=dict(tuning.weights),
        simplification=(None if tuning.simplification == SIMPLIFICATION else tuning.simplification),
        keypoints_repaired=tuning.keypoints_repaired,
    )


def tuning_of(entry: TuningEntry) -> Tuning:
    """Return the tuning of a file's entry."""
    return Tuning(
        weights=entry.weights,
        simplification=SIMPLIFICATION if entry.simplification is None else entry.simplification,
        keypoints_repaired=entry.keypoints_repaired,
    )
