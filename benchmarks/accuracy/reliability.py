"""Reliability: how far the confidence of profile ``full`` is true, and what its limit rejects.

In each recorded set a random half of the classes makes a language, one take each by one person or
three; half of the takes that it is asked about are of these classes, half of the others,
out-of-vocabulary. The coefficients of the confidence are fitted by logistic regression; `left-out`
are confidences fitted without the set and without the person of each take.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain, pairwise
from pathlib import Path
from typing import Final

import numpy as np

from app.recognition import Language, PoseError, Recognizer
from app.recognition.decision.outcome import bound_confidence, sum_distances
from app.recognition.poses.sequence import FloatArray
from benchmarks.accuracy.people import define
from benchmarks.figures import Figure, Measurement, Results, share, table
from benchmarks.sets.every_set import all_sets, find_files
from benchmarks.sets.one_shot_draws import find_complete_people
from benchmarks.sets.recorded_sets import SETS, RecordedSet
from benchmarks.sets.simulated_bodies import CARRIED
from benchmarks.sets.whole_body_sets import ARM_CLASSES

REFUSED = 0.05
"""Share of the right takes rejected at the set's own limit."""

BINS = (0.0, 0.2, 0.4, 0.6, 0.8, 0.9, 1.0001)

KINDS: Final = {"same": (True, 1), "another": (False, 1), "three": (False, 3)}
"""Whether somebody who shows the language makes the takes, and how many show it."""

THRESHOLDS: Final = (0.5, 0.8, 0.9)

NEWTON_ROUNDS: Final = 30
"""Steps of Newton's method; logistic regression converges in about ten."""


@dataclass(frozen=True)
class Answer:
    """One query's outcome.

    Attributes
    ----------
    recorded
        Name of the set.
    language
        Number of the language that recognised the query.
    people
        Who shows the language, and who made the query last.
    confidence, novelty
        Of the nearest gesture.
    distance
        Its sum of distances, the regressor of the confidence.
    known
        Whether the query's gesture was in the language.
    correct
        Whether this gesture was the nearest one.
    answers
        How many gestures the answer has; none: the query was rejected.

    """

    recorded: str
    language: int
    people: tuple[str, ...]
    confidence: float
    novelty: float
    distance: float
    known: bool
    correct: bool
    answers: int


def answers(
    recorded: RecordedSet,
    draws: int,
    queries: int,
    seed: int,
    *,
    same_person: bool,
    shown_by: int = 1,
) -> Iterator[Answer]:
    """Return queries by the people of the templates, or by all others; `shown_by`: how many."""
    random = np.random.default_rng(seed)
    classes = np.unique(recorded.labels)
    for number in range(draws):
        chosen = random.permutation(classes)[: len(classes) // 2 + 1]
        people = random.choice(find_complete_people(recorded), shown_by, replace=False)
        templates = [
            [
                int(random.choice(np.flatnonzero((recorded.people == each) & of_label)))
                for each in people
            ]
            for of_label in (recorded.labels == label for label in chosen)
        ]
        gestures = [define(recorded, takes) for takes in templates]
        recognizer = Recognizer(Language(recorded.name, gestures), "full")
        asked = np.flatnonzero(np.isin(recorded.people, people) == same_person)
        asked = np.setdiff1d(asked, templates)
        known = np.isin(recorded.labels[asked], chosen)
        count = min(queries // 2, int(known.sum()), int((~known).sum()))
        for query in chain(
            *(random.choice(asked[of], count, replace=False) for of in (known, ~known))
        ):
            label = str(recorded.labels[query])
            try:
                result = recognizer.recognize(recorded.recordings[query])
            except PoseError:
                continue
            novelty = float(result.novelty[result.gestures.index(result.nearest)])
            nearest, second = np.sort(result.scores)[:2].tolist()
            yield Answer(
                recorded=recorded.name,
                language=number + seed * draws,
                people=(*people.tolist(), str(recorded.people[query])),
                confidence=result.confidence,
                novelty=novelty,
                distance=sum_distances(novelty, nearest, second),
                known=label in chosen,
                correct=result.nearest == label,
                answers=1 if result.label else 2 if result.pair else 0,
            )


def count_bins(name: str, asked: Sequence[Answer]) -> Iterator[Figure]:
    """Yield the mean confidence and the share correct of each bin."""
    for low, high in pairwise(BINS):
        inside = [answer for answer in asked if low <= answer.confidence < high]
        if inside:
            mean = float(np.mean([answer.confidence for answer in inside]))
            start = f"{name}/{low:g}-{min(high, 1):g}"
            yield Figure(f"{start}/confidence", mean, len(inside), unit="")
            yield share(f"{start}/right", sum(answer.correct for answer in inside), len(inside))


def count_rejected(name: str, asked: Sequence[Answer]) -> Iterator[Figure]:
    """Yield how many right takes are rejected, and how many out-of-vocabulary ones are accepted.

    `own-limit`: accepted by a limit of the set's own, which rejects `REFUSED` of the right takes.
    """
    known = [answer for answer in asked if answer.known]
    foreign = [answer for answer in asked if not answer.known]
    own = float(np.quantile([answer.novelty for answer in known], 1 - REFUSED))
    yield share(f"{name}/rejected", sum(not each.answers for each in known), len(known))
    yield share(f"{name}/accepted", sum(each.answers > 0 for each in foreign), len(foreign))
    below = sum(each.novelty <= own for each in foreign)
    yield share(f"{name}/accepted-by-own-limit", below, len(foreign))


def fit_confidence(asked: Sequence[Answer]) -> FloatArray:
    """Fit the coefficients ``(2,)`` of the confidence, by logistic regression."""
    distances = np.array([answer.distance for answer in asked])
    correct = np.array([answer.correct for answer in asked])
    known = np.stack([np.ones_like(distances), distances], axis=1)
    coefficients = np.zeros(2)
    for _ in range(NEWTON_ROUNDS):
        chance = 1.0 / (1.0 + np.exp(-known @ coefficients))
        curvature = (known.T * (chance * (1 - chance))) @ known
        coefficients += np.linalg.solve(curvature, known.T @ (correct - chance))
    return coefficients


def leave_out(asked: Sequence[Answer]) -> tuple[list[Answer], FloatArray]:
    """Fit the confidence of every answer without its set and without who made the query.

    Returns
    -------
    The answers with these confidences, and the coefficients ``(F, 2)`` of all fits.

    """
    parts = defaultdict[str, defaultdict[str, list[Answer]]](lambda: defaultdict(list))
    for answer in asked:
        parts[answer.recorded][answer.people[-1]].append(answer)
    left_out, coefficients = [], []
    for name, by_person in parts.items():
        for person, part in by_person.items():
            fitted = fit_confidence(
                [each for each in asked if each.recorded != name and person not in each.people]
            )
            coefficients.append(fitted)
            for answer in part:
                odds = float(fitted @ (1.0, answer.distance))
                confidence = 1.0 / (1.0 + math.exp(min(-odds, 700.0)))
                bounded = bound_confidence(confidence, answer.answers, answer.novelty)
                left_out.append(replace(answer, confidence=bounded))
    return left_out, np.array(coefficients)


def ask_all(folder: Path, quick: bool) -> Iterator[Answer]:
    """Ask the languages of every set, shown by one person and by three."""
    for recorded in all_sets(folder):
        for same, people in KINDS.values():
            if same or len(np.unique(recorded.people)) > people:
                for seed in (1,) if quick else (1, 2):
                    yield from answers(
                        recorded, 3 if quick else 20, 30, seed, same_person=same, shown_by=people
                    )


def measure_confidence(folder: Path, quick: bool) -> Iterator[Figure]:
    """Yield how far the confidence is true, and what the limit rejects and accepts."""
    asked = [*ask_all(folder, quick)]
    left_out, fits = leave_out(asked)
    fitted = fit_confidence(asked)
    for index, name in enumerate(("at-zero", "per-distance")):
        ends = (float(fits[:, index].min()), float(fits[:, index].max()))
        yield Figure(f"coefficient/{name}", float(fitted[index]), len(asked), ends, "")
    tables = {
        "shipped": asked,
        "left-out": left_out,
        "same": [each for each in asked if each.people[-1] in each.people[:-1]],
        "three": [each for each in asked if len(each.people) > 2],
    }
    for name, judged in tables.items():
        yield from count_bins(name, judged)
    answered = [answer for answer in asked if answer.answers == 1]
    for least in THRESHOLDS:
        for correct in (True, False):
            of = [answer.confidence for answer in answered if answer.correct is correct]
            name = f"from-{least:g}/{'right' if correct else 'wrong'}"
            yield share(name, sum(each >= least for each in of), len(of))
    pairs = [answer.correct for answer in asked if answer.answers == 2]
    yield share("pairs/right", sum(pairs), len(pairs))
    for name in dict.fromkeys(answer.recorded for answer in asked):
        of_set = [answer for answer in asked if answer.recorded == name]
        for kind, (same, people) in KINDS.items():
            of_kind = [
                each
                for each in of_set
                if (each.people[-1] in each.people[:-1]) is same and len(each.people) == people + 1
            ]
            if of_kind:
                yield from count_rejected(f"{name}/{kind}", of_kind)


def measurements(folder: Path, methods: tuple[str, ...]) -> Iterator[Measurement]:
    """Yield one of all sets together: the confidence is fitted without each of them."""
    trajectories = folder / "trajectories"
    yield Measurement(
        "confidence/all",
        partial(measure_confidence, trajectories),
        data="thirteen sets; of grufba3d and natops people are not known",
        protocol="40 languages of half of a set's classes by one person or three; 30 takes each by "
        "the same person and by others, half of them of the other classes",
        people=28,
        reads=find_files(trajectories, (*SETS, *ARM_CLASSES, *CARRIED)),
    )


def write_confidence(results: Results) -> str:
    """Write a row for each bin of the shipped confidence, and of that fitted without the take."""
    rows = []
    for low, high in pairwise(BINS):
        cells = [f"{low:g} to {min(high, 1):g}"]
        for name in ("shipped", "left-out"):
            start = f"{name}/{low:g}-{min(high, 1):g}"
            cells.append(results.show("confidence/all", f"{start}/right", "n?"))
            cells.append(f"{results.find('confidence/all', f'{start}/confidence').value:.2f}")
            cells.append(results.show("confidence/all", f"{start}/right", "cell?"))
        rows.append(cells)
    head = ("n", "mean confidence", "right, %")
    return table(("confidence", *head, *(f"left out: {each}" for each in head)), rows)


TABLES = {"confidence": write_confidence}
