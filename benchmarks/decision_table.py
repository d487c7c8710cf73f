"""The table that decides, chosen without the people and sets it is measured on.

Every take is compared once, without the second opinion's part; then every choice of the constants
decides it again. For each set the constants are those with the fewest wrong answers on the sets of
other people, of those that keep all but `FEWER_RIGHT` of the right answers there.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from itertools import product
from typing import Final
from unittest.mock import patch

import numpy as np

from app.recognition import Language, PoseError, Recognizer
from app.recognition.decision import fused_vote, fusion, outcome
from app.recognition.decision.fusion import add_second_opinion
from app.recognition.decision.outcome import find_answer
from app.recognition.decision.result import ScoreTable
from app.recognition.voters.motion_voters import SecondOpinion
from benchmarks.sets.one_shot_draws import Draw, demonstrated, draws
from benchmarks.sets.recorded_sets import RecordedSet

FEWER_RIGHT: Final = 0.005
"""Share of right answers that a choice may lose, against the rule before it."""

BEFORE_RATIO: Final = 1.16
"""`ASK_RATIO` of the rule before it, which hears no second opinion."""

OUTCOMES: Final = ("right", "wrong", "asked", "refused")

CONSTANTS: Final = (
    (fusion, "OPINION_EXPONENT", (0.0, 0.1, 0.2, 0.3)),
    (fusion, "AGREED", (1.0, 1.1, 1.15)),
    (outcome, "ASK_RATIO", (1.12, 1.14, 1.165, 1.18)),
    (outcome, "FARTHER_EXPONENT", (0.0, 0.3)),
)
"""Owner, name and tried values."""

Choice = tuple[float, ...]
"""A value of each of the constants."""


@dataclass(frozen=True, eq=False)
class Compared:
    """A take, compared.

    Attributes
    ----------
    table
        Without the second opinion's part.
    labels, right
        The gestures of its columns, and the take's.

    """

    table: ScoreTable
    labels: tuple[str, ...]
    right: str

    def decide(self) -> tuple[str, str, bool]:
        """Return the outcome, what the second opinion says, and whether the nearest is right."""
        table = add_second_opinion(self.table, 1.0)
        opinion = table.distances[table.voters.index(SecondOpinion.name)]
        named = int(opinion.argmin()) if np.isfinite(opinion).any() else None
        found = find_answer(table.scores, table.novelty, named)
        nearest = int(table.scores.argmin())
        says = "abstains" if named is None else "agrees" if named == nearest else "differs"
        return self._name(found), says, self.labels[nearest] == self.right

    def decide_alone(self) -> tuple[str, bool]:
        """Return outcome and whether the nearest is right by the rule before.

        It hears no second opinion, and asks for no gesture beyond the limit.
        """
        scores, novelty = self.table.scores, self.table.novelty
        nearest, admitted = int(scores.argmin()), np.where(novelty > 1, np.inf, scores)
        with patch.object(outcome, "ASK_RATIO", BEFORE_RATIO):
            found = () if novelty[nearest] > 1 else find_answer(admitted, novelty)
        return self._name(found), self.labels[nearest] == self.right

    def _name(self, found: Sequence[int]) -> str:
        if len(found) != 1:
            return "asked" if len(found) == 2 else "refused"
        return "right" if self.labels[found[0]] == self.right else "wrong"


def compare(recorded: RecordedSet, chosen: Iterable[Draw]) -> Iterator[Compared]:
    """Compare the queries by others with drawn languages of all classes."""
    for draw in chosen:
        gestures = demonstrated(recorded, draw.templates)
        recognizer = Recognizer(Language(recorded.name, gestures), "full")
        for index in draw.others if len(draw.others) else draw.own:
            with (
                suppress(PoseError),
                patch.object(fused_vote, "add_second_opinion", lambda table, _: table),
            ):
                table = recognizer.compare(recognizer.query(recorded.recordings[index]))
                if np.isfinite(table.scores).any():
                    labels = recognizer.language.labels
                    yield Compared(table, tuple(labels), str(recorded.labels[index]))


def compare_all(
    sets: Iterable[RecordedSet], count: int, queries: int, seed: int
) -> dict[str, list[Compared]]:
    """Compare the takes of all sets; parameters as for `draws`."""
    return {each.name: [*compare(each, draws(each, count, queries, seed))] for each in sets}


def share(outcomes: Sequence[str], outcome: str) -> float:
    """Return the share of an outcome."""
    return outcomes.count(outcome) / max(len(outcomes), 1)


def decide_all(takes: Sequence[Compared], choice: Choice) -> list[str]:
    """Return the outcomes of takes with a choice of the constants."""
    with ExitStack() as changed:
        for (owner, name, _), value in zip(CONSTANTS, choice, strict=True):
            changed.enter_context(patch.object(owner, name, value))
        return [take.decide()[0] for take in takes]


def choose(
    names: Sequence[str],
    before: Mapping[str, Sequence[str]],
    tried: Mapping[Choice, Mapping[str, Sequence[str]]],
) -> Choice:
    """Return the choice with the fewest wrong answers on some sets; see `FEWER_RIGHT`."""

    def mean(outcomes: Mapping[str, Sequence[str]], outcome: str) -> float:
        return float(np.mean([share(outcomes[name], outcome) for name in names]))

    least = mean(before, "right") - FEWER_RIGHT
    kept = [each for each in tried if mean(tried[each], "right") >= least] or [*tried]
    return min(kept, key=lambda each: mean(tried[each], "wrong"))


def print_table(data: Mapping[str, Sequence[Compared]], groups: Sequence[set[str]]) -> None:
    """Print outcomes before and after, by what the second opinion says, and the nested choices.

    Outcomes are in the order of `OUTCOMES`, in % and in takes.

    Parameters
    ----------
    data
        Takes by set.
    groups
        Sets of the same people, which are left out together.

    """
    alone = {name: [take.decide_alone() for take in takes] for name, takes in data.items()}
    old = {name: [outcome for outcome, _ in takes] for name, takes in alone.items()}
    shipped = {name: [take.decide() for take in takes] for name, takes in data.items()}
    spoken = [name for name in data if any(said != "abstains" for _, said, _ in shipped[name])]
    tried = {
        choice: {name: decide_all(data[name], choice) for name in spoken}
        for choice in product(*(values for _, _, values in CONSTANTS))
    }
    print("| set, takes | nearest | before | shipped | agrees | differs | chosen without it |")
    for name, decided in shipped.items():
        right = [np.mean([each[-1] for each in takes]) for takes in (alone[name], decided)]
        cells = [
            f"{name}, {len(decided)}",
            " / ".join(f"{share:.1%}" for share in right),
            _list(old[name]),
            _list([each[0] for each in decided]),
        ]
        for said in ("agrees", "differs"):
            chosen = [each[0] for each in decided if each[1] == said]
            cells.append(" / ".join(str(chosen.count(outcome)) for outcome in OUTCOMES))
        left_out = next((group for group in groups if name in group), {name})
        others = [each for each in spoken if each not in left_out]
        if name in spoken and others:
            best = choose(others, old, tried)
            cells.append(f"{best}: {_list(tried[best][name])}")
        print("| " + " | ".join(cells) + " |", flush=True)
    print(f"of all {choose(spoken, old, tried)}, shipped", end=" ")
    print(tuple(getattr(owner, name) for owner, name, _ in CONSTANTS))


def _list(outcomes: Sequence[str]) -> str:
    return " / ".join(f"{100 * share(outcomes, outcome):.1f}" for outcome in OUTCOMES)
