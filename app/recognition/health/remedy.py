"""Remedies: what would keep two gestures apart, each with its effect computed.

Every change is first tried on the two gestures by themselves, with few takes; the most promising
ones are then rehearsed within the whole language, and proposed only where they help there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from app.recognition.gestures.gesture import Gesture
from app.recognition.health.edits import GestureEdit, list_edits, list_switch_edits
from app.recognition.health.simulated_trials import SimulatedTrials, simulate_trials
from app.recognition.language.language import Language
from app.recognition.recognizer import Recognizer
from app.recognition.simulation.rate_estimate import RateEstimate
from app.recognition.simulation.variation import Person

TRIAL_TAKES = 5
"""Takes of each of the two gestures with which a change is tried: enough to order changes whose
effects differ by a spread of the margins or more."""

MOST_PROPOSED = 4
"""Changes rehearsed within the whole language, each of another kind: a choice that can be surveyed,
for the most effective one (mostly the other hand) may not suit the diver."""

HELPS = 0.5
"""A remedy is proposed where it at least halves what it is against: smaller effects are within the
forecasts' intervals."""


@dataclass(frozen=True)
class Remedy:
    """One thing to do, and what it was computed to achieve.

    Attributes
    ----------
    kind
        For programs, see `GestureEdit`.
    gesture
        Label of the gesture to show or to read otherwise.
    text
        What to do, as an imperative.
    before, after
        The predicted rate that it is against, without and with it.

    """

    kind: str
    gesture: str
    text: str
    before: RateEstimate
    after: RateEstimate

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON types."""
        forecasts = {"before": self.before.to_dict(), "after": self.after.to_dict()}
        return vars(self) | forecasts


@dataclass(frozen=True, kw_only=True)
class TrialRunner:
    """How takes are rehearsed; the same for a language and for its changed versions.

    Attributes
    ----------
    takes
        Of each gesture, at least 2.
    seed
        Of their variants.
    person
        Who performs.
    advance
        Called after each take; what it raises ends everything.

    """

    takes: int
    seed: int
    person: Person
    advance: Callable[[], None] = lambda: None

    def __call__(
        self, recognizer: Recognizer, gestures: tuple[int, ...] | None = None, takes: int = 0
    ) -> SimulatedTrials:
        """Rehearse gestures by their indices; all when not given."""
        return simulate_trials(
            recognizer,
            takes or self.takes,
            gestures=gestures,
            seed=self.seed,
            person=self.person,
            advance=self.advance,
        )


def is_worse(one: RateEstimate, other: RateEstimate) -> RateEstimate:
    """Return the forecast with the higher rate."""
    return max(one, other, key=lambda each: (each.rate, each.high))


def find_pair_remedies(
    language: Language,
    pair: tuple[int, int],
    before: SimulatedTrials,
    run_trials: TrialRunner,
    strokes: Sequence[tuple[float, float] | None] = (None, None),
) -> tuple[Remedy, ...]:
    """Find what keeps two gestures apart, the most effective first.

    Parameters
    ----------
    language
        As it is.
    pair
        Indices of two gestures with demonstrations.
    before
        The trials of the whole language.
    run_trials
        How it was made.
    strokes
        Seconds in which each of the two differs from the other one, where that is known.

    """
    two = [language.gestures[index] for index in pair]
    performers = [before.gestures.tolist().index(index) for index in pair]
    confused = is_worse(
        before.confusion(performers[0], pair[1]), before.confusion(performers[1], pair[0])
    )
    missed = sum(before.missed(performer).rate for performer in performers)
    tried = [
        (_try_edit(changed, run_trials), edit, changed)
        for edit, changed in _apply_edits(two, strokes)
    ]
    tried.sort(key=lambda trial: (trial[0].rate, trial[0].high))
    best_of_kind = {edit.kind: (edit, changed) for _, edit, changed in reversed(tried)}
    kinds = list(dict.fromkeys(edit.kind for _, edit, _ in tried))
    proposed = []
    for edit, changed in [best_of_kind[kind] for kind in kinds[:MOST_PROPOSED]]:
        repeated = run_trials(Recognizer(_with(language, pair, changed), "full"), pair)
        after = is_worse(repeated.confusion(0, pair[1]), repeated.confusion(1, pair[0]))
        missed_then = repeated.missed(0).rate + repeated.missed(1).rate
        if after.rate <= HELPS * confused.rate and missed_then < missed:
            proposed.append(Remedy(edit.kind, edit.label, edit.text, confused, after))
    return tuple(sorted(proposed, key=lambda remedy: (remedy.after.rate, remedy.after.high)))


def _apply_edits(
    two: list[Gesture],
    strokes: Sequence[tuple[float, float] | None],
) -> Iterator[tuple[GestureEdit, list[Gesture]]]:
    """Apply every change that applies to either of the two."""
    changes = [(0, change) for change in list_switch_edits(*two)]
    for which, stroke in enumerate(strokes):
        changes += [(which, change) for change in list_edits(two[which], stroke=stroke)]
    for which, change in changes:
        changed, other = change.apply(two[which]), two[1 - which]
        if changed is not None:
            other = (change.both(other) if change.both else other) or other
            yield change, [changed, other] if which == 0 else [other, changed]


def _try_edit(two: list[Gesture], run_trials: TrialRunner) -> RateEstimate:
    language = Language("two", two)
    # Only scores are compared: thresholds are not made for a language that nobody will speak.
    uncalibrated = replace(language, thresholds_for=language.fingerprint)
    trials = run_trials(Recognizer(uncalibrated, "full"), takes=TRIAL_TAKES)
    return is_worse(trials.confusion(0, 1), trials.confusion(1, 0))


def _with(language: Language, indices: tuple[int, ...], changed: list[Gesture]) -> Language:
    gestures = list(language.gestures)
    for index, gesture in zip(indices, changed, strict=True):
        gestures[index] = gesture
    return replace(language, gestures=gestures)
