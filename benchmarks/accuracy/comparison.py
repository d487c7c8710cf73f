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

How to write a method, and which sets these are: `docs/bench.md`. The trained methods need the extra
``bench``; without it they are left out, and the reason is printed.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import chain
from pathlib import Path
from statistics import fmean
from time import process_time
from traceback import extract_tb

import numpy as np

from app.recognition import OsgError, PoseSequence
from app.recognition.gestures.profile import PROFILES
from benchmarks.figures import Figure, Measurement, Results, share, table
from benchmarks.methods import COSTLY, METHODS, find_method
from benchmarks.methods.base import Demonstration, Method, Prediction
from benchmarks.sets.every_set import is_of_bodies, measure_sets
from benchmarks.sets.one_shot_draws import draw_several, draws
from benchmarks.sets.recorded_sets import SETS, RecordedSet
from benchmarks.sets.whole_body_sets import ARM_CLASSES, far_movements

YARDSTICK = "full"
PEOPLE = (1, 3)

DRAWS = 20
DRAWS_OF_COSTLY = 4
"""Languages a set: the methods that take long see the first of them."""

OF_THE_LANGUAGE = ("right", "asked", "refused", "wrong")
OUT_OF_VOCABULARY = ("answered", "asked", "refused")
LIMITS = (0.5, 0.7, 0.8, 0.9)
"""Confidences below which an answer is refused, as by ``least_confidence`` of a vehicle's table."""

NAMES = {
    "paper": "profile `paper`",
    "full": "profile `full`",
    "published": "published steps",
    "dtw": "plain DTW",
    "jackknife": "Jackknife",
    "point-cloud": "$P",
    "hmm": "HMM",
    "svm": "SVM",
    "crf": "CRF",
    "bi-lstm": "Bi-LSTM",
}
"""Methods as the table calls them."""


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
    confidences
        By relation and outcome: the confidence of each answer that has one.
    fitting, predicting
        Seconds of processor time for each language, and for each take.

    """

    nearest: dict[str, Counter[bool]] = field(default_factory=lambda: defaultdict(Counter))
    counts: dict[str, Counter[str]] = field(default_factory=lambda: defaultdict(Counter))
    confidences: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))
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
            takes = {f"another-{people}": asked}
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
        labels = {each.label for each in language.demonstrations}
        try:
            method = make()
        except Exception as error:
            raise MethodError(_describe(error, "__init__")) from error
        start = process_time()
        try:
            method.fit(language.demonstrations)
        except Exception as error:
            raise MethodError(_describe(error, "fit")) from error
        outcomes.fitting.append(process_time() - start)
        for relation, takes in language.takes.items():
            for take in takes:
                label, start = take.label, process_time()
                said = _predict(method, take.poses)
                outcomes.predicting.append(process_time() - start)
                check(said, labels)
                outcome = judge(said, label, label in labels)
                outcomes.counts[relation][outcome] += 1
                if said.label is not None and said.confidence is not None:
                    outcomes.confidences[f"{relation}/{outcome}"].append(said.confidence)
                if label in labels:
                    outcomes.nearest[relation][said.nearest == label] += 1
    return outcomes


def _predict(method: Method, take: PoseSequence) -> Prediction:
    try:
        return method.predict(take)
    except OsgError:
        return Prediction()
    except Exception as error:
        raise MethodError(_describe(error, "predict")) from error


def _describe(error: Exception, function: str) -> str:
    """Return what failed and where: the last line that ran."""
    last = extract_tb(error.__traceback__)[-1]
    place = f"{Path(last.filename).name}, line {last.lineno}"
    return f"{type(error).__name__} of `{function}` ({place}): {error}"


def check(said: Prediction, labels: set[str]) -> None:
    """Check an answer.

    Raises
    ------
    MethodError
        If it is no `Prediction`, names what is not in the language, or has a distance or confidence
        that is no number.

    """
    if not isinstance(said, Prediction):
        raise MethodError(f"`predict` returned {said!r}, not a Prediction")
    if said.pair is not None and (not isinstance(said.pair, tuple | list) or len(said.pair) != 2):
        raise MethodError(f"the pair {said.pair!r} is not two labels")
    for label in (said.label, *(said.pair or ()), *said.distances):
        if label is not None and (not isinstance(label, str) or label not in labels):
            raise MethodError(f"{label!r} is not in the language: {', '.join(sorted(labels))}")
    if np.isnan([*said.distances.values()]).any():
        raise MethodError("a distance is NaN: is a keypoint missing that the method needs?")
    if said.confidence is not None and not 0 <= said.confidence <= 1:
        raise MethodError(f"the confidence {said.confidence!r} is not in [0, 1]")


def judge(said: Prediction, label: str, known: bool) -> str:
    """Return the outcome of a take of a gesture of the language, or of none."""
    if said.label is not None:
        return ("right" if said.label == label else "wrong") if known else "answered"
    return "asked" if said.pair is not None else "refused"


def find_methods(names: Iterable[str], *, all_of_them: bool) -> dict[str, Callable[[], Method]]:
    """Find methods by name.

    Parameters
    ----------
    names
        See `find_method`.
    all_of_them
        Whether one that is not installed is an error: a whole run would drop its figures. Else it
        is named and left out.

    Raises
    ------
    MethodError
        If one is not installed.

    """
    found = {}
    for name in names:
        try:
            found[name] = find_method(name)
        except ModuleNotFoundError as error:
            reason = f'{name} needs {error.name}: pip install -e ".[bench]"'
            if all_of_them:
                raise MethodError(f"{reason}; its figures stay as they are") from error
            print(f"{name} is left out, {reason}", flush=True)
    return found


def compare_on_set(
    methods: tuple[str, ...], most: int, trajectories: Path, recorded: RecordedSet, quick: bool
) -> Iterator[Figure]:
    """Draw languages of a set, and yield what every method says of its takes."""
    count, queries = (min(most, 1 if methods == COSTLY else 3), 15) if quick else (most, 30)
    if quick and methods != COSTLY:  # the draws are others than those of `results.json`
        methods = (*METHODS, *methods)
    makers = find_methods(dict.fromkeys((YARDSTICK, *methods)), all_of_them=not quick)
    far = far_movements(trajectories)
    return compare(makers, recorded.name, [*draw_languages(recorded, far, count, queries, 1)])


def compare(
    makers: Mapping[str, Callable[[], Method]], data: str, languages: Sequence[Language]
) -> Iterator[Figure]:
    """Yield what every method says of takes, and what it costs; the yardstick is one of them."""
    found: dict[str, Outcomes] = {}
    for name, make in makers.items():
        try:
            found[name] = measure(make, languages)
        except MethodError as error:
            print(f"{name} has no figures of {data}: {error}", flush=True)
    first = found[YARDSTICK]
    for name, outcomes in found.items():
        method = name.replace(" ", "-")
        for relation, nearest in outcomes.nearest.items():
            yield share(f"{method}/{relation}", nearest[True], nearest.total())
        # Only profiles, and methods of one's own, refuse takes.
        if name not in (*METHODS, *COSTLY) or name in PROFILES:
            yield from count_answers(method, outcomes)
        for cost, mine, theirs in (
            ("fit", outcomes.fitting, first.fitting),
            ("predict", outcomes.predicting, first.predicting),
        ):
            yield Figure(f"{method}/{cost}", fmean(mine) / fmean(theirs), len(mine), unit="ratio")


def count_answers(method: str, outcomes: Outcomes) -> Iterator[Figure]:
    """Yield what a method answers to each kind of take, and what of it from each confidence on."""
    for relation, counts in outcomes.counts.items():
        known = relation in outcomes.nearest
        for outcome in OF_THE_LANGUAGE if known else OUT_OF_VOCABULARY:
            name = f"{method}/{relation}/{outcome}"
            yield share(name, counts[outcome], counts.total())
            if outcomes.confidences and outcome in ("right", "wrong", "answered"):
                for limit in LIMITS:
                    confidences = outcomes.confidences[f"{relation}/{outcome}"]
                    kept = sum(each >= limit for each in confidences)
                    yield share(f"{name}-from-{limit:g}", kept, counts.total())


def measurements(folder: Path, methods: tuple[str, ...]) -> Iterator[Measurement]:
    """Yield the comparison on every set, and that with the costly methods in some of its draws."""
    protocol = (
        "{} languages of all classes, 30 takes each by the same person, by others, of classes that "
        "the language lacks, and of people who do not sign; one demonstration by one or by three"
    )
    trajectories = folder / "trajectories"
    for topic, compared, count in (
        ("comparison", methods or METHODS, DRAWS),
        ("costly", COSTLY, DRAWS_OF_COSTLY),
    ):
        yield from measure_sets(
            topic,
            folder,
            (*SETS, *ARM_CLASSES),
            partial(compare_on_set, compared, count, trajectories),
            protocol.format(count),
            trajectories / "kindergator.npz",
        )


def write_nearest(results: Results) -> str:
    """Write the share of takes whose nearest gesture is right: a row a set, a column a method."""
    sets = results.names("comparison")
    methods = {
        figure.partition("/")[0]: topic
        for topic in ("costly", "comparison")
        for name in results.names(topic)
        for figure in results.measured[f"{topic}/{name}"].figures
    }
    order = sorted(methods, key=lambda each: (methods[each], each != YARDSTICK))
    rows = [
        [
            name,
            *(
                _show(results, f"{methods[each]}/{name}", [f"{each}/same", f"{each}/another-1"])
                for each in order
            ),
        ]
        for name in sets
    ]
    return table(("set", *(NAMES.get(each, each) for each in order)), rows)


def write_answers(results: Results) -> str:
    """Write what profile `full` answers to takes of the language, and to those that it lacks."""
    rows = [
        [
            name,
            *(
                results.show(f"comparison/{name}", f"full/{each}", "cell?")
                for each in ("same", "another-1", "another-3")
            ),
            *(
                _show(
                    results, f"comparison/{name}", [f"full/{relation}/{each}" for each in outcomes]
                )
                for relation, outcomes in (
                    ("another-1", OF_THE_LANGUAGE),
                    ("another-3", OF_THE_LANGUAGE),
                    ("near", OUT_OF_VOCABULARY[:2]),
                    ("far", OUT_OF_VOCABULARY[:2]),
                )
            ),
        ]
        for name in results.names("comparison")
    ]
    head = ("set", "same person", "another", "3 people, another")
    outcomes = ("1 person: right / asked / refused / wrong", "3 people", "near: answered / asked")
    return table((*head, *outcomes, "far"), rows)


def _show(results: Results, measurement: str, figures: Sequence[str]) -> str:
    """Return figures with slashes between them, ``-`` where they were not measured."""
    shown = [results.show(measurement, each, "bare?") for each in figures]
    return "-" if "-" in shown else " / ".join(shown)


def write_limits(results: Results) -> str:
    """Write what `full` answers from a confidence on: right, wrong, and takes of no gesture."""
    ends = ("", *(f"-from-{limit:g}" for limit in LIMITS))
    answers = ("another-1/right", "another-1/wrong", "near/answered")
    rows = [
        [name]
        + [
            " / ".join(
                results.show(f"comparison/{name}", f"full/{answer}{end}", "bare?")
                for answer in answers
            )
            for end in ends
        ]
        for name in results.names("comparison")
    ]
    return table(("set", "all answers", *(f"from {limit:g} on" for limit in LIMITS)), rows)


TABLES = {"nearest": write_nearest, "answers": write_answers, "limits": write_limits}
