"""A topic of measurements that take a moment, each of which ends in another way."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from app.recognition import PoseSequence
from benchmarks.accuracy.comparison import (
    YARDSTICK,
    compare,
    draw_languages,
    find_methods,
    measure,
)
from benchmarks.figures import Figure, Measurement, Results, Table, share, table
from benchmarks.methods import find_method
from benchmarks.methods.base import Demonstration, Method, Prediction
from benchmarks.sets.drawn_sets import drawn_sets


class Failing(Method):
    """Cannot learn."""

    def fit(self, demonstrations: Sequence[Demonstration]) -> None:
        """Fail."""
        raise ZeroDivisionError("of a size")

    def predict(self, take: PoseSequence) -> Prediction:
        """Say nothing."""
        return Prediction()


def ask_about_swipes(quick: bool) -> Iterator[Figure]:
    """Ask profile `full` about swipes."""
    (swipes,) = (each for each in drawn_sets() if each.name == "swipes")
    outcomes = measure(find_method(YARDSTICK), [*draw_languages(swipes, swipes, 1, 6, seed=1)])
    for relation, nearest in outcomes.nearest.items():
        yield share(relation, nearest[True], nearest.total())


def compare_swipes(methods: tuple[str, ...], quick: bool) -> Iterator[Figure]:
    """Compare methods on swipes as on recorded sets."""
    (swipes,) = (each for each in drawn_sets() if each.name == "swipes")
    makers = find_methods((YARDSTICK, *methods), all_of_them=True)
    yield from compare(makers, "swipes", [*draw_languages(swipes, swipes, 1, 4, seed=1)])


def draw_numbers(quick: bool) -> Iterator[Figure]:
    """Count draws above a half."""
    drawn = np.random.default_rng(1).random(10 if quick else 1000)
    yield share("above-half", int((drawn > 0.5).sum()), len(drawn))


def fail(quick: bool) -> Iterator[Figure]:
    """Raise after a figure."""
    yield share("first", 1, 1)
    raise ValueError("the camera was under water")


def be_killed(quick: bool) -> Iterator[Figure]:
    """End as a process that the system kills."""
    os.kill(os.getpid(), signal.SIGKILL)
    yield share("never", 1, 1)


def measurements(folder: Path, methods: tuple[str, ...]) -> Iterator[Measurement]:
    """Yield the measurements."""
    yield Measurement("small/swipes", ask_about_swipes, "swipes", "another person and the same")
    yield Measurement("small/fails", fail, "none", "raises")
    yield Measurement("small/killed", be_killed, "none", "is killed")
    yield Measurement("small/numbers", draw_numbers, "random numbers", "drawn", alone=True)
    yield Measurement("small/compared", partial(compare_swipes, methods), "swipes", "compared")
    missing, file = folder / "missing.npz", folder / "set.npz"
    yield Measurement("recorded/missing", draw_numbers, "a set", "reads", reads=(missing, file))
    yield Measurement("recorded/set", draw_numbers, "a set", "reads", reads=(file,))


def write_numbers(results: Results) -> str:
    """Write the only number."""
    return table(("draws above a half",), [[results.show("small/numbers", "above-half")]])


TABLES: dict[str, Table] = {"numbers": write_numbers}
