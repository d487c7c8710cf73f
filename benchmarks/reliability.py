"""How far the confidence of profile ``full`` can be believed, and what it rejects.

Of each recorded set a random half of the classes makes a language, one template each by one
person; queries come from all classes, so that about half of them mean no gesture of the language.
They come from the same person (UD), and where people are known also from everybody else (UI).
Foreign movements accepted are told twice: with the bar that refuses 5 % of this set's true
gestures, and with the thresholds that the language was calibrated to.

    python -m benchmarks.reliability ../shared/data
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from app.recognition import Language, PoseError, Recognizer
from benchmarks.recorded_sets import RecordedSet, recorded_sets
from benchmarks.shared_sets import demonstrated

BINS = (0.0, 0.2, 0.4, 0.6, 0.8, 0.9, 1.0001)
REFUSED = 5.0
"""Per cent of true gestures refused where false acceptance is reported."""


@dataclass(frozen=True)
class Answer:
    """One query's outcome.

    Attributes
    ----------
    confidence, novelty
        Of the nearest gesture.
    known
        Whether the query's gesture was in the language.
    correct
        Whether it was the nearest one.
    refused
        Whether it was read as no gesture.

    """

    confidence: float
    novelty: float
    known: bool
    correct: bool
    refused: bool


def answers(
    recorded: RecordedSet, draws: int, queries: int, seed: int, *, same_person: bool
) -> Iterator[Answer]:
    """Ask the person of the templates, or everybody else."""
    random = np.random.default_rng(seed)
    classes = np.unique(recorded.labels)
    for _ in range(draws):
        chosen = random.permutation(classes)[: len(classes) // 2 + 1]
        own = recorded.people == random.choice(np.unique(recorded.people))
        templates = [
            int(random.choice(np.flatnonzero(own & (recorded.labels == label)))) for label in chosen
        ]
        language = Language(recorded.name, demonstrated(recorded, templates))
        recognizer = Recognizer(language, "full")
        pool = np.setdiff1d(np.flatnonzero(own == same_person), templates)
        for query in random.choice(pool, min(queries, len(pool)), replace=False):
            label = str(recorded.labels[query])
            try:
                result = recognizer.recognize(recorded.recordings[query])
            except PoseError:
                continue
            yield Answer(
                confidence=result.confidence,
                novelty=float(result.novelty[result.gestures.index(result.nearest)]),
                known=label in language.labels,
                correct=result.nearest == label,
                refused=result.label is None,
            )


def accepted_at_bar(asked: list[Answer]) -> float:
    """Share of the foreign movements as little novel as all but `REFUSED` % of the true ones."""
    bar = np.percentile([answer.novelty for answer in asked if answer.known], 100 - REFUSED)
    return float(np.mean([answer.novelty <= bar for answer in asked if not answer.known]))


def report(name: str, asked: list[Answer]) -> None:
    """Print what is refused and what is accepted."""
    known = [answer for answer in asked if answer.known]
    foreign = [answer for answer in asked if not answer.known]
    refused = np.mean([answer.refused for answer in known])
    passed = np.mean([not answer.refused for answer in foreign])
    print(
        f"{name}: {accepted_at_bar(asked):.1%} accepted at {REFUSED:g} % refused; as calibrated "
        f"{refused:.1%} of {len(known)} refused, {passed:.1%} of {len(foreign)} accepted",
        flush=True,
    )


def main() -> None:
    """Print the reliability table, and false acceptance per set."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("data", type=Path, help="the folder that holds trajectories/")
    parser.add_argument("--draws", type=int, default=40, help="languages per set")
    parser.add_argument("--queries", type=int, default=30, help="queries per language")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    everything: list[Answer] = []
    for recorded in recorded_sets(given.data / "trajectories"):
        alone = len(np.unique(recorded.people)) == 1
        for same_person in (True,) if alone else (True, False):
            asked = [
                *answers(recorded, given.draws, given.queries, given.seed, same_person=same_person)
            ]
            report(f"{recorded.name} {'UD' if same_person else 'UI'}", asked)
            everything += asked
    print("confidence, queries, mean confidence, share correct")
    for low, high in pairwise(BINS):
        inside = [answer for answer in everything if low <= answer.confidence < high]
        if inside:
            mean = np.mean([answer.confidence for answer in inside])
            correct = np.mean([answer.correct for answer in inside])
            print(f"{low:.1f} to {min(high, 1):.1f}: {len(inside)}, {mean:.2f}, {correct:.2f}")


if __name__ == "__main__":
    main()
