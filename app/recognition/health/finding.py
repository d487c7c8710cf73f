"""Findings: errors and notes of a health report, and those about a demonstration by itself."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from app.recognition.features.contour import BinaryImage
from app.recognition.features.png import encode_png, to_data_url
from app.recognition.gestures.demonstration import MAX_MOMENTS
from app.recognition.gestures.gesture import Gesture
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.salience import MIN_DISPLACEMENT, measure_displacements
from app.recognition.recording.salute import HOLD_SECONDS, LEAVE_SCORE, salute_score

SHORTEST_SECONDS = 0.5
"""Least duration of a demonstration: a single reach takes half a second (Flash and Hogan 1985)."""

LONGEST_SECONDS = MAX_MOMENTS / 10
"""Longest demonstration; of longer ones fewer than ten moments a second are kept."""

SMALLEST = 1.5 * MIN_DISPLACEMENT
"""Least displacement, torso lengths: idle hands move up to 0.2, and people's takes differ in size
by a third of a doubling."""

LEAST_SEEN = 0.8
"""Least share of moments in which a salient landmark is seen, after bridging gaps of half a second;
what is still missing are whole strokes."""

HELD_STILL = 0.2
"""Torso lengths a second, about 10 cm, below which a hand is held still, as in a salute."""


DUPLICATE = 0.12
"""Fused distance of two demonstrations below which they are the same: less than between two takes
of one gesture by the same person; 1 is two typical gestures."""

FindingKind = Literal[
    "blind_angle",
    "demonstration_fault",
    "duplicate",
    "empty",
    "hand_shape_only",
    "hand_shape_undecided",
    "hand_unseen",
    "known_sign",
    "look_alike",
    "misread",
    "missed",
    "no_demonstration",
    "phrases_overlap",
    "phrases_prefix",
    "phrases_run_together",
    "phrases_same_sequence",
    "phrases_unreachable",
    "poorly_seen",
    "salute_like",
    "too_long",
    "too_short",
    "too_small",
    "trigger_accidental",
    "trigger_like",
    "trigger_missed",
    "trigger_passed",
    "unrejecting",
    "untriggered",
]
"""Kinds of findings; those of the grammar are ``phrases_`` with an `ambiguity.AmbiguityKind`."""


@dataclass(frozen=True)
class Finding:
    """One entry of a health report.

    Attributes
    ----------
    kind
        For programs; people read the message.
    gestures
        Labels of the gestures concerned; none for phrases.
    message
        What is wrong and why that matters, in one sentence or two.
    error
        Whether it is an error and not a note.
    drawings
        One of each gesture where the message does not tell enough; otherwise none.

    """

    kind: FindingKind
    gestures: tuple[str, ...]
    message: str
    error: bool = False
    drawings: tuple[BinaryImage, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON types, the drawings as data URIs."""
        return vars(self) | {
            "gestures": list(self.gestures),
            "drawings": [to_data_url(encode_png(each)) for each in self.drawings],
        }


def check_demonstration(gesture: Gesture, *, salutes: bool = True) -> Iterator[Finding]:
    """Yield the findings about one gesture's demonstration.

    `salutes`: whether a salute ends takes, and a gesture must not resemble one.
    """
    shown, label = gesture.trajectory, (gesture.label,)
    if shown is not None and gesture.is_held:
        yield from _check_held_shape(gesture, shown)
        return
    if shown is None or not gesture.salient:
        yield Finding(
            "no_demonstration",
            label,
            f"{gesture.label} came without its demonstration, so its movement cannot be compared: "
            "define it again from a clip",
        )
        return
    seconds = float(shown.time[-1] - shown.time[0])
    if seconds < SHORTEST_SECONDS:
        text = f"takes {seconds:.1f} s: shorter than one reach of an arm; show it more slowly"
        yield Finding("too_short", label, f"{gesture.label} {text}")
    if seconds > LONGEST_SECONDS:
        text = f"takes {seconds:.0f} s: details are lost beyond {LONGEST_SECONDS:.0f}; shorten it"
        yield Finding("too_long", label, f"{gesture.label} {text}")
    size = max(measure_displacements(shown)[name] for name in gesture.salient)
    if shown.unit == "torso_length" and size < SMALLEST:
        yield Finding(
            "too_small",
            label,
            f"{gesture.label} spans only {size:.2f} torso lengths, and even an idle hand moves up "
            f"to 0.2: show it larger",
        )
    for name in gesture.salient:
        if (seen := measure_visible_share(shown, name)) < LEAST_SEEN:
            yield Finding(
                "poorly_seen",
                label,
                f"{name} of {gesture.label} was seen in {seen:.0%} of its demonstration: film it "
                "again with the hand in view",
            )
    if gesture.switches.hand_shape == "on" and not shown.moving_hands:
        yield Finding(
            "hand_unseen",
            label,
            f"no hand is seen in the demonstration of {gesture.label} that keeps a shape, so that "
            "its hand shape cannot count: film it again with the hand in view",
        )
    if salutes and (held := find_longest_held_up(shown)) >= HOLD_SECONDS:
        yield Finding(
            "salute_like",
            label,
            f"{gesture.label} holds a hand up and still for {held:.1f} s: with its fingers spread "
            "that is a salute, and ends the take; keep the fist closed or the hand moving",
        )


def _check_held_shape(gesture: Gesture, shown: Trajectory) -> Iterator[Finding]:
    """Yield the findings about held hand shapes that would end their own take."""
    several = len(shown.held_shapes) > 1
    for ordinal, hands in zip(("first", "second"), shown.held_shapes, strict=False):
        which = f"the {ordinal} shape of {gesture.label}" if several else gesture.label
        if any(salute_score(hand.xy) > LEAVE_SCORE for hand in hands):
            yield Finding(
                "salute_like",
                (gesture.label,),
                f"{which} looks like the salute, which ends the take: choose a shape whose middle "
                "and ring finger are not spread apart",
            )


def measure_visible_share(shown: Trajectory, landmark: str) -> float:
    """Return the share of a demonstration's moments in which a landmark is seen."""
    return float(np.isfinite(shown.select([landmark]).xy).all(axis=(1, 2)).mean())


def find_longest_held_up(shown: Trajectory) -> float:
    """Return the longest time that an upright hand is held still above its elbow, in seconds."""
    longest = 0.0
    for side in ("left", "right"):
        names = [f"{side}_{part}" for part in ("elbow", "wrist", "index")]
        if not set(names) <= set(shown.landmarks):
            continue
        elbow, wrist, index = np.moveaxis(shown.select(names).xy, 1, 0)
        upright = (index[1:, 1] < wrist[1:, 1]) & (wrist[1:, 1] < elbow[1:, 1])
        steps = np.diff(shown.time)
        still = np.linalg.norm(np.diff(wrist, axis=0), axis=1) < HELD_STILL * steps
        held = 0.0
        for seconds in np.where(upright & still, steps, 0.0):
            held = held + float(seconds) if seconds else 0.0
            longest = max(longest, held)
    return longest
