"""Calibration: each gesture's thresholds, without a recording more than its demonstration.

Plausible takes of the demonstration by other people (`variation`) tell how far each voter's
distances usually reach.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from app.recognition.calibrated_vote import VOTERS, with_mirror_images
from app.recognition.fusion import TYPICAL
from app.recognition.gesture import Gesture
from app.recognition.motion_references import (
    MAX_GESTURES_READ_OTHERWISE,
    MotionReferences,
    describe_movement,
)
from app.recognition.poses import FloatArray
from app.recognition.rejection import NOVELTY_VOTERS
from app.recognition.variation import variants
from app.recognition.voters.motion import MOTION_VOTERS

TAKES = 12
"""Plausible takes drawn of each gesture: the mean of their distances is known to a seventh."""

REACH = 3.25
"""Thresholds, in mean distances of plausible takes. Of other people's recordings, about one
take in twenty lies beyond."""

LEAST_SPREAD = 0.2
"""Least mean distance, as a share of that between two people's takes of any gesture
(`fusion.TYPICAL`): twelve takes may be alike by chance, or the gesture too simple to vary."""

DIGITS = 4
"""Significant decimal digits kept of a threshold: far more than it is known to."""


def calibrated(gestures: Sequence[Gesture]) -> tuple[Gesture, ...]:
    """Give every gesture thresholds that fit this language.

    Gestures without a demonstration, and those of a language of more than
    `MAX_GESTURES_READ_OTHERWISE`, get those of a typical gesture.

    Parameters
    ----------
    gestures
        Of one language, at least one.

    """
    sides, _ = with_mirror_images(gestures)
    references = MotionReferences.of(sides, only_as_shown=True)
    spreads = _spreads(gestures, references)
    return tuple(
        replace(gesture, thresholds=_thresholds(spread))
        for gesture, spread in zip(gestures, spreads.T, strict=True)
    )


def _thresholds(spread: FloatArray) -> dict[str, float]:
    """Return each voter's threshold, given ``(V,)`` mean distances of plausible takes."""
    return {
        voter: float(f"{REACH * spread[VOTERS.index(voter)]:.{DIGITS}g}")
        for voter in NOVELTY_VOTERS
    }


def _spreads(gestures: Sequence[Gesture], references: MotionReferences) -> FloatArray:
    """Measure ``(V, G)`` mean distances between the demonstrations and plausible takes of them."""
    typical = np.array([TYPICAL[voter].within for voter in VOTERS])
    spreads = np.repeat(typical[:, None], len(gestures), axis=1)
    if len(gestures) > MAX_GESTURES_READ_OTHERWISE:
        return spreads
    for row in references.as_shown:
        index = int(references.gestures[row])
        if index >= len(gestures):
            continue  # a mirror image varies as much as what it mirrors
        measured = _distances_to_takes(gestures[index], references, int(row)).mean(axis=1)
        for voter, distance in zip(MOTION_VOTERS, measured, strict=True):
            at = VOTERS.index(voter.name)
            if np.isfinite(distance):
                spreads[at, index] = max(distance, LEAST_SPREAD * typical[at])
    return spreads


def _distances_to_takes(gesture: Gesture, references: MotionReferences, row: int) -> FloatArray:
    """Compare a gesture as shown with `TAKES` plausible takes of it: ``(motion voters, TAKES)``."""
    assert gesture.trajectory is not None  # it has a row
    takes = [
        describe_movement(take, references.landmarks)
        for take in variants(gesture.trajectory, TAKES, person="another")
    ]
    return np.stack(
        [
            voter.distances(
                references.descriptors[voter.name][row],
                np.array([take[voter.name] for take in takes]),
            )
            for voter in MOTION_VOTERS
        ]
    )
