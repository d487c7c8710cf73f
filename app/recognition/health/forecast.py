"""Forecast: what other people's takes of a language will be read as, measured within the language.

Each person's demonstrations are read by those of the others, by the recogniser of a language that
the person has not shown (leave one person out). Nothing is simulated, and nothing is fitted. One
person's demonstrations cannot foretell how other people's takes differ; then there is only the
range that such languages reached.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Set
from dataclasses import dataclass, replace
from typing import Any, Final, Literal, get_args

import numpy as np

from app.recognition.decision.result import Recognition, ScoreTable
from app.recognition.gestures.demonstration import MAX_DEMONSTRATIONS, condense
from app.recognition.gestures.gesture import Gesture
from app.recognition.health.finding import Rate, to_plain
from app.recognition.language.language import Language
from app.recognition.poses.sequence import FloatArray
from app.recognition.recognizer import Recognizer

Outcome = Literal["right", "asked", "refused", "wrong"]

OUTCOMES: Final[tuple[Outcome, ...]] = get_args(Outcome)

ENOUGH_PEOPLE: Final = 3
"""Number of people from which a forecast is promised; that of two people ranks languages worse."""

LEAST_GAIN: Final = 0.02
"""Gain of the interval's lower end by the last person below which no further one is asked for:
two points, within the error of a forecast (`docs/health.md`, *How near forecasts are*)."""

ONE_PERSON: Final = (0.44, 0.97)
"""Least and largest share of other people's takes that languages shown by one person read right, by
set (`docs/health.md`, *How near forecasts are*)."""


@dataclass(frozen=True)
class Reading:
    """What one demonstration is read as by those of the other people.

    Attributes
    ----------
    gesture, demonstration
        Label of its gesture, and its number in it, counted from 0.
    diver
        Who shows it; empty: not named.
    outcome
        ``right``, ``asked`` back with the right gesture among the two, ``refused``, or ``wrong``:
        another gesture, or two others.
    read_as
        The labels of the answer; of a refusal the nearest one, none where nothing is comparable.

    """

    gesture: str
    demonstration: int
    diver: str
    outcome: Outcome
    read_as: tuple[str, ...]

    @property
    def words(self) -> str:
        """What became of it, such as ``Bo's is read as circle``."""
        whose = f"{self.diver}'s" if self.diver else f"number {1 + self.demonstration}"
        answer = " or ".join(self.read_as)
        if self.outcome == "refused":
            return f"{whose} is refused" + (f" (nearest {answer})" if answer else "")
        asked = "asked back as" if len(self.read_as) > 1 else "read as"
        return f"{whose} is {asked} {answer}"


@dataclass(frozen=True)
class CurvePoint:
    """Share of demonstrations that are read right by those of some other people.

    Attributes
    ----------
    people
        Number of these other people.
    right
        Rate of demonstrations read right.

    """

    people: int
    right: Rate


@dataclass(frozen=True)
class Forecast:
    """What other people's takes of a language will be read as.

    Attributes
    ----------
    people
        Number of people who have shown gestures; those who are not named count as one.
    readings
        Of every demonstration whose gesture others have shown too; none of one person.
    curve
        The share read right by the number of people who have shown the language, fewest first;
        empty where it is not measured.

    """

    people: int
    readings: tuple[Reading, ...] = ()
    curve: tuple[CurvePoint, ...] = ()

    @property
    def asks_more(self) -> bool:
        """Whether another person should show the language.

        Not when the last person raised the lower end of the interval by less than `LEAST_GAIN`, nor
        when a gesture can have no further demonstrations.
        """
        if self.people >= MAX_DEMONSTRATIONS:
            return False
        if self.people < ENOUGH_PEOPLE or len(self.curve) < ENOUGH_PEOPLE - 1:
            return True
        before, last = (point.right.interval[0] for point in self.curve[-2:])
        return last - before >= LEAST_GAIN

    def count(self, outcome: Outcome, label: str | None = None) -> Rate | None:
        """Count an outcome among the readings of a gesture, or of all; None without any."""
        of = [each for each in self.readings if label in (None, each.gesture)]
        return Rate(sum(each.outcome == outcome for each in of), len(of)) if of else None

    def counts(self, label: str | None = None) -> dict[str, Rate | None]:
        """Count every outcome, see `count`."""
        return {outcome: self.count(outcome, label) for outcome in OUTCOMES}

    def failed(self, label: str) -> tuple[Reading, ...]:
        """Return the readings of a gesture that are not right."""
        return tuple(
            each for each in self.readings if each.gesture == label and each.outcome != "right"
        )

    @property
    def words(self) -> str:
        """What can be promised, and whom to ask, in a few sentences."""
        if (right := self.count("right")) is not None:
            few = "" if self.people >= ENOUGH_PEOPLE else " Two people are few: ask a third."
            if not few and self.curve:
                few = (
                    " The last person raised the lower end by two points or more: ask one more."
                    if self.asks_more
                    else " The last person raised the lower end by less than two points: more "
                    "people would help little."
                )
            return f"Other people's demonstrations are read right in {right}.{few}"
        if not self.people:
            return "No gesture has a demonstration, so nothing can be foretold."
        shown = (
            "One person has shown this language"
            if self.people == 1
            else "No gesture is shown by two people"
        )
        low, high = ONE_PERSON
        return (
            f"{shown}, so nothing can be foretold. Such languages read {100 * low:.0f} to "
            f"{100 * high:.0f} % of other people's takes right. Ask two more people to show it, "
            "and name the divers."
        )

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON types."""
        return {
            "people": self.people,
            "words": self.words,
            "asks_more": self.asks_more,
            "curve": [{"people": each.people, **to_plain(each.right)} for each in self.curve],
            **to_plain(self.counts()),
            "failed": to_plain([each for each in self.readings if each.outcome != "right"]),
        }


def make_forecast(language: Language, *, advance: Callable[[], None] = lambda: None) -> Forecast:
    """Read each person's demonstrations by those of the others, with profile ``full``.

    Parameters
    ----------
    language
        At least one gesture; demonstrations whose diver is not named count as one person's.
    advance
        Called after each reading; an exception that it raises ends the work.

    """
    divers = _list_divers(language)
    readings = [
        reading
        for diver in divers
        for reading in _read_diver(language, diver, set(divers) - {diver}, advance)
    ]
    order = {label: index for index, label in enumerate(language.labels)}
    readings.sort(key=lambda each: (order[each.gesture], each.demonstration))
    return Forecast(len(divers), tuple(readings))


def measure_curve(
    language: Language, forecast: Forecast, *, advance: Callable[[], None] = lambda: None
) -> tuple[CurvePoint, ...]:
    """Measure how the share of demonstrations read right grows with the number of people.

    Each person's demonstrations are read by those of one other person, of two, and so on, up to all
    others, where the share is that of the forecast. These others follow the person in the order
    of the names, around its end, so that each of them counts as often as any other.

    Parameters
    ----------
    language, advance
        As for `make_forecast`.
    forecast
        The language's, by `make_forecast`.

    """
    divers = _list_divers(language)
    points = []
    for count in range(1, len(divers) - 1):
        outcomes = [
            reading.outcome
            for index, diver in enumerate(divers)
            for reading in _read_diver(
                language,
                diver,
                {divers[(index + step) % len(divers)] for step in range(1, count + 1)},
                advance,
            )
        ]
        if outcomes:
            points.append(CurvePoint(count, Rate(outcomes.count("right"), len(outcomes))))
    if (right := forecast.count("right")) is not None:
        points.append(CurvePoint(len(divers) - 1, right))
    return tuple(points)


def _list_divers(language: Language) -> list[str]:
    """Return the names of those who show movements or hand shapes, in alphabetical order."""
    return sorted(
        {
            shown.diver
            for gesture in language.gestures
            for shown in gesture.single_demonstrations()
            if shown.trajectory is not None
        }
    )


def compare_people(
    language: Language, advance: Callable[[], None] = lambda: None
) -> tuple[int, list[tuple[int, FloatArray]]]:
    """Compare each person's demonstrations with those of the others.

    Returns
    -------
    The number of people whose demonstrations others have shown too, and of each of these the index
    of its gesture and its novelty ``(G,)`` for all gestures.

    """
    divers = _list_divers(language)
    found = []
    for diver in divers:
        compared = _compare_diver(language, diver, set(divers) - {diver}, advance)
        found.append([(own, table.novelty) for own, _, _, table in compared])
    return sum(map(bool, found)), [row for rows in found for row in rows]


def _read_diver(
    language: Language, diver: str, readers: Set[str], advance: Callable[[], None]
) -> Iterator[Reading]:
    """Yield the readings of the demonstrations by one diver, by those of the `readers`."""
    for own, number, recognizer, table in _compare_diver(language, diver, readers, advance):
        known = np.isfinite(table.scores).any()
        label = language.labels[own]
        result = recognizer.decide(table) if known else None
        yield Reading(label, number, diver, *judge(result, label))


def _compare_diver(
    language: Language, diver: str, readers: Set[str], advance: Callable[[], None]
) -> Iterator[tuple[int, int, Recognizer, ScoreTable]]:
    """Yield gesture, number, reader and distances of each demonstration by one diver."""
    if not readers:
        return
    others = [_keep(gesture, readers) for gesture in language.gestures]
    # A gesture that no reader has shown stays as it is, so that it can still be confused.
    kept = [other or gesture for other, gesture in zip(others, language.gestures, strict=True)]
    recognizer = Recognizer(replace(language, gestures=kept), "full")
    for index, (gesture, other) in enumerate(zip(language.gestures, others, strict=True)):
        if other is None or other.trajectory is None:
            continue
        for number, shown in enumerate(gesture.single_demonstrations()):
            if shown.diver == diver and shown.trajectory is not None:
                yield index, number, recognizer, recognizer.compare(condense(shown.trajectory))
                advance()


def _keep(gesture: Gesture, divers: Set[str]) -> Gesture | None:
    """Return a gesture with the demonstrations by some divers alone; None where there are none."""
    shown = enumerate(gesture.single_demonstrations())
    return gesture.without_demonstrations([at for at, each in shown if each.diver not in divers])


def judge(result: Recognition | None, label: str) -> tuple[Outcome, tuple[str, ...]]:
    """Return the outcome of a take of a gesture, and the labels that it is read as."""
    if result is None:
        return "refused", ()
    if result.pair is not None:
        return ("asked" if label in result.pair else "wrong"), result.pair
    if result.label is None:
        return "refused", (result.nearest,)
    return ("right" if result.label == label else "wrong"), (result.label,)
