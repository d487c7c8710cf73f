"""Comparison of methods: accuracy, time and memory on the same takes, in one run.

One template per class; `one_shot_draws` chooses templates and queries. Times are processor time of
all threads, so that other programs on the machine do not count, relative to profile ``full`` on the
same work. Memory is the peak of a process that imports a method, teaches it one language of ten
digits and recognises ten queries.

    python -m benchmarks.accuracy.comparison ../shared/data --draws 20 --queries 15 --seed 1

The trained methods need the extra ``bench``; without it they are left out, and the reason is
printed.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from statistics import fmean
from time import process_time

import numpy as np
import numpy.typing as npt

from app.evaluation.proportion import Share
from benchmarks.arguments import set_arguments
from benchmarks.methods import METHODS, new_method
from benchmarks.methods.base import Method
from benchmarks.sets.one_shot_draws import Draw, draws
from benchmarks.sets.recorded_sets import RecordedSet, recorded_sets

YARDSTICK = "full"
QUERIES_OF_THE_CHILD = 10

CHILD = """
import resource, sys
from pathlib import Path
from benchmarks.accuracy.comparison import teach_and_ask_once
teach_and_ask_once(sys.argv[1], Path(sys.argv[2]))
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
"""


@dataclass
class Outcome:
    """Results of one method.

    Attributes
    ----------
    own, others
        Per set: shares right for queries by the person who demonstrated, and by everybody else.
    adding, asking
        Seconds of processor time: for adding the last gesture of each language, with all work that
        it makes necessary, and for each query.

    """

    own: dict[str, Share] = field(default_factory=dict)
    others: dict[str, Share] = field(default_factory=dict)
    adding: list[float] = field(default_factory=list)
    asking: list[float] = field(default_factory=list)


def measure(name: str, sets: Iterable[tuple[RecordedSet, list[Draw]]]) -> Outcome:
    """Teach a method every drawn language and let it recognise every query."""
    outcome = Outcome()
    new_method(name)  # imports on first use must not count for the first gesture
    for recorded, drawn in sets:
        own, others = Share(0, 0), Share(0, 0)
        for draw in drawn:
            method = new_method(name)
            outcome.adding.append(_teach(method, recorded, draw.templates))
            own += _ask(method, recorded, draw.own, outcome.asking)
            others += _ask(method, recorded, draw.others, outcome.asking)
        outcome.own[recorded.name], outcome.others[recorded.name] = own, others
    return outcome


def _teach(method: Method, recorded: RecordedSet, templates: list[int]) -> float:
    """Teach a language and return the seconds that its last gesture took."""
    start = process_time()
    for template in templates:
        start = process_time()
        method.add(str(recorded.labels[template]), recorded.recordings[template])
    method.prepare()
    return process_time() - start


def _ask(
    method: Method, recorded: RecordedSet, queries: npt.NDArray[np.intp], times: list[float]
) -> Share:
    correct = 0
    for query in queries:
        start = process_time()
        answer = method.answer(recorded.recordings[query])
        times.append(process_time() - start)
        correct += answer == recorded.labels[query]
    return Share(correct, len(queries))


def teach_and_ask_once(name: str, data: Path) -> None:
    """Run the work whose memory is measured."""
    recorded = next(iter(recorded_sets(data / "trajectories")))
    (draw,) = draws(recorded, 1, QUERIES_OF_THE_CHILD, seed=1)
    method = new_method(name)
    _teach(method, recorded, draw.templates)
    _ask(method, recorded, draw.own, [])


def peak_memory(name: str, data: Path) -> float:
    """Return the peak resident memory of a process that uses the method, in the system's unit."""
    child = subprocess.run(
        [sys.executable, "-c", CHILD, name, str(data)], check=True, capture_output=True, text=True
    )
    return float(child.stdout)


def main() -> None:
    """Print one Markdown table, one row a method."""
    parser = set_arguments(__doc__, draws=20, queries=15)
    parser.add_argument("--methods", nargs="+", choices=METHODS, default=METHODS)
    given = parser.parse_args()
    sets = [
        (recorded, list(draws(recorded, given.draws, given.queries, given.seed)))
        for recorded in recorded_sets(given.data / "trajectories", given.sets)
    ]
    names = [recorded.name for recorded, _ in sets]
    yardstick = measure(YARDSTICK, sets)
    used = peak_memory(YARDSTICK, given.data)
    print(f"{given.draws} languages a set, {given.queries} queries a language and kind")
    print("| method | " + " | ".join(names) + " | adding | query | memory |")
    print("| --- " * (len(names) + 4) + "|")
    for name in given.methods:
        try:
            outcome = yardstick if name == YARDSTICK else measure(name, sets)
        except ModuleNotFoundError as error:
            print(f"| {name} | left out: {error.name} is not installed (extra `bench`) |")
            continue
        cells = [_accuracy(outcome, each) for each in names]
        ratios = (
            fmean(outcome.adding) / fmean(yardstick.adding),
            fmean(outcome.asking) / fmean(yardstick.asking),
            peak_memory(name, given.data) / used,
        )
        cells += [f"{ratio:.2g}" for ratio in ratios]
        print(f"| {name} | " + " | ".join(cells) + " |", flush=True)


def _accuracy(outcome: Outcome, name: str) -> str:
    own, others = outcome.own[name], outcome.others[name]
    return f"{own} / {others}" if others.asked else str(own)


if __name__ == "__main__":
    main()
