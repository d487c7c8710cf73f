"""Demonstrations by several people: what they foretell, what they reach, which gestures to choose.

A language is shown by one person with one take or two of each class, and by two, three and five
people with one each; takes of people who show nothing are asked about. `foretold` is what the
health check says from the demonstrations alone, each person's read by those of the others;
`reached` is what the takes are read as by the same language. Nothing in a forecast was fitted, so
that every set is left out.

*Live*: the takes are sent by an invitation as their own gesture (`right`), and as another one of
the language (`wrong`). A take goes live unasked if it is read as what it was sent as, with at least
a confidence.

*Stops*: people show a language one after the other until the check asks for no more, at most eight
and all but one. *Choosing*: half of the classes, chosen by three people's demonstrations, by those
of one of them, and at random; the same three show these languages to everybody else.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from app.recognition import Gesture, Language, PoseError, Recognition, Recognizer
from app.recognition.gestures.demonstration import MAX_DEMONSTRATIONS
from app.recognition.health.choice import measure_confusions
from app.recognition.health.forecast import (
    ENOUGH_PEOPLE,
    OUTCOMES,
    Outcome,
    judge,
    make_forecast,
    measure_curve,
)
from benchmarks.figures import Figure, Measurement, Results, mean, share, table
from benchmarks.methods.ours import teach
from benchmarks.sets.every_set import measure_sets
from benchmarks.sets.held_signs import HAND_LETTERS
from benchmarks.sets.one_shot_draws import SeveralPeople, draw_several, draws
from benchmarks.sets.recorded_sets import DOMAINS, RecordedSet
from benchmarks.sets.simulated_bodies import CARRIED
from benchmarks.sets.whole_body_sets import ARM_CLASSES

SHOWN = {"1": (1, 1), "1-twice": (1, 2), "2": (2, 1), "3": (3, 1), "5": (5, 1)}
"""Who shows every gesture of a language: number of people, and of takes by each."""

WHEN = ("foretold", "reached")
CHOSEN_BY = ("three-people", "one-person", "random")

CONFIDENCES = (0, 25, 50)
"""Least confidences in per cent with which a take goes live; the studio's is 25."""

CHOOSING = ("digits", "letters", "commands", "utd_other", "utd_signals", HAND_LETTERS)
"""Sets of which halves are chosen."""


def define(recorded: RecordedSet, takes: Sequence[int]) -> Gesture:
    """Make a gesture of one take or several, with the people who show them."""
    return teach(recorded.show(takes))


def recognize(
    recognizer: Recognizer, recorded: RecordedSet, queries: npt.NDArray[np.intp]
) -> Iterator[tuple[Recognition | None, str]]:
    """Yield the result of each query, None where nothing can be compared, and its class."""
    for query in queries:
        result = None
        with suppress(PoseError):
            result = recognizer.recognize(recorded.recordings[query])
        yield result, str(recorded.labels[query])


def draw_people(
    recorded: RecordedSet, count: int, most: int, queries: int
) -> Iterator[SeveralPeople]:
    """Draw languages shown by up to so many people, and queries by those who show nothing."""
    for number, chosen in enumerate(draws(recorded, count, queries, seed=1)):
        yield draw_several(recorded, chosen, most, queries, 1 + number)


def make_language(
    recorded: RecordedSet, several: SeveralPeople, people: int, takes: int = 1
) -> Language:
    """Make the language of the first people."""
    gestures = [define(recorded, row) for row in several.rows(people, takes)]
    return Language(recorded.name, gestures)


@dataclass
class Tally:
    """What was counted of a set's languages that the same people show, one entry a language.

    Attributes
    ----------
    foretold, reached
        Outcomes of the check's readings, and of takes of people who show nothing.
    live
        Takes that would go live unasked, by what they were sent as and from which confidence.

    """

    foretold: list[Counter[Outcome]] = field(default_factory=list)
    reached: list[Counter[Outcome]] = field(default_factory=list)
    live: Counter[str] = field(default_factory=Counter)

    def count(
        self,
        language: Language,
        read: Sequence[tuple[Recognition | None, str]],
        generator: np.random.Generator,
    ) -> None:
        """Count the readings of one language and of the takes that it was asked about."""
        self.foretold.append(Counter(each.outcome for each in make_forecast(language).readings))
        self.reached.append(Counter(judge(*each)[0] for each in read))
        for result, label in read:
            wrong = str(generator.choice([each for each in language.labels if each != label]))
            if result is None:
                continue
            for least in CONFIDENCES:
                if result.confidence >= least / 100:
                    self.live[f"right-from-{least}"] += result.label == label
                    self.live[f"wrong-from-{least}"] += result.label == wrong

    def figures(self, column: str) -> Iterator[Figure]:
        """Yield the shares of all languages together, and how far both are apart."""
        foretold, reached = (
            sum(each, Counter[Outcome]()) for each in (self.foretold, self.reached)
        )
        for when, counts in zip(WHEN, (foretold, reached), strict=True):
            for outcome in OUTCOMES if counts else ():
                yield share(f"{when}/{column}/{outcome}", counts[outcome], counts.total())
        for name, happened in self.live.items():
            yield share(f"live/{column}/{name}", happened, reached.total())
        if foretold:
            apart = np.array(
                [100 * (a["right"] / a.total() - b["right"] / b.total()) for a, b in self.pairs()]
            )
            above = foretold["right"] / foretold.total() - reached["right"] / reached.total()
            yield Figure(f"above/{column}", 100 * above, len(apart), unit="points")
            yield Figure(f"single/{column}", float(np.abs(apart).mean()), len(apart), unit="")

    def pairs(self) -> Iterator[tuple[Counter[Outcome], Counter[Outcome]]]:
        """Yield what was foretold and reached of each language."""
        yield from zip(self.foretold, self.reached, strict=True)


def measure_people(recorded: RecordedSet, quick: bool) -> Iterator[Figure]:
    """Yield what is foretold, reached and live, by who shows the language."""
    tallies: dict[str, Tally] = defaultdict(Tally)
    generator = np.random.default_rng(1)
    for several in draw_people(recorded, 2 if quick else 8, 5, 60):
        for column, (people, takes) in SHOWN.items():
            if people <= len(several.takes):
                language = make_language(recorded, several, people, takes)
                read = [*recognize(Recognizer(language, "full"), recorded, several.queries)]
                tallies[column].count(language, read, generator)
    for column, tally in tallies.items():
        yield from tally.figures(column)


def measure_stops(recorded: RecordedSet, quick: bool) -> Iterator[Figure]:
    """Yield after how many people the check asks for no more, and what further people reach."""
    stops, right = list[int](), defaultdict[str, Counter[Outcome]](Counter)
    for several in draw_people(recorded, 2 if quick else 8, MAX_DEMONSTRATIONS, 60):
        everybody = len(several.takes)
        if everybody < ENOUGH_PEOPLE:
            return
        enough = (each for each in range(1, everybody) if not asks_more(recorded, several, each))
        stops.append(next(enough, everybody))
        for name, people in (("one", 1), ("stop", stops[-1]), ("all", everybody)):
            recognizer = Recognizer(make_language(recorded, several, people), "full")
            for each in recognize(recognizer, recorded, several.queries):
                right[name][judge(*each)[0]] += 1
    yield Figure("people", float(np.mean(stops)), len(stops), (min(stops), max(stops)), "")
    for name, counts in right.items():
        yield share(name, counts["right"], counts.total())


def asks_more(recorded: RecordedSet, several: SeveralPeople, people: int) -> bool:
    """Return whether the check of a language shown by some people asks for one more."""
    language = make_language(recorded, several, people)
    forecast = make_forecast(language)
    return replace(forecast, curve=measure_curve(language, forecast)).asks_more


def measure_choice(recorded: RecordedSet, quick: bool) -> Iterator[Figure]:
    """Yield what further people reach with a chosen half of the classes, and with a random one."""
    found: list[dict[str, float]] = []
    for seed, chosen in enumerate(draws(recorded, 6 if quick else 50, 1, seed=1), 1):
        several = draw_several(recorded, chosen, 3, len(recorded.recordings), seed)
        if len(several.takes) == 3:
            found.append(measure_halves(recorded, several, 40, seed))
    by_name = {name: np.array([each[name] for each in found]) for name in found[0]}
    for name, values in by_name.items():
        yield mean(name, values.tolist(), "%")
    three, one, random = by_name.values()
    yield mean("gain", (100 * (three - random)).tolist(), "points")
    yield mean("over-one", (100 * (three - one)).tolist(), "points")


def measure_halves(
    recorded: RecordedSet, several: SeveralPeople, queries: int, seed: int
) -> dict[str, float]:
    """Return the share read right of half of the classes, by who has chosen the half."""
    one, three = (make_language(recorded, several, people) for people in (1, 3))
    count = max(2, len(three.gestures) // 2)
    halves = {
        "three-people": measure_confusions(three).choose(count),
        "one-person": measure_confusions(one).choose(count),
        "random": np.random.default_rng(seed).permutation(len(three.gestures))[:count].tolist(),
    }
    order = np.random.default_rng(seed).permutation(several.queries)
    right = {}
    for name, half in halves.items():
        language = Language(recorded.name, [three.gestures[index] for index in sorted(half)])
        asked = order[np.isin(recorded.labels[order].astype(str), language.labels)][:queries]
        results = recognize(Recognizer(language, "full"), recorded, asked)
        right[name] = float(np.mean([judge(*each)[0] == "right" for each in results]))
    return right


def measurements(folder: Path, methods: tuple[str, ...]) -> Iterator[Measurement]:
    """Yield forecasts, stops and choices on the sets that name people."""
    named = (*DOMAINS, *ARM_CLASSES, *CARRIED)
    languages = "8 languages by 1, 2, 3 and 5 people, 60 takes each by people who show nothing"
    yield from measure_sets("people", folder, named, measure_people, languages)
    stopping = "8 languages shown by one person after the other until the check asks for no more"
    yield from measure_sets("stops", folder, named[:7], measure_stops, stopping)
    choosing = "half of the classes for three people, up to 50 draws, 40 takes each by others"
    yield from measure_sets("choosing", folder, CHOOSING, measure_choice, choosing)


def write_people(results: Results) -> str:
    """Write what is reached by how many people show a language, and what three people foretell."""
    rows = [
        [
            name,
            *(results.show(f"people/{name}", f"reached/{each}/right", "bare?") for each in SHOWN),
            results.show(f"people/{name}", "foretold/3/right", "cell"),
            *(
                results.show(f"people/{name}", each, "bare?")
                for each in ("above/2", "above/3", "above/5", "single/3")
            ),
        ]
        for name in results.names("people")
    ]
    head = ("set", "1 person", "1, two takes", "2 people", "3", "5", "foretold from 3")
    return table((*head, "above, points: 2 people", "3", "5", "single: 3"), rows)


def write_live(results: Results) -> str:
    """Write how many takes go live unasked, by their least confidence."""
    rows = []
    for name in (each for each in results.names("people") if each in ARM_CLASSES):
        cells = [
            " / ".join(
                results.show(f"people/{name}", f"live/{people}/{sent}-from-{least}", "bare")
                for sent in ("right", "wrong")
            )
            for people in ("1", "3")
            for least in CONFIDENCES
        ]
        rows.append([name, *cells])
    head = ["set", *(f"{who}, from {each} %" for who in ("1", "3") for each in CONFIDENCES)]
    return table(head, rows)


def write_stops(results: Results) -> str:
    """Write after how many people the check asks for no more, and what that reaches."""
    rows = [
        [
            name,
            results.show(f"stops/{name}", "people"),
            *(results.show(f"stops/{name}", each, "cell") for each in ("one", "stop", "all")),
        ]
        for name in results.names("stops")
    ]
    return table(
        ("set", "people at the stop", "right, %: one person", "at the stop", "seven or eight"), rows
    )


def write_choices(results: Results) -> str:
    """Write what a choice of gestures gains."""
    rows = [
        [
            name,
            results.show(f"choosing/{name}", "gain", "n"),
            *(results.show(f"choosing/{name}", each, "bare") for each in CHOSEN_BY),
            *(results.show(f"choosing/{name}", each) for each in ("gain", "over-one")),
        ]
        for name in results.names("choosing")
    ]
    head = ("set", "draws", "three people", "one person", "random", "gain", "over one person's")
    return table(head, rows)


TABLES = {
    "people": write_people,
    "live": write_live,
    "stops": write_stops,
    "choices": write_choices,
}
