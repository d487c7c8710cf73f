"""Alike pairs: whether demonstrations tell which gestures other people's takes mix up.

Languages are drawn from sets of several people, one demonstration a gesture by one person; takes by
the others are read. A pair is mixed up if at least `LEAST_TAKES` takes of the two, and a tenth of
them, are read as the other one or asked back with it. Each measure of the two demonstrations names
the pairs below its threshold, the largest at which two of three named ones are mixed up, chosen
without the set on which it is counted.

    python -m benchmarks.alike_pairs ../shared/data
"""

from __future__ import annotations

import itertools
from argparse import ArgumentParser
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from app.recognition import Language, OsgError, Recognizer
from app.recognition.explanation.causes import ALIKE
from app.recognition.explanation.strokes import transcribe_gesture
from app.recognition.explanation.transcript import compare_transcripts
from app.recognition.poses.sequence import FloatArray
from benchmarks.sets.every_set import all_sets
from benchmarks.sets.one_shot_draws import Draw, demonstrated, draws
from benchmarks.sets.recorded_sets import RecordedSet

SETS: Final = ("digits", "letters", "commands", "utd_signals", "utkinect", "utd_other")

DRAWS, QUERIES, SEED = 4, 60, 91

LEAST_TAKES: Final = 2
LEAST_SHARE: Final = 0.1
LEAST_SHOWN: Final = 4
"""Fewest takes of the two gestures of a pair that counts."""

WANTED: Final = 2 / 3
"""Least share of the named pairs that are mixed up."""


@dataclass(frozen=True)
class Pair:
    """Two gestures of a drawn language.

    Attributes
    ----------
    set_name
        The set.
    is_mixed
        Whether other people's takes mix them up.
    measures
        What their demonstrations say by name: small is alike.

    """

    set_name: str
    is_mixed: bool
    measures: dict[str, float]


def count_mixed(recognizer: Recognizer, recorded: RecordedSet, draw: Draw) -> FloatArray:
    """Count takes ``(G, G + 1)`` of each gesture by what they may be read as; last: all of it."""
    labels = recognizer.language.labels
    counts = np.zeros((len(labels), len(labels) + 1))
    for query in draw.others:
        own = labels.index(str(recorded.labels[query]))
        try:
            result = recognizer.recognize(recorded.recordings[query])
        except OsgError:
            continue
        counts[own, -1] += 1
        for label in {result.label, *result.between} - {None}:
            counts[own, labels.index(str(label))] += 1
    return counts


def list_pairs(recorded: RecordedSet) -> Iterator[Pair]:
    """Yield the pairs of the languages drawn from a set."""
    for draw in draws(recorded, DRAWS, QUERIES, SEED):
        gestures = demonstrated(recorded, draw.templates)
        recognizer = Recognizer(Language(recorded.name, gestures), "full")
        counts = count_mixed(recognizer, recorded, draw)
        tables = [recognizer.compare(each.trajectory) for each in gestures if each.trajectory]
        novelty = np.array([table.novelty for table in tables])
        scores = np.array([table.scores for table in tables])
        strokes = [transcribe_gesture(each) for each in gestures]
        for a, b in itertools.combinations(range(len(gestures)), 2):
            shown, mixed = counts[[a, b], -1].sum(), counts[a, b] + counts[b, a]
            if shown < LEAST_SHOWN:
                continue
            near, far = sorted((float(novelty[a, b]), float(novelty[b, a])))
            others = [np.median(np.delete(novelty[each], (a, b))) for each in (a, b)]
            same = compare_transcripts(strokes[a], strokes[b]).differs is None
            measures = {
                "smaller novelty": near,
                "larger novelty": far,
                "smaller novelty, half for the same strokes": near / 2 if same else near,
                "mean novelty over that of other gestures": (near + far) / 2 / np.mean(others),
                "smaller fused distance": float(min(scores[a, b], scores[b, a])),
            }
            is_mixed = mixed >= max(LEAST_TAKES, LEAST_SHARE * shown)
            yield Pair(recorded.name, bool(is_mixed), measures)


def choose(pairs: list[Pair], measure: str) -> float:
    """Return the largest value up to which `WANTED` pairs are mixed up; minus infinity: none."""
    ordered = sorted(pairs, key=lambda pair: pair.measures[measure])
    truth = np.cumsum([pair.is_mixed for pair in ordered])
    good = np.flatnonzero(truth >= WANTED * np.arange(1, len(ordered) + 1))
    return ordered[good[-1]].measures[measure] if len(good) else -np.inf


def main() -> None:
    """Print how many pairs each measure names, truly and in vain."""
    parser = ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("data", type=Path, help="the folder that holds trajectories/")
    folder = parser.parse_args().data / "trajectories"
    pairs = [pair for recorded in all_sets(folder, list(SETS)) for pair in list_pairs(recorded)]
    mixed = sum(pair.is_mixed for pair in pairs)
    print(f"{len(pairs)} pairs, {mixed} mixed up by others")
    today = [pair for pair in pairs if pair.measures["smaller novelty"] < ALIKE]
    true = sum(pair.is_mixed for pair in today)
    print(
        f"{f'smaller novelty below {ALIKE}, as now':46} {true} truly, {len(today) - true} in vain"
    )
    for measure in pairs[0].measures:
        named: list[Pair] = []
        for name in SETS:
            limit = choose([pair for pair in pairs if pair.set_name != name], measure)
            own = (pair for pair in pairs if pair.set_name == name)
            named += [pair for pair in own if pair.measures[measure] <= limit]
        true = sum(pair.is_mixed for pair in named)
        print(f"{measure:46} {true} truly, {len(named) - true} in vain")


if __name__ == "__main__":
    main()
