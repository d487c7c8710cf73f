"""Tuning entry: conversion of tunings to and from their entry in the language file."""

from __future__ import annotations

from app.recognition.features.trajectory_image import SIMPLIFICATION
from app.recognition.gestures.profile import ProfileName, find_profile
from app.recognition.gestures.tuning import AS_THE_PROFILE, Tuning
from app.recognition.language.file_schema import TuningEntry
from app.recognition.voters.registry import FORMER_VOTERS, PAPER_VOTERS


def tuning_to_entry(tuning: Tuning) -> TuningEntry | None:
    """Return the file's entry of a tuning; None if it changes nothing."""
    if tuning == AS_THE_PROFILE:
        return None
    return TuningEntry(
        weights=dict(tuning.weights),
        simplification=(None if tuning.simplification == SIMPLIFICATION else tuning.simplification),
        keypoints_repaired=tuning.keypoints_repaired,
    )


def entry_to_tuning(entry: TuningEntry | None, profile: ProfileName = "paper") -> Tuning:
    """Return the tuning of an entry, or the default without one.

    Weight factors for voters that the profile had in an earlier version are left out.
    """
    if entry is None:
        return AS_THE_PROFILE
    former = FORMER_VOTERS | {voter.name for voter in PAPER_VOTERS}
    former -= {voter.name for voter in find_profile(profile).voters}
    return Tuning(
        weights={voter: factor for voter, factor in entry.weights.items() if voter not in former},
        simplification=SIMPLIFICATION if entry.simplification is None else entry.simplification,
        keypoints_repaired=entry.keypoints_repaired,
    )
