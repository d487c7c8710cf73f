"""Sign sequences: takes in which one hand shows held signs one after the other, composed of takes.

A person shows all signs of a sequence with the same hand and the same side of it. The recorded
takes name neither, so the takes of a run are mirrored if that brings them nearer to the first run
of their sign; a composed take may then be mirrored as a whole. A fifth of a recorded take is cut at
either end, where the hand may come or go; 0.6 s remain.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from app.recognition import PoseSequence
from app.recognition.poses.frame import HandShape
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.registry import HAND_VOTERS
from benchmarks.sets.held_signs import FRAME, RATE, HeldSigns

CHANGE = (0.1, 1.0)
"""Seconds that the change from one sign to the next takes, uniformly drawn."""

ON_ITS_WAY = 0.2
"""Share of a take at either end in which the hand may come or go, as in `holds`."""

UNSEEN = 0.5
"""Share of the changes during which no hand is found; in the others the hand moves straight."""


def turn_alike(signs: HeldSigns) -> HeldSigns:
    """Return the takes of signs with every run of a sign mirrored to be like its first run."""
    takes = list(signs.takes)
    for label in np.unique(signs.labels):
        first, *others = np.unique(signs.runs[signs.labels == label])
        shown = _median_of_run(signs, label, first)
        for run in others:
            seen = _median_of_run(signs, label, run)
            if _measure(seen.mirror(), shown) < _measure(seen, shown):
                for take in np.flatnonzero((signs.labels == label) & (signs.runs == run)):
                    takes[take] = mirror(takes[take])
    return replace(signs, takes=takes)


def mirror(take: PoseSequence) -> PoseSequence:
    """Return the mirror image of a take of one hand, still as the right one."""
    flip, shift = np.array((-1.0, 1.0)), np.array((FRAME[0], 0.0))
    return replace(take, xy=take.xy * flip + shift, hands=_hands_of(take) * flip + shift)


def compose(takes: Sequence[PoseSequence], random: np.random.Generator) -> PoseSequence:
    """Return a take that shows the signs of some takes one after the other, at one place."""
    parts = [_held_part(takes[0])]
    for hand in map(_held_part, takes[1:]):
        following = hand + (parts[-1][-1, 0] - hand[0, 0])
        frames = max(1, round(RATE * random.uniform(*CHANGE)))
        shares = (np.arange(1, frames + 1) / (frames + 1))[:, None, None]
        change = parts[-1][-1] + shares * (following[0] - parts[-1][-1])
        parts += [np.full_like(change, np.nan) if random.random() < UNSEEN else change, following]
    whole = np.concatenate(parts)
    hands = np.full((len(whole), 2, *whole.shape[1:]), np.nan)
    hands[:, 1] = whole
    made = replace(takes[0], xy=whole[:, :1], hands=hands, time=np.arange(len(whole)) / RATE)
    return mirror(made) if random.random() < 0.5 else made


def _held_part(take: PoseSequence) -> FloatArray:
    """Return ``(T, 21, 2)`` without `ON_ITS_WAY`, between frames in which the hand is seen."""
    hand = _hands_of(take)[:, 1]
    cut = round(ON_ITS_WAY * len(hand))
    middle = hand[cut : len(hand) - cut]
    seen = np.flatnonzero(np.isfinite(middle).all(axis=(1, 2)))
    return middle[seen[0] : seen[-1] + 1]


def _median_of_run(signs: HeldSigns, label: str, run: int) -> HandShape:
    takes = np.flatnonzero((signs.labels == label) & (signs.runs == run))
    frames = np.concatenate([_held_part(signs.takes[take]) for take in takes])
    return HandShape.of_frames("right", frames[np.isfinite(frames).all(axis=(1, 2))])


def _measure(one: HandShape, other: HandShape) -> float:
    return float(
        sum(
            voter.distances(voter.describe(one), voter.describe(other)[None])[0] / voter.between
            for voter in HAND_VOTERS
        )
    )


def _hands_of(take: PoseSequence) -> FloatArray:
    assert take.hands is not None
    return take.hands
