"""Blame: which demonstration, cut anew, left out or shown again, repairs most known takes.

Known takes are takes whose gesture is known: of a test set, of practice, or clips with an expected
label. Every demonstration is changed, every known take is recognised again, and what the change
repairs and breaks is counted.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np
from pydantic import computed_field

from app.recognition.decision.fused_vote import FusedVote
from app.recognition.decision.result import WRITTEN
from app.recognition.errors import OsgError
from app.recognition.explanation.context import KnownTake, KnownTakes
from app.recognition.explanation.demonstration_faults import FaultKind
from app.recognition.explanation.strokes import transcribe_gesture
from app.recognition.explanation.transcript import are_alike, compare_transcripts
from app.recognition.explanation.undoing import (
    Comparison,
    compare_with,
    find_better_range,
)
from app.recognition.gestures.demonstration import MIN_FRAMES
from app.recognition.gestures.gesture import Gesture
from app.recognition.poses.trajectory import Trajectory
from app.recognition.recognizer import Recognizer

BlamedChange = Literal["cut", "leave_out", "show_again"]
"""What is done to a demonstration: it is cut anew, left out, or replaced by a known take."""

FEWEST_FAILING: Final = 2
"""Least known takes of a gesture that must fail: one may fail for reasons of its own."""

LEAST_FAILING: Final = 0.5
"""Least share of a gesture's known takes that fail, from which its demonstrations are judged."""

FEWEST_TAKES: Final = 3
"""Least known takes of a gesture: of two nobody can tell which one is unlike the others."""

MOST_COMPARED_TAKES: Final = 8
"""Most known takes of a gesture that are compared with each other."""

MOST_AGREE: Final = 2 / 3
"""Least share of a gesture's known takes whose strokes agree, at least two takes, that show which
strokes the gesture has. With half, one demonstration of 30 is blamed that no reader blames."""

WEIGHT_OF_FAILING: Final = 0.75
"""Weight of `Evidence.failing`; chosen, as the next two, by `benchmarks.accuracy.explanations`,
which leaves sets out."""

WEIGHT_OF_GAIN: Final = 0.4
"""Weight of `Evidence.gain`."""

LEAST_EVIDENCE: Final = 1.25
"""Least evidence against a demonstration at fault."""

MOST_GAIN: Final = 2.0
"""Largest `Evidence.gain`: a change may also repair takes of other gestures."""


@dataclass(frozen=True, kw_only=True)
class Evidence:
    """Evidence against a demonstration, by the known takes of its gesture.

    Attributes
    ----------
    unlike
        How many times as far as from each other they are from it.
    failing
        Share of them that fail.
    gain
        Known takes that a change repairs more than it breaks, over those of the gesture.

    """

    unlike: float
    failing: float
    gain: float

    def weigh(self, failing: float = WEIGHT_OF_FAILING, gain: float = WEIGHT_OF_GAIN) -> float:
        """Return the sum of all three, with the weights of the latter two."""
        of_gain = gain * min(self.gain, MOST_GAIN)
        return math.log(max(self.unlike, 1e-9)) + failing * self.failing + of_gain


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
    evidence
        Against the demonstration.
    odd
        How its strokes differ from those in which the takes agree, as a sentence; empty: they do
        not.

    """

    __pydantic_config__ = WRITTEN

    label: str
    demonstration: int
    change: BlamedChange
    start: float | None = None
    end: float | None = None
    takes: int
    failing: int
    repaired: int
    broken: int
    evidence: Evidence
    odd: str = ""

    @computed_field  # type: ignore[prop-decorator]
    @property
    def sentence(self) -> str:
        """The fault and the remedy, at most fifteen words."""
        of = f"The demonstration of {self.label!r}"
        match self.change:
            case "cut":
                return f"{of} {FaultKind.reaches_salute.told}. Set its range."
            case "leave_out":
                return f"{of} is unlike its other ones. Leave it out."
            case _ if self.odd:
                return self.odd
            case _:
                effect = f"a take in its place repairs {self.repaired}, breaks {self.broken}"
                return f"Show the demonstration of {self.label!r} again: {effect}."


def find_blame(
    known: KnownTakes, labels: Sequence[str] | None = None, least: float = LEAST_EVIDENCE
) -> tuple[Blame, ...]:
    """Find the demonstrations that are at fault for known takes, the surest one first.

    A demonstration is at fault if takes of its gesture fail, are farther from it than from each
    other, and are repaired by a take in its place. Cutting it anew is preferred where that repairs
    most of them and breaks none; otherwise it is left out, or should be shown again.

    Parameters
    ----------
    known
        The known takes, and their recogniser of profile ``full``.
    labels
        The gestures whose demonstrations are judged; all when not given.
    least
        Least evidence against a demonstration, see `Evidence.weigh`.

    Returns
    -------
    At most one change a demonstration; empty where no demonstration is at fault.

    """
    gestures = known.recognizer.language.gestures if known.takes else ()
    found = [
        each
        for gesture in gestures
        if labels is None or gesture.label in labels
        for each in _judge_gesture(known, gesture, least, asked=labels is not None)
        if each.odd or each.evidence.weigh() >= least
    ]
    return tuple(sorted(found, key=lambda each: -each.evidence.weigh()))


def _judge_gesture(
    known: KnownTakes, gesture: Gesture, least: float, *, asked: bool
) -> Iterator[Blame]:
    """Yield the blame of a gesture's demonstrations; `asked`: also where its takes are read."""
    own = [index for index, take in enumerate(known.takes) if take.label == gesture.label]
    failing = sum(known.readings[index] != gesture.label for index in own)
    fails = failing >= max(FEWEST_FAILING, LEAST_FAILING * len(own))
    for number, shown in enumerate(gesture.single_demonstrations()):
        if shown.trajectory is None or shown.is_held:
            continue
        # Several demonstrations show several ways; takes that are read need none of these.
        alone = not gesture.further and (failing or asked)
        odd = _describe_odd(shown, [known.takes[index] for index in own]) if alone else ""
        if odd or (fails and len(own) >= FEWEST_TAKES):
            limit = -math.inf if odd else least
            judged = _judge_demonstration(known, gesture, number, own, failing, limit)
            yield from (replace(each, odd=odd) for each in judged)


def _describe_odd(shown: Gesture, takes: Sequence[KnownTake]) -> str:
    """Return how a demonstration differs from takes that agree with each other; empty: it may not.

    `MOST_AGREE` of the takes agree, and none of these with the demonstration, stroke by stroke.
    """
    told = [take.strokes for take in takes if take.strokes]
    groups = [[each for each in told if are_alike(each, first)] for first in told]
    most, own = max(groups, key=len, default=[]), transcribe_gesture(shown)
    if len(most) < max(2, MOST_AGREE * len(takes)) or not own:
        return ""
    if any(are_alike(each, own) for each in most):
        return ""
    of, some = f"Your demonstration of {shown.label!r}", f"{len(most)} of {len(takes)} takes"
    if len(own) != len(most[0]):
        strokes = "one stroke" if len(own) == 1 else f"{len(own)} strokes"
        return f"{of} has {strokes}; {some} have {len(most[0])}."
    at = compare_transcripts(own, most[0]).differs or 0
    return f"{of}: {own[at].words}, where {some} have: {most[0][at].words}."


def _judge_demonstration(
    known: KnownTakes, gesture: Gesture, number: int, own: list[int], failing: int, least: float
) -> Iterator[Blame]:
    """Yield the blame of one demonstration of a gesture, if there may be evidence enough.

    `own` are the indices of the gesture's takes, of which `failing` fail.
    """
    takes = [known.takes[index] for index in own[:MOST_COMPARED_TAKES]]
    shown = gesture.single_demonstrations()[number]
    medoid, apart, among = _compare_takes(known.recognizer, shown, takes)
    evidence = Evidence(unlike=apart / max(among, 1e-9), failing=failing / len(own), gain=MOST_GAIN)
    if evidence.weigh() < least:
        return
    tried, gains = list[Blame](), list[float]()
    for change, changed, (start, end) in _list_changes(
        known.recognizer, gesture, number, takes, medoid
    ):
        left_out = own[medoid] if change == "show_again" else None
        language = known.recognizer.language.with_changed(changed)
        after = Recognizer(language, "full", tuning=known.recognizer.tuning)
        gone = (gesture.label, number) if change == "leave_out" else None
        repaired, broken = (
            sum(index != left_out for index in rows) for rows in known.try_change(after, gone)
        )
        gains.append((repaired - broken) / (len(own) - (left_out is not None)))
        tried.append(
            Blame(
                label=gesture.label,
                demonstration=number,
                change=change,
                start=start,
                end=end,
                takes=len(known.takes),
                failing=failing,
                repaired=repaired,
                broken=broken,
                evidence=evidence,
            )
        )
    if tried:
        first = tried[0]
        half = max(FEWEST_FAILING, failing / 2)
        chosen = first if not first.broken and first.repaired >= half else tried[-1]
        yield replace(chosen, evidence=replace(evidence, gain=max(gains)))


def _list_changes(
    recognizer: Recognizer,
    gesture: Gesture,
    number: int,
    takes: Sequence[KnownTake],
    medoid: int,
) -> Iterator[tuple[BlamedChange, Gesture, tuple[float | None, float | None]]]:
    """Yield the changes of one demonstration, the gesture after each, and the seconds it keeps.

    A cut comes first, if any helps.
    """
    shown = gesture.single_demonstrations()[number]
    at = recognizer.language.labels.index(gesture.label)
    comparisons = [
        each
        for take in takes
        if (each := compare_with(recognizer, take.query, recognizer.compare(take.query), at))
    ]
    if comparisons and (span := find_better_range(comparisons)):
        with suppress(OsgError):
            yield "cut", gesture.with_cut(number, *span), span
    if gesture.further:
        yield "leave_out", gesture.without_demonstration(number), (None, None)
    elif (made := _show_again(shown, takes[medoid].query)) is not None:
        yield "show_again", made, (None, None)


def _compare_takes(
    recognizer: Recognizer, shown: Gesture, takes: Sequence[KnownTake]
) -> tuple[int, float, float]:
    """Compare takes of a gesture with its demonstration and with each other.

    Returns
    -------
    The take that is nearest to the others, the median novelty of all for the demonstration, and
    that of the others for this take.

    """
    vote = recognizer.vote
    assert isinstance(vote, FusedVote)
    asked = [Comparison(vote, take.query, shown, None) for take in takes]
    made = [_show_again(shown, take.query) for take in takes]
    apart = np.full((len(takes), len(takes)), np.inf)
    for column, other in enumerate(made):
        if other is not None:
            movements = Comparison(vote, takes[column].query, other, None).shown
            apart[:, column] = [each.measure(each.query, movements) for each in asked]
    rows = ~np.eye(len(takes), dtype=bool)
    typical = [float(np.median(apart[rows[column], column])) for column in range(len(takes))]
    medoid = int(np.argmin(typical))
    return medoid, float(np.median([each.base for each in asked])), typical[medoid]


def _show_again(shown: Gesture, take: Trajectory) -> Gesture | None:
    """Return the gesture with a take in place of its demonstration; None if it cannot be."""
    assert shown.trajectory is not None
    names = [name for name in shown.trajectory.landmarks if name in take.landmarks]
    if not {*shown.salient} <= {*names} or len(take) < MIN_FRAMES:
        return None
    hands = shown.trajectory.moving_hands
    trajectory = replace(take.select(names), hands=(), then_hands=(), moving_hands=hands)
    return replace(shown, trajectory=trajectory).redraw()
