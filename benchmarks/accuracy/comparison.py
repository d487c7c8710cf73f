"""Comparison of methods: what each says of the same takes, and what it costs, in one run.

One person demonstrates every gesture of a set, or three people do; takes are by that person
(`same`), and by people who show nothing (`another`; by anybody where people are not known). A take
of the language is answered right, asked back, refused or answered wrong; *nearest* is the share
whose nearest gesture is right. Of languages of a random half of the classes, takes of the other
half (`near`), and for whole bodies movements of people who do not sign (`far`), are answered, asked
back or refused. `one_shot_draws` draws people, demonstrations and takes, the same for all methods.

Times are processor time of all threads, so that other programs on the machine do not count: of
`fit` for a language, and of `predict` for a take, relative to profile ``full`` on the same work.
The interval is Wilson's.

    python -m benchmarks.accuracy.comparison ../shared/data --draws 20 --queries 15 --seed 1
    python -m benchmarks.accuracy.comparison ../shared/data --method package.module:Class

How to write a method, and which sets these are: `docs/bench.md`. The trained methods need the extra
``bench``; without it they are left out, and the reason is printed.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import chain
from statistics import fmean
from time import process_time

import numpy as np

from app.evaluation.share import Share
from app.recognition import OsgError, PoseSequence
from benchmarks.accuracy.people import all_sets, count_people, is_of_bodies
from benchmarks.arguments import set_arguments
from benchmarks.methods import METHODS, find_method
from benchmarks.methods.base import Demonstration, Method, Prediction
from benchmarks.sets.drawn_sets import drawn_sets
from benchmarks.sets.one_shot_draws import draw_several, draws
from benchmarks.sets.recorded_sets import RecordedSet
from benchmarks.sets.whole_body_sets import far_movements

YARDSTICK = "full"
PEOPLE = (1, 3)
OF_THE_LANGUAGE = ("right", "asked", "refused", "wrong")
OUT_OF_VOCABULARY = ("answered", "asked", "refused")


class MethodError(Exception):
    """A method failed, or answered what is not in the language."""


@dataclass(frozen=True, eq=False)
class Language:
    """A language that a method learns, and takes to ask it about.

    Attributes
    ----------
    demonstrations
        What it learns.
    takes
        By relation; labels of movements that are no gestures are not in the language.

    """

    demonstrations: list[Demonstration]
    takes: dict[str, list[Demonstration]]


@dataclass
class Outcomes:
    """What a method said of a set's takes.

    Attributes
    ----------
    nearest
        By relation: takes of gestures of the language, by whether their nearest gesture is right.
    counts
        By relation: takes by outcome.
    fitting, predicting
        Seconds of processor time for each language, and for each take.

    """

    nearest: dict[str, Counter[bool]] = field(default_factory=lambda: defaultdict(Counter))
    counts: dict[str, Counter[str]] = field(default_factory=lambda: defaultdict(Counter))
    fitting: list[float] = field(default_factory=list)
    predicting: list[float] = field(default_factory=list)


def draw_languages(
    recorded: RecordedSet, far: RecordedSet, count: int, queries: int, seed: int
) -> Iterator[Language]:
    """Draw languages of all classes by one person and by three, and of half of them by one."""
    for number, chosen in enumerate(draws(recorded, count, queries, seed)):
        several = draw_several(recorded, chosen, max(PEOPLE), queries, seed + number)
        asked = recorded.show(several.queries.tolist())
        for people in (each for each in PEOPLE if each <= len(several.takes)):
            takes = {f"another, {people}": asked}
            if people == 1:
                takes["same"] = recorded.show(chosen.own.tolist())
            shown = chain.from_iterable(several.rows(people))
            yield Language(recorded.show([*shown]), takes)
        shown = chain.from_iterable(several.rows(1))
        half = [each for each in recorded.show([*shown]) if each.label in several.half]
        takes = {"near": [each for each in asked if each.label not in several.half]}
        if is_of_bodies(recorded):
            order = np.random.default_rng(seed + number).permutation(len(far.recordings))
            takes["far"] = far.show(order[:queries].tolist())
        yield Language(half, takes)


def measure(make: Callable[[], Method], languages: Sequence[Language]) -> Outcomes:
    """Teach a method every language and let it say what every take is.

    Raises
    ------
    MethodError
        When it fails, or answers a label that is not in the language.

    """
    outcomes = Outcomes()
    for language in languages:
        method, labels = make(), {each.label for each in language.demonstrations}
        start = process_time()
        method.fit(language.demonstrations)
        outcomes.fitting.append(process_time() - start)
        for relation, takes in language.takes.items():
            for take in takes:
                label, start = take.label, process_time()
                said = _predict(method, take.poses)
                outcomes.predicting.append(process_time() - start)
                named = {said.label, said.nearest, *(said.pair or ())} - {None}
                if not named <= labels:
                    raise MethodError(f"{named - labels} is not in the language {sorted(labels)}")
                outcomes.counts[relation][judge(said, label, label in labels)] += 1
                if label in labels:
                    outcomes.nearest[relation][said.nearest == label] += 1
    return outcomes


def _predict(method: Method, take: PoseSequence) -> Prediction:
    try:
        return method.predict(take)
    except OsgError:
        return Prediction()
    except Exception as error:
        raise MethodError(f"{type(error).__name__} of `predict`: {error}") from error


def judge(said: Prediction, label: str, known: bool) -> str:
    """Return the outcome of a take of a gesture of the language, or of none."""
    if said.label is not None:
        return ("right" if said.label == label else "wrong") if known else "answered"
    return "asked" if said.pair is not None else "refused"


def format_nearest(outcomes: Outcomes) -> str:
    """Return the shares right of the same person's takes, and of others' with one and three."""
    relations = ("same", *(f"another, {people}" for people in PEOPLE))
    counts = [outcomes.nearest[each] for each in relations]
    return " / ".join(str(Share(each[True], each.total())) for each in counts)


def format_outcomes(counts: Counter[str], names: Sequence[str]) -> str:
    """Return the shares of outcomes in per cent, and the number of takes."""
    if not counts:
        return "-"
    shares = " / ".join(f"{100 * counts[name] / counts.total():.1f}" for name in names)
    return f"{shares}, n {counts.total()}"


def print_set(recorded: RecordedSet, found: dict[str, Outcomes]) -> None:
    """Print one row for each method, with its costs relative to the yardstick."""
    print(f"\n## {recorded.name}, {count_people(recorded) or 'unknown'} people\n")
    print(
        "| method | nearest: same / another, 1 person / 3 people | 1 person: right / asked / "
        "refused / wrong | 3 people | near: answered / asked / refused | far | fit | predict |"
    )
    print("| --- " * 8 + "|")
    first = found[YARDSTICK]
    for name, outcomes in found.items():
        cells = [name, format_nearest(outcomes)]
        cells += [
            format_outcomes(outcomes.counts[f"another, {people}"], OF_THE_LANGUAGE)
            for people in PEOPLE
        ]
        cells += [
            format_outcomes(outcomes.counts[each], OUT_OF_VOCABULARY) for each in ("near", "far")
        ]
        cells += [
            f"{fmean(mine) / fmean(theirs):.2g}"
            for mine, theirs in (
                (outcomes.fitting, first.fitting),
                (outcomes.predicting, first.predicting),
            )
        ]
        print(f"| {' | '.join(cells)} |", flush=True)


def main() -> None:
    """Print a table for each set, one row a method."""
    parser = set_arguments(__doc__, draws=20, queries=15)
    parser.add_argument("--methods", nargs="+", choices=METHODS, default=METHODS)
    parser.add_argument(
        "--method", action="append", default=[], help="one of your own, package.module:Class"
    )
    given = parser.parse_args()
    makers: dict[str, Callable[[], Method]] = {}
    for name in dict.fromkeys((YARDSTICK, *given.methods, *given.method)):
        try:
            makers[name] = find_method(name)
        except (ModuleNotFoundError, AttributeError, ValueError) as error:
            print(f"{name} is left out: {error}")
    folder = given.data / "trajectories"
    if not folder.is_dir():
        parser.error(f"{folder} is not there; which sets it holds: docs/bench.md")
    far = far_movements(folder)
    for recorded in chain(all_sets(folder, given.sets), drawn_sets()):
        if given.sets and recorded.name not in given.sets:
            continue
        languages = [*draw_languages(recorded, far, given.draws, given.queries, given.seed)]
        found: dict[str, Outcomes] = {}
        for name, make in makers.items():
            try:
                found[name] = measure(make, languages)
            except MethodError as error:
                print(f"{name} has no row for {recorded.name}: {error}")
        print_set(recorded, found)


if __name__ == "__main__":
    main()
