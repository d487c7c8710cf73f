"""Accuracy on other people, with one person's demonstrations and with several people's.

Columns of a set's table: `same person` and `another` have one take of each class by one person, and
queries by that person (by anybody where people are not known) and by everybody else. The other
columns (one take or two by one person, one take each by two, three and five people) share their
queries, which are by people who show nothing, or by anybody where people are not known. Rows:

- `nearest`: share of takes whose nearest gesture is right; plain DTW of positions, of velocities
  and of both stands beside it;
- `right rejected`: share of right nearest gestures that are rejected all the same;
- `half: ...`: the same where a random half of the classes is the language, and of what it lacks
  the share that is accepted: takes of the other classes (`near`), and, for whole bodies, movements
  of people who do not sign (`far`);
- asking back, whether or not a take is rejected: the answer has every gesture whose score is at
  most `--ratio` times the best one. `wrong alone` is the share of wrong nearest gestures that are
  the whole answer.

With ``--forecasts`` instead: what the health check foretells from the demonstrations of two, three
and five people (each person's read by those of the others), beside what the takes of the people who
show nothing are read as with the same language; of one person only the latter.

With ``--choose`` instead: half of the classes, chosen by three people's demonstrations, by those of
one of them, and at random. The same three show these languages to everybody else; gains are means
over draws of the share right, in points, with their 95 % interval.

Shares are of all draws together; the interval is Wilson's, which does not know that takes of one
draw share demonstrations. ``--json`` also has every draw's counts, so that two versions of the
recogniser can be compared draw by draw.

    python -m benchmarks.accuracy.people ../shared/data --draws 8 --queries 60
    python -m benchmarks.accuracy.people ../shared/data --draws 20 --queries 60 --forecasts
    python -m benchmarks.accuracy.people ../shared/data --draws 50 --queries 40 --choose
"""

from __future__ import annotations

import json
from argparse import Namespace
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from app.evaluation.share import Share
from app.recognition import (
    Gesture,
    Language,
    PoseError,
    Recognition,
    Recognizer,
)
from app.recognition.decision.outcome import ASK_RATIO
from app.recognition.gestures.demonstration import MAX_DEMONSTRATIONS
from app.recognition.health.choice import measure_confusions
from app.recognition.health.forecast import (
    ENOUGH_PEOPLE,
    OUTCOMES,
    Outcome,
    make_forecast,
    measure_curve,
)
from app.recognition.health.forecast import judge as find_outcome
from benchmarks.arguments import set_arguments
from benchmarks.methods.ours import teach
from benchmarks.methods.plain_dtw import plain_dtw
from benchmarks.sets.every_set import all_sets, count_people, is_of_bodies
from benchmarks.sets.held_signs import HAND_LETTERS
from benchmarks.sets.one_shot_draws import Draw, SeveralPeople, draw_several, draws
from benchmarks.sets.recorded_sets import RecordedSet
from benchmarks.sets.whole_body_sets import far_movements

SHOWN = {
    "1 person": (1, 1),
    "2 takes": (1, 2),
    "2 people": (2, 1),
    "3 people": (3, 1),
    "5 people": (5, 1),
}
"""Who shows every gesture of a language: number of people, and of takes by each."""

COLUMNS = ("same person", "another", *SHOWN)

SIZE = "size of answer"
"""The measure that is a mean, not a share."""

MEASURES = (
    "nearest",
    "DTW positions",
    "DTW velocities",
    "DTW of both",
    "right rejected",
    "half: right rejected",
    "half: near accepted",
    "half: far accepted",
    "wrong alone",
    "right in answer",
    SIZE,
)
"""Rows of the table."""

Found = Iterator[tuple[str, int]]
"""Measures of one query: name and value, 0 or 1, or the size of the answer."""

Counts = dict[tuple[str, str], dict[int, list[int]]]
"""Values of a set by column and measure, by number of the draw."""


def define(recorded: RecordedSet, takes: Sequence[int]) -> Gesture:
    """Make a gesture of one take or several, with the people who show them."""
    return teach(recorded.show(takes))


def judge(result: Recognition | None, label: str, ratio: float) -> Found:
    """Yield what a take of a gesture of the language tells; None: it cannot be compared."""
    right = result is not None and result.nearest == label
    yield "nearest", right
    if result is None:
        return
    if right:
        yield "right rejected", result.outcome == "rejected"
    bound = ratio * float(result.scores.min())
    answer = [
        name for name, score in zip(result.gestures, result.scores, strict=True) if score <= bound
    ]
    if not right:
        yield "wrong alone", len(answer) == 1
    yield "right in answer", label in answer
    yield SIZE, len(answer)


def judge_half(result: Recognition | None, label: str, language: Language) -> Found:
    """Yield what a take tells whose gesture the language may lack."""
    accepted = result is not None and result.outcome != "rejected"
    if label not in language.labels:
        yield "half: near accepted", accepted
    elif result is not None and result.nearest == label:
        yield "half: right rejected", not accepted


def recognize(
    recognizer: Recognizer, recorded: RecordedSet, queries: npt.NDArray[np.intp]
) -> Iterator[tuple[Recognition | None, str]]:
    """Yield the result of each query, None where nothing can be compared, and its class."""
    for query in queries:
        result = None
        with suppress(PoseError):
            result = recognizer.recognize(recorded.recordings[query])
        yield result, str(recorded.labels[query])


def score(
    recorded: RecordedSet,
    rows: Sequence[Sequence[int]],
    recognizer: Recognizer,
    queries: npt.NDArray[np.intp],
    ratio: float,
) -> Found:
    """Yield the measures of queries to a language that has all classes.

    Parameters
    ----------
    recorded
        The set.
    rows
        Per gesture its takes.
    recognizer
        Of these gestures.
    queries
        Indices of recordings.
    ratio
        Largest ratio to the best score in an answer, see `ASK_RATIO`.

    """
    for result, label in recognize(recognizer, recorded, queries):
        yield from judge(result, label, ratio)
    taken = [take for row in rows for take in row]
    compare = plain_dtw([recorded.recordings[take] for take in taken])
    for query in queries:
        for method, distances in compare(recorded.recordings[query]).items():
            nearest = recorded.labels[taken[int(distances.argmin())]]
            yield method, bool(nearest == recorded.labels[query])


def score_half(
    recorded: RecordedSet, recognizer: Recognizer, several: SeveralPeople, far: RecordedSet
) -> Found:
    """Yield the measures of queries, and of as many far movements, to a language of a half."""
    for result, label in recognize(recognizer, recorded, several.queries):
        yield from judge_half(result, label, recognizer.language)
    if is_of_bodies(recorded):
        order = np.random.default_rng(several.queries).permutation(len(far.recordings))
        for result, _ in recognize(recognizer, far, order[: len(several.queries)]):
            yield "half: far accepted", result is not None and result.outcome != "rejected"


def measure(
    recorded: RecordedSet, chosen: Draw, several: SeveralPeople, far: RecordedSet, ratio: float
) -> Iterator[tuple[str, str, int]]:
    """Yield column, measure and value of every query of one draw."""
    for column, (people, takes) in SHOWN.items():
        if people > len(several.takes):
            continue
        rows = several.rows(people, takes)
        gestures = [define(recorded, row) for row in rows]
        whole = Recognizer(Language(recorded.name, gestures), "full")
        asked = {column: several.queries}
        if (people, takes) == (1, 1):
            asked |= {"same person": chosen.own, "another": chosen.others}
        for of_column, queries in asked.items():
            for name, value in score(recorded, rows, whole, queries, ratio):
                yield of_column, name, value
        kept = [gesture for gesture in gestures if gesture.label in several.half]
        half = Recognizer(Language(recorded.name, kept), "full")
        for name, value in score_half(recorded, half, several, far):
            yield column, name, value


def summarize(name: str, by_draw: Sequence[Sequence[int]]) -> dict[str, Any]:
    """Return a measure as plain JSON types, with sum and number of values of every draw."""
    counts = [[sum(values), len(values)] for values in by_draw]
    total, asked = np.sum(counts, axis=0).tolist()
    whole = {"mean": total / asked} if name == SIZE else Share(total, asked).to_dict()
    return {**whole, "asked": asked, "draws": counts}


def print_table(recorded: RecordedSet, found: Counts) -> None:
    """Print one line a measure, one column for each way to show the gestures."""
    for name in MEASURES:
        cells = []
        for column in COLUMNS:
            values = [value for of_draw in found[column, name].values() for value in of_draw]
            share = str(Share(sum(values), len(values))) if name != SIZE else "-"
            cells.append(f"{np.mean(values):.2f}" if name == SIZE and values else share)
        print(f"{recorded.name:16} {name:21}" + "".join(f"{cell:>19}" for cell in cells))
    numbers = [
        sum(len(of_draw) for of_draw in found[column, "nearest"].values()) for column in COLUMNS
    ]
    people = count_people(recorded) or "unknown"
    print(
        f"{recorded.name:16} {f'takes, {people} people':21}"
        + "".join(f"{number:>19}" for number in numbers),
        flush=True,
    )


Outcomes = dict[str, Counter[Outcome]]
"""Outcomes ``foretold`` and ``reached``."""


def count_outcomes(recorded: RecordedSet, several: SeveralPeople, people: int) -> Outcomes:
    """Count the outcomes of the demonstrations of some people, and of the queries to them."""
    gestures = [define(recorded, row) for row in several.rows(people)]
    language = Language(recorded.name, gestures)
    asked = recognize(Recognizer(language, "full"), recorded, several.queries)
    return {
        "foretold": Counter(each.outcome for each in make_forecast(language).readings),
        "reached": Counter(find_outcome(*each)[0] for each in asked),
    }


def measure_excess(outcomes: Outcomes) -> float | None:
    """Return by how many points more is foretold right than reached; None without a forecast."""
    foretold, reached = outcomes["foretold"], outcomes["reached"]
    if not foretold or not reached:
        return None
    return 100 * (foretold["right"] / foretold.total() - reached["right"] / reached.total())


def format_forecast(name: str, column: str, by_draw: Sequence[Outcomes]) -> str:
    """Format a row of Markdown: foretold / reached by outcome, and how far both are apart."""
    whole = sum_outcomes(by_draw)
    shares = [[Share(of[outcome], of.total()) for of in whole.values()] for outcome in OUTCOMES]
    right = " / ".join(map(str, shares[0]))
    others = [
        " / ".join("-" if each.value is None else f"{each.value:.1%}" for each in both)
        for both in shares[1:]
    ]
    excess = measure_excess(whole)
    each_draw = [abs(one) for draw in by_draw if (one := measure_excess(draw)) is not None]
    apart = ["-", "-"] if excess is None else [f"{excess:+.1f}", f"{np.mean(each_draw):.1f}"]
    numbers = " / ".join(str(of.total()) for of in whole.values())
    return f"| {' | '.join([name, column, numbers, right, *others, *apart])} |"


def sum_outcomes(by_draw: Sequence[Outcomes]) -> Outcomes:
    """Add up the outcomes of all draws."""
    return {
        when: sum((each[when] for each in by_draw), Counter[Outcome]())
        for when in ("foretold", "reached")
    }


def compare_forecasts(sets: Iterator[RecordedSet], given: Namespace) -> None:
    """Print what several people's demonstrations foretell beside what further people reach."""
    columns = {name: people for name, (people, takes) in SHOWN.items() if takes == 1}
    print("| set | shown by | n | right | asked | refused | wrong | above | by language |")
    print("| --- " * 9 + "|")
    found: dict[str, list[float]] = defaultdict(list)
    for recorded in sets:
        if count_people(recorded) is None:
            continue
        by_column: dict[str, list[Outcomes]] = defaultdict(list)
        for number, chosen in enumerate(draws(recorded, given.draws, given.queries, given.seed)):
            several = draw_several(
                recorded, chosen, max(columns.values()), given.queries, given.seed + number
            )
            for column, people in columns.items():
                if people <= len(several.takes):
                    by_column[column].append(count_outcomes(recorded, several, people))
        for column, by_draw in by_column.items():
            print(format_forecast(recorded.name, column, by_draw), flush=True)
            if (excess := measure_excess(sum_outcomes(by_draw))) is not None:
                found[column].append(excess)
    for column, excesses in found.items():
        print(
            f"{column}: foretold minus reached {np.mean(excesses):+.1f} points on average, "
            f"{np.mean(np.abs(excesses)):.1f} without sign, {min(excesses):+.1f} to "
            f"{max(excesses):+.1f}"
        )


def compare_stops(sets: Iterator[RecordedSet], given: Namespace) -> None:
    """Print after how many people the check asks for no more, and what further people then reach.

    The people of a draw show the language one after the other, at most eight and all but one.
    """
    print("| set | languages | people at the stop | right: of one | at the stop | of all | all |")
    print("| --- " * 7 + "|")
    for recorded in sets:
        stops, right = list[int](), defaultdict[str, Counter[Outcome]](Counter)
        for number, chosen in enumerate(draws(recorded, given.draws, given.queries, given.seed)):
            several = draw_several(
                recorded, chosen, MAX_DEMONSTRATIONS, given.queries, given.seed + number
            )
            everybody = len(several.takes)
            if everybody < ENOUGH_PEOPLE:
                break
            counts = range(1, everybody)
            enough = (each for each in counts if not asks_more(recorded, several, each))
            stops.append(next(enough, everybody))
            for name, people in (("one", 1), ("stop", stops[-1]), ("all", everybody)):
                right[name].update(count_outcomes(recorded, several, people)["reached"])
        if stops:
            shares = [str(Share(of["right"], of.total())) for of in right.values()]
            spread = f"{np.mean(stops):.1f} ({min(stops)}-{max(stops)})"
            cells = [recorded.name, len(stops), spread, *shares, everybody]
            print(f"| {' | '.join(map(str, cells))} |", flush=True)


def asks_more(recorded: RecordedSet, several: SeveralPeople, people: int) -> bool:
    """Return whether the check of a language shown by some people asks for one more."""
    gestures = [define(recorded, row) for row in several.rows(people)]
    language = Language(recorded.name, gestures)
    forecast = make_forecast(language)
    return replace(forecast, curve=measure_curve(language, forecast)).asks_more


CHOOSING = ("digits", "letters", "commands", "utd_other", "utd_signals", HAND_LETTERS)
"""Sets of which halves are chosen."""


def measure_halves(
    recorded: RecordedSet, several: SeveralPeople, queries: int, seed: int
) -> dict[str, float]:
    """Return the per cent read right of half of the classes, by who has chosen the half."""
    one, three = (
        Language(recorded.name, [define(recorded, row) for row in several.rows(people)])
        for people in (1, 3)
    )
    count = max(2, len(three.gestures) // 2)
    halves = {
        "three people": measure_confusions(three).choose(count),
        "one person": measure_confusions(one).choose(count),
        "random": np.random.default_rng(seed).permutation(len(three.gestures))[:count].tolist(),
    }
    order = np.random.default_rng(seed).permutation(several.queries)
    right = {}
    for name, half in halves.items():
        language = Language(recorded.name, [three.gestures[index] for index in sorted(half)])
        asked = order[np.isin(recorded.labels[order].astype(str), language.labels)][:queries]
        results = recognize(Recognizer(language, "full"), recorded, asked)
        right[name] = 100 * float(np.mean([find_outcome(*each)[0] == "right" for each in results]))
    return right


def format_gain(gains: Sequence[float]) -> str:
    """Format the mean of draws' gains, and its 95 % interval by the normal distribution."""
    mean = float(np.mean(gains))
    half = 1.96 * float(np.std(gains, ddof=1)) / np.sqrt(len(gains)) if len(gains) > 1 else np.nan
    return f"{mean:+.1f} ({mean - half:+.1f} to {mean + half:+.1f})"


def compare_choices(sets: Iterator[RecordedSet], given: Namespace) -> None:
    """Print what further people reach with a chosen half of the classes, and with a random one."""
    print("| set | draws | three people | one person | random | gain | over one person's choice |")
    print("| --- " * 7 + "|")
    for recorded in sets:
        found: list[dict[str, float]] = []
        for seed, chosen in enumerate(draws(recorded, given.draws, 1, given.seed), given.seed):
            several = draw_several(recorded, chosen, 3, len(recorded.recordings), seed)
            if len(several.takes) == 3:
                found.append(measure_halves(recorded, several, given.queries, seed))
        if found:
            three, one, random = (np.array([each[name] for each in found]) for name in found[0])
            means = [f"{values.mean():.1f}" for values in (three, one, random)]
            gains = [format_gain(three - other) for other in (random, one)]
            cells = [recorded.name, len(found), *means, *gains]
            print(f"| {' | '.join(map(str, cells))} |", flush=True)


def main() -> None:
    """Print the table of every set, and write the JSON file after each."""
    parser = set_arguments(__doc__, draws=8, queries=60)
    parser.add_argument("--ratio", type=float, default=ASK_RATIO, help="of scores in one answer")
    parser.add_argument("--json", type=Path, help="file for all counts, draw by draw")
    parser.add_argument("--forecasts", action="store_true", help="forecasts alone")
    parser.add_argument("--stops", action="store_true", help="number of people asked for, alone")
    parser.add_argument(
        "--choose", action="store_true", help="choice of half of the classes, alone"
    )
    given = parser.parse_args()
    folder = given.data / "trajectories"
    if given.choose:
        compare_choices(all_sets(folder, given.sets or CHOOSING), given)
        return
    if given.stops:
        compare_stops(all_sets(folder, given.sets), given)
        return
    if given.forecasts:
        compare_forecasts(all_sets(folder, given.sets), given)
        return
    far = far_movements(folder)
    most = max(people for people, _ in SHOWN.values())
    report: dict[str, Any] = {
        "arguments": {name: getattr(given, name) for name in ("draws", "queries", "seed", "ratio")},
        "sets": {},
    }
    print(f"{'set':16} {'':21}" + "".join(f"{column:>19}" for column in COLUMNS), flush=True)
    for recorded in all_sets(folder, given.sets):
        found: Counts = defaultdict(lambda: defaultdict(list))
        for number, chosen in enumerate(draws(recorded, given.draws, given.queries, given.seed)):
            several = draw_several(recorded, chosen, most, given.queries, given.seed + number)
            for column, name, value in measure(recorded, chosen, several, far, given.ratio):
                found[column, name][number].append(int(value))
        print_table(recorded, found)
        measured: dict[str, dict[str, Any]] = defaultdict(dict)
        for (column, name), by_draw in found.items():
            if by_draw:
                in_order = [by_draw.get(number, []) for number in range(given.draws)]
                measured[column][name] = summarize(name, in_order)
        report["sets"][recorded.name] = {
            "people": count_people(recorded),
            "recordings": len(recorded.recordings),
            "classes": len(np.unique(recorded.labels)),
            "measured": measured,
        }
        if given.json:
            given.json.write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
