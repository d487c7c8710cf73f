"""Remedies: edits that reduce the confusion of two gestures, with their simulated effect.

Every edit is first tried on the two gestures alone, with few takes; the best ones are then
simulated within the whole language, and proposed only if they help there.
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
"""Takes of each of the two gestures with which an edit is first tried: enough to rank edits whose
effects differ by the margins' spread or more."""

MOST_PROPOSED = 4
"""Edits simulated within the whole language, each of another kind: a short choice, because the most
effective one (mostly the other hand) may not suit the diver."""

HELPS = 0.5
"""Largest ratio of the rates after and before a proposed remedy; smaller effects are within the
estimates' intervals."""


@dataclass(frozen=True)
class Remedy:
    """One edit to make, with its simulated effect.

    Attributes
    ----------
    kind
        For programs, see `GestureEdit`.
    gesture
        Label of the gesture to edit.
    text
        What to do, as an imperative.
    before, after
        The predicted rate of confusion without and with it.

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
    """Runs simulated trials with the same settings for a language and for its edited versions.

    Attributes
    ----------
    takes
        Of each gesture, at least 2.
    seed
        Seed of their variants.
    person
        Who performs.
    advance
        Called after each take; an exception that it raises ends the trials.

    """

    takes: int
    seed: int
    person: Person
    advance: Callable[[], None] = lambda: None

    def __call__(
        self, recognizer: Recognizer, gestures: tuple[int, ...] | None = None, takes: int = 0
    ) -> SimulatedTrials:
        """Simulate trials of gestures by their indices; all when not given."""
        return simulate_trials(
            recognizer,
            takes or self.takes,
            gestures=gestures,
            seed=self.seed,
            person=self.person,
            advance=self.advance,
        )


def is_worse(one: RateEstimate, other: RateEstimate) -> RateEstimate:
    """Return the estimate with the higher rate."""
    return max(one, other, key=lambda each: (each.rate, each.high))


def find_pair_remedies(
    language: Language,
    pair: tuple[int, int],
    before: SimulatedTrials,
    run_trials: TrialRunner,
    strokes: Sequence[tuple[float, float] | None] = (None, None),
) -> tuple[Remedy, ...]:
    """Find edits that reduce the confusion of two gestures, the most effective first.

    Parameters
    ----------
    language
        The language before any edit.
    pair
        Indices of two gestures with demonstrations.
    before
        The trials of the whole language.
    run_trials
        The settings that `before` was made with.
    strokes
        Seconds in which each of the two differs from the other one, if known.

    """
    two = [language.gestures[index] for index in pair]
    performers = [before.gestures.tolist().index(index) for index in pair]
    confused = _confusion_between(before, performers, pair)
    assert confused is not None  # the caller's finding is about this pair
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
        # A gesture that is no longer a neighbour is not confused.
        after = _confusion_between(repeated, (0, 1), pair) or RateEstimate(0.0, 0.0, 0.0)
        missed_then = repeated.missed(0).rate + repeated.missed(1).rate
        if after.rate <= HELPS * confused.rate and missed_then < missed:
            proposed.append(Remedy(edit.kind, edit.label, edit.text, confused, after))
    return tuple(sorted(proposed, key=lambda remedy: (remedy.after.rate, remedy.after.high)))


def _apply_edits(
    two: list[Gesture],
    strokes: Sequence[tuple[float, float] | None],
) -> Iterator[tuple[GestureEdit, list[Gesture]]]:
    """Yield every edit that applies to either of the two, with the edited gestures."""
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
    trials = run_trials(Recognizer(language, "full"), takes=TRIAL_TAKES)
    confused = _confusion_between(trials, (0, 1), (0, 1))
    assert confused is not None  # in a language of two, both are rivals
    return confused


def _confusion_between(
    trials: SimulatedTrials, performers: Sequence[int], pair: tuple[int, int]
) -> RateEstimate | None:
    """Return the worse estimate of two gestures' confusion; None where neither is a rival."""
    forth = trials.confusion(performers[0], pair[1])
    back = trials.confusion(performers[1], pair[0])
    return is_worse(forth, back) if forth and back else forth or back


def _with(language: Language, indices: tuple[int, ...], changed: list[Gesture]) -> Language:
    gestures = list(language.gestures)
    for index, gesture in zip(indices, changed, strict=True):
        gestures[index] = gesture
    return replace(language, gestures=gestures)
