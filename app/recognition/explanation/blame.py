"""Blame: which demonstration, cut anew, left out or shown again, repairs most known takes.

Known takes are takes whose gesture is known: of a test set, of practice, or clips with an expected
label. Every demonstration is changed, every known take is recognised again, and what the change
repairs and breaks is counted.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any, Final, Literal

import numpy as np

from app.recognition.decision.fused_vote import FusedVote
from app.recognition.decision.result import Recognition
from app.recognition.errors import OsgError
from app.recognition.explanation.causes import compare_with, full_recognizer
from app.recognition.explanation.context import KnownTake
from app.recognition.explanation.demonstration_faults import SENTENCES, FaultKind
from app.recognition.explanation.undoing import Comparison
from app.recognition.gestures.demonstration import MIN_FRAMES
from app.recognition.gestures.gesture import Gesture
from app.recognition.poses.trajectory import Trajectory
from app.recognition.recognizer import Recognizer

BlamedChange = Literal["cut", "leave_out", "show_again"]
"""What is done to a demonstration: it is cut anew, left out, or replaced by a known take."""

SHARES: Final = (0.0, 0.0625, 0.125, 0.1875, 0.25, 0.3125)
"""Shares of a demonstration's path that are cut off either end."""

FEWEST_REPAIRED: Final = 2
"""Least known takes that must fail, and be repaired: one may fail for reasons of its own."""

LEAST_FAILING: Final = 0.6
"""Least share of a gesture's known takes that fail, from which its demonstrations are judged."""

FEWEST_TAKES: Final = 3
"""Least known takes of a gesture: of two nobody can tell which one is unlike the others."""

MOST_TAKES: Final = 8
"""Most known takes of a gesture that are compared with each other."""

FAR: Final = 0.8
"""Least median novelty of a gesture's takes for a demonstration at fault; chosen, as the next two,
by `benchmarks.accuracy.known_faults` on sets other than those that are reported."""

UNLIKE: Final = 1.8
"""How many times as far as from each other the takes are from it, where the change repairs
`FEWEST_REPAIRED` takes more than it breaks."""

CLEARLY_UNLIKE: Final = 2.4
"""The same whatever the change repairs: another take in its place may have faults of its own."""

FAR_IN_ANY_CASE: Final = 3.5
"""The same where the median novelty is below `FAR`."""


@dataclass(frozen=True, kw_only=True)
class Blame:
    """A demonstration at fault, with the change that repairs most known takes.

    Attributes
    ----------
    label, demonstration
        The gesture, and which of its demonstrations, counted from 0.
    change
        See `BlamedChange`.
    start, end
        Seconds of the demonstration's own clock that a cut keeps; None for other changes.
    takes
        Number of known takes.
    failing
        How many takes of the gesture are not read as it.
    repaired, broken
        How many known takes are read right with the change only, and without it only.
    unlike
        How many times as far as from each other the takes of the gesture are from it.

    """

    label: str
    demonstration: int
    change: BlamedChange
    start: float | None = None
    end: float | None = None
    takes: int
    failing: int
    repaired: int
    broken: int
    unlike: float

    @property
    def sentence(self) -> str:
        """The fault and the remedy, at most fifteen words."""
        of = f"The demonstration of {self.label!r}"
        match self.change:
            case "cut":
                return f"{of} {SENTENCES[FaultKind.reaches_salute]}. Set its range."
            case "leave_out":
                return f"{of} is unlike its other ones. Leave it out."
            case _:
                return f"{of} {SENTENCES[FaultKind.unlike_takes]}. Show it again."

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON types."""
        return {**vars(self), "sentence": self.sentence}


def find_blame(
    recognizer: Recognizer, takes: Sequence[KnownTake], labels: Sequence[str] | None = None
) -> tuple[Blame, ...]:
    """Find the demonstrations that are at fault for known takes, the one most unlike them first.

    A demonstration is at fault if most takes of its gesture fail and are clearly farther from it
    than from each other. Cutting it anew is preferred where that repairs most of them and breaks
    none; otherwise it is left out, or should be shown again.

    Parameters
    ----------
    recognizer
        Of the language.
    takes
        The known takes; those whose label the language lacks are ignored.
    labels
        The gestures whose demonstrations are judged; all when not given.

    Returns
    -------
    At most one change a demonstration; empty where no demonstration is at fault.

    """
    recognizer = full_recognizer(recognizer)
    known = [take for take in takes if take.label in recognizer.language.labels]
    if not known:
        return ()
    before = read_all(recognizer, known)
    found: list[Blame] = []
    for gesture in recognizer.language.gestures:
        if labels is not None and gesture.label not in labels:
            continue
        own = [index for index, take in enumerate(known) if take.label == gesture.label]
        failing = sum(before[index] != gesture.label for index in own)
        if len(own) < FEWEST_TAKES or failing < max(FEWEST_REPAIRED, LEAST_FAILING * len(own)):
            continue
        tested = _Tested(recognizer, known, before, own[:MOST_TAKES], failing)
        for number, shown in enumerate(gesture.single_demonstrations()):
            if shown.trajectory is not None and not shown.is_held:
                found += tested.judge(gesture, number)
    return tuple(sorted(found, key=lambda each: -each.unlike))


@dataclass(frozen=True, eq=False)
class _Tested:
    """Known takes, how they are read, and those of the gesture in question.

    Attributes
    ----------
    recognizer
        Of the language.
    known, before
        All takes, and what each is read as.
    takes
        Indices of the takes of the gesture.
    failing
        How many takes of the gesture are not read as it.

    """

    recognizer: Recognizer
    known: Sequence[KnownTake]
    before: Sequence[str | None]
    takes: Sequence[int]
    failing: int

    def judge(self, gesture: Gesture, number: int) -> Iterator[Blame]:
        """Yield the blame of one demonstration of the gesture, if it is at fault."""
        takes = [self.known[index] for index in self.takes]
        shown = gesture.single_demonstrations()[number]
        medoid, own, among = _compare_takes(self.recognizer, shown, takes)
        unlike = own / max(among, 1e-9)
        if unlike < UNLIKE:
            return
        changes = _list_changes(self.recognizer, gesture, number, takes, medoid)
        for change, changed, span in changes:
            left_out = self.takes[medoid] if change == "show_again" else None
            repaired, broken = _judge(self.recognizer, changed, self.known, self.before, left_out)
            blamed = _is_far(own, unlike, repaired - broken)
            if change == "cut":
                blamed = not broken and repaired >= max(FEWEST_REPAIRED, self.failing / 2)
            if blamed:
                yield Blame(
                    label=gesture.label,
                    demonstration=number,
                    change=change,
                    start=None if span is None else span[0],
                    end=None if span is None else span[1],
                    takes=len(self.known),
                    failing=self.failing,
                    repaired=repaired,
                    broken=broken,
                    unlike=unlike,
                )
                return


def _is_far(own: float, unlike: float, gained: int) -> bool:
    """Return whether a demonstration is far enough from the takes to be at fault."""
    if own < FAR:
        return unlike >= FAR_IN_ANY_CASE
    return unlike >= CLEARLY_UNLIKE or gained >= FEWEST_REPAIRED


def read_all(recognizer: Recognizer, takes: Sequence[KnownTake]) -> list[str | None]:
    """Return the label that each take is read as; None where it is not read as one gesture."""
    found: list[str | None] = []
    for take in takes:
        result = _recognize(recognizer, take.query)
        found.append(None if result is None else result.label)
    return found


def _recognize(recognizer: Recognizer, query: Trajectory) -> Recognition | None:
    try:
        return recognizer.recognize_trajectory(query)
    except OsgError:
        return None


def _list_changes(
    recognizer: Recognizer,
    gesture: Gesture,
    number: int,
    takes: Sequence[KnownTake],
    medoid: int,
) -> Iterator[tuple[BlamedChange, Gesture, tuple[float, float] | None]]:
    """Yield the changes of one demonstration, the gesture after each, and the seconds it keeps."""
    shown = gesture.single_demonstrations()[number]
    at = recognizer.language.labels.index(gesture.label)
    comparisons = [
        each
        for take in takes
        if (each := compare_with(recognizer, take.query, recognizer.compare(take.query), at))
    ]
    if comparisons and (cut := _find_best_cut(comparisons)) is not None:
        span = comparisons[0].locate_cut(cut)
        with suppress(OsgError):
            yield "cut", gesture.with_cut(number, *span), span
    if gesture.further:
        yield "leave_out", gesture.without_demonstration(number), None
    elif (made := _show_again(shown, takes[medoid].query)) is not None:
        yield "show_again", made, None


def _find_best_cut(comparisons: Sequence[Comparison]) -> tuple[float, float] | None:
    """Return the cut with which most takes are within the limit; None if none helps."""
    whole = np.array([each.base for each in comparisons])
    best, chosen = float(np.median(whole)), None
    for start in SHARES:
        for end in SHARES:
            after = np.array([each.measure_cut((start, end)) for each in comparisons])
            # A twentieth a step, so that of cuts that help as much the smaller one is chosen.
            typical = float(np.median(after)) * (1 + 0.5 * (start + end))
            if (start or end) and typical < best:
                best, chosen = typical, (start, end)
    return chosen


def _compare_takes(
    recognizer: Recognizer, shown: Gesture, takes: Sequence[KnownTake]
) -> tuple[int, float, float]:
    """Compare takes of a gesture with its demonstration and with each other.

    Returns
    -------
    The take that is nearest to the others, the median novelty of all for the demonstration, and
    that of the others for this take.

    """
    made = [_show_again(shown, take.query) for take in takes]
    own = [_measure(recognizer, take.query, shown) for take in takes]
    typical = []
    for column, other in enumerate(made):
        apart = [
            np.inf if other is None else _measure(recognizer, take.query, other)
            for row, take in enumerate(takes)
            if row != column
        ]
        typical.append(float(np.median(apart)))
    medoid = int(np.argmin(typical))
    return medoid, float(np.median(own)), typical[medoid]


def _measure(recognizer: Recognizer, query: Trajectory, shown: Gesture) -> float:
    """Return the novelty of a take for a demonstration as it was shown."""
    assert isinstance(recognizer.vote, FusedVote)
    return Comparison(recognizer.vote, query, shown, None).base


def _show_again(shown: Gesture, take: Trajectory) -> Gesture | None:
    """Return the gesture with a take in place of its demonstration; None if it cannot be."""
    assert shown.trajectory is not None
    names = [name for name in shown.trajectory.landmarks if name in take.landmarks]
    if not {*shown.salient} <= {*names} or len(take) < MIN_FRAMES:
        return None
    hands = shown.trajectory.moving_hands
    trajectory = replace(take.select(names), hands=(), then_hands=(), moving_hands=hands)
    return replace(shown, trajectory=trajectory).redraw()


def _judge(
    recognizer: Recognizer,
    changed: Gesture,
    known: Sequence[KnownTake],
    before: Sequence[str | None],
    left_out: int | None,
) -> tuple[int, int]:
    """Return how many known takes a changed gesture repairs and breaks."""
    language = recognizer.language.with_changed(changed)
    try:
        after = read_all(Recognizer(language, "full", tuning=recognizer.tuning), known)
    except OsgError:
        return 0, len(known)
    repaired = broken = 0
    for index, take in enumerate(known):
        if index != left_out:
            was, is_now = before[index] == take.label, after[index] == take.label
            repaired += is_now and not was
            broken += was and not is_now
    return repaired, broken
