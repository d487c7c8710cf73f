"""Accuracy on other people's recorded trajectories and on drawn ones, one template a class.

Per draw, one template of each class comes from one person, and queries from the same person
(UD, user-dependent) or from everyone else (UI, user-independent), through the public interface:
`Gesture.from_demonstration` and `Recognizer.recognize`. Where a set does not tell its people apart,
everything is in the first column, whoever it comes from. Draws are random with a fixed seed, the
same for every method; the interval is Wilson's.

    python -m benchmarks.shared_sets ../shared/data --methods paper dtw full
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from itertools import chain
from math import sqrt
from pathlib import Path

import numpy as np

from app.recognition import (
    Gesture,
    GestureError,
    Language,
    PoseError,
    PoseSequence,
    Recognizer,
)
from app.recognition.recognizer import PROFILES
from benchmarks.drawn_sets import drawn_sets
from benchmarks.plain_warping import PlainWarping
from benchmarks.recorded_sets import RecordedSet, recorded_sets

Answer = Callable[[PoseSequence], str | None]


@dataclass(frozen=True)
class Score:
    """Correct answers out of all queries."""

    correct: int
    queries: int

    def __str__(self) -> str:
        if not self.queries:
            return "     -          "
        share, n, z = self.correct / self.queries, self.queries, 1.96
        middle = (share + z * z / (2 * n)) / (1 + z * z / n)
        half = z * sqrt(share * (1 - share) / n + z * z / (4 * n * n)) / (1 + z * z / n)
        return f"{share:6.1%} ({middle - half:.0%}-{middle + half:.0%})"


def evaluate(
    recorded: RecordedSet, method: str, draws: int, queries: int, seed: int
) -> tuple[Score, Score]:
    """Score a method, user-dependent and user-independent."""
    generator = np.random.default_rng(seed)
    correct, asked = [0, 0], [0, 0]
    for _ in range(draws):
        person = generator.choice(np.unique(recorded.people))
        own = recorded.people == person
        templates = [
            int(generator.choice(np.flatnonzero(own & (recorded.labels == label))))
            for label in np.unique(recorded.labels)
        ]
        answer = answerer(recorded, templates, method)
        rest = np.setdiff1d(np.flatnonzero(own), templates)
        for kind, pool in enumerate((rest, np.flatnonzero(~own))):
            for query in generator.choice(pool, min(queries, len(pool)), replace=False):
                asked[kind] += 1
                correct[kind] += answer(recorded.recordings[query]) == recorded.labels[query]
    return Score(correct[0], asked[0]), Score(correct[1], asked[1])


def answerer(recorded: RecordedSet, templates: list[int], method: str) -> Answer:
    """Teach a method one template a class."""
    if method == "dtw":
        demonstrations = [recorded.recordings[template] for template in templates]
        return PlainWarping(demonstrations, recorded.labels[templates].tolist()).answer
    recognizer = Recognizer(Language(recorded.name, demonstrated(recorded, templates)), method)

    def answer(poses: PoseSequence) -> str | None:
        try:
            return recognizer.recognize(poses).label
        except PoseError:
            return None

    return answer


def demonstrated(recorded: RecordedSet, templates: list[int]) -> list[Gesture]:
    """Make a gesture of each template."""
    gestures = []
    for template in templates:
        label, poses = str(recorded.labels[template]), recorded.recordings[template]
        try:
            gestures.append(Gesture.from_demonstration(label, poses))
        except GestureError:  # nothing moves enough by itself: follow every landmark
            gestures.append(Gesture.from_demonstration(label, poses, salient=poses.landmarks))
    return gestures


def main() -> None:
    """Print one line a set and method."""
    methods = [*PROFILES, "dtw"]
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("data", type=Path, help="the folder that holds trajectories/")
    parser.add_argument("--methods", nargs="+", choices=methods, default=methods)
    parser.add_argument("--sets", nargs="+", help="names of sets; default: all")
    parser.add_argument("--draws", type=int, default=60, help="choices of templates per set")
    parser.add_argument("--queries", type=int, default=30, help="queries per choice, UD and UI")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    print(f"one template a class, share correct (95 % interval), seed {given.seed}")
    print(f"{'set':12} {'method':7} {'UD':>18} {'n':>5} {'UI':>18} {'n':>5}")
    for recorded in chain(recorded_sets(given.data / "trajectories"), drawn_sets()):
        if given.sets and recorded.name not in given.sets:
            continue
        for method in given.methods:
            own, others = evaluate(recorded, method, given.draws, given.queries, given.seed)
            print(
                f"{recorded.name:12} {method:7} {own!s:>18} {own.queries:5} "
                f"{others!s:>18} {others.queries:5}",
                flush=True,
            )


if __name__ == "__main__":
    main()
