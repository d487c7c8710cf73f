"""Findings: errors and notes of a health report, with the rates and the verdict that sum them up.

`check_demonstration` yields those about a demonstration by itself. A `Rate` tells how often
something happened among what was tried, with a 95 % interval. The `Verdict` on a language holds the
errors of its check, and what a test has shown of its gestures.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, is_dataclass
from typing import Any, Final, Literal

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


STANDARD_ERRORS: Final = 1.96
"""Standard errors to either side of a 95 % interval of a normal distribution."""

DIGITS: Final = 4
"""Decimals in JSON: a hundredth of a per cent, far below the accuracy of any rate here."""


@dataclass(frozen=True)
class Rate:
    """A counted share.

    Attributes
    ----------
    happened, n
        How often it happened, of n > 0.

    """

    happened: int
    n: int

    @property
    def rate(self) -> float:
        """The share, in [0, 1]."""
        return self.happened / self.n

    @property
    def interval(self) -> tuple[float, float]:
        """Wilson's 95 % interval (Wilson 1927)."""
        square = STANDARD_ERRORS**2 / self.n
        middle = (self.rate + square / 2) / (1 + square)
        spread = math.sqrt(self.rate * (1 - self.rate) * square + square * square / 4)
        half = spread / (1 + square)
        # Rounding may move an end past the rate.
        return max(0.0, min(self.rate, middle - half)), min(1.0, max(self.rate, middle + half))

    def __str__(self) -> str:
        low, high = self.interval
        return f"{self.rate:.0%} ({low:.0%}-{high:.0%}, n {self.n})"


def to_plain(value: Any) -> Any:
    """Return a part of a report in plain JSON types, numbers rounded to `DIGITS`."""
    if isinstance(value, Rate):
        low, high = value.interval
        return to_plain({"rate": value.rate, "low": low, "high": high, "n": value.n})
    if is_dataclass(value):
        return to_plain(vars(value))
    if isinstance(value, dict):
        return {name: to_plain(each) for name, each in value.items()}
    if isinstance(value, list | tuple):
        return [to_plain(each) for each in value]
    return round(value, DIGITS) if isinstance(value, float) else value


@dataclass(frozen=True)
class TestedGesture:
    """What the test of a language has shown of one gesture.

    Attributes
    ----------
    label
        Its label.
    right, asked
        Number of its takes that are read right, and of those that were read by demonstrations other
        than themselves.

    """

    __test__ = False

    label: str
    right: int
    asked: int

    @property
    def fails(self) -> bool:
        """Whether less than half of its takes are read right."""
        return 2 * self.right < self.asked


@dataclass(frozen=True)
class Verdict:
    """Verdict on a language, one for the page, the export and the command line.

    Attributes
    ----------
    errors
        Number of errors that the check has found.
    failing
        Gestures of which less than half of the takes are read right.
    untested
        Labels of the gestures of which no take was read.
    gestures
        Number of gestures of the language.

    """

    errors: int
    failing: tuple[TestedGesture, ...] = ()
    untested: tuple[str, ...] = ()
    gestures: int = 0

    @classmethod
    def of(
        cls, errors: int, labels: Sequence[str], tested: Sequence[TestedGesture] = ()
    ) -> Verdict:
        """Return the verdict on a language with these labels; `tested` may name others."""
        known = [each for each in tested if each.asked and each.label in labels]
        seen = {each.label for each in known}
        return cls(
            errors,
            tuple(each for each in known if each.fails),
            tuple(label for label in labels if label not in seen),
            len(labels),
        )

    @property
    def is_ready(self) -> bool:
        """Whether nothing is wrong, and every gesture was tested."""
        return not (self.errors or self.failing or self.untested)

    @property
    def words(self) -> str:
        """The verdict as a clause: "no errors, 3 gestures untested"."""
        return ", ".join(self._parts())

    def _parts(self) -> Iterator[str]:
        if self.errors or not self.failing:
            yield {0: "no errors", 1: "1 error"}.get(self.errors, f"{self.errors} errors")
        yield from (f"{each.label} {each.right} of {each.asked}" for each in self.failing)
        if len(self.untested) == 1:
            yield f"{self.untested[0]} untested"
        elif self.untested:
            all_of_them = len(self.untested) == self.gestures
            yield "no gesture tested" if all_of_them else f"{len(self.untested)} gestures untested"

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON types."""
        return {
            "ready": self.is_ready,
            "words": self.words,
            "errors": self.errors,
            "failing": [vars(each) for each in self.failing],
            "untested": list(self.untested),
        }
