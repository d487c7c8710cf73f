"""Several demonstrations: accuracy on further people, by how many takes and people show a gesture.

Each language has one take of every class by one person, two takes by one person, or one take each
by two or three people. Queries are by people who show none of these takes, and are the same for all
these languages. Plain DTW, which takes the nearest template of all, stands beside the profiles.

    python -m benchmarks.accuracy.several_demonstrations ../shared/data --sets utd_other utkinect
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.evaluation.proportion import Share
from app.recognition import Gesture, GestureError, Language, PoseError, Recognizer
from app.recognition.gestures.profile import PROFILES
from app.recognition.matching.dtw import dtw_distances
from benchmarks.accuracy.people import BAND, all_sets, positions, velocities
from benchmarks.arguments import set_arguments
from benchmarks.methods.ours import gesture_of
from benchmarks.sets.recorded_sets import RecordedSet

SHOWN = ("1 take", "2 takes", "2 people", "3 people")
"""Who shows every gesture of a language."""

PLAIN = {"DTW positions": positions, "DTW velocities": velocities}
"""Plain DTW, which takes the nearest template of all."""


@dataclass(frozen=True, eq=False)
class Draw:
    """Templates and queries, as indices of recordings.

    Attributes
    ----------
    templates
        Per entry of `SHOWN` its templates, one row a class.
    queries
        By people who show none of the templates.

    """

    templates: dict[str, list[list[int]]]
    queries: npt.NDArray[np.intp]


def draw_languages(recorded: RecordedSet, count: int, queries: int, seed: int) -> Iterator[Draw]:
    """Draw `count` times three people who show all classes, and queries by the others."""
    generator = np.random.default_rng(seed)
    classes = np.unique(recorded.labels)
    everyone = [
        person
        for person in np.unique(recorded.people)
        if len(np.unique(recorded.labels[recorded.people == person])) == len(classes)
    ]
    for _ in range(count if len(everyone) > 3 else 0):
        people = generator.choice(everyone, 3, replace=False)
        takes = [
            [_choose(recorded, generator, str(label), str(person)) for person in people]
            for label in classes
        ]
        templates = {
            "1 take": [row[0][:1] for row in takes],
            "2 takes": [row[0] for row in takes],
            "2 people": [[shown[0] for shown in row[:2]] for row in takes],
            "3 people": [[shown[0] for shown in row] for row in takes],
        }
        pool = np.flatnonzero(~np.isin(recorded.people, people))
        chosen = generator.choice(pool, min(queries, len(pool)), replace=False)
        yield Draw(templates, chosen)


def _choose(
    recorded: RecordedSet, generator: np.random.Generator, label: str, person: str
) -> list[int]:
    """Choose two takes of a class by a person; one, where there is no other."""
    own = np.flatnonzero((recorded.people == person) & (recorded.labels == label))
    return [int(index) for index in generator.permutation(own)[:2]]


def define(recorded: RecordedSet, takes: Sequence[int]) -> Gesture:
    """Make a gesture of one take or several."""
    first, *others = takes
    gesture = gesture_of(str(recorded.labels[first]), recorded.recordings[first])
    for take in others:
        try:
            gesture = gesture.with_demonstration(recorded.recordings[take])
        except GestureError:
            salient = recorded.recordings[take].landmarks
            gesture = gesture.with_demonstration(recorded.recordings[take], salient=salient)
    return gesture


def score(recorded: RecordedSet, drawn: Draw) -> Iterator[tuple[str, str, Share]]:
    """Yield method, who shows the gestures, and the share of right nearest gestures."""
    for shown, templates in drawn.templates.items():
        language = Language(recorded.name, [define(recorded, row) for row in templates])
        for profile in PROFILES:
            recognizer = Recognizer(language, profile)
            named = [_is_nearest(recognizer, recorded, query) for query in drawn.queries]
            yield profile, shown, Share(sum(named), len(named))
        flat = [take for row in templates for take in row]
        for method, describe in PLAIN.items():
            references = np.stack([describe(recorded.recordings[take]) for take in flat])
            nearest = [
                dtw_distances(describe(recorded.recordings[query]), references, BAND).argmin()
                for query in drawn.queries
            ]
            right = recorded.labels[np.array(flat)[nearest]] == recorded.labels[drawn.queries]
            yield method, shown, Share(int(right.sum()), len(right))


def _is_nearest(recognizer: Recognizer, recorded: RecordedSet, query: int) -> bool:
    try:
        nearest = recognizer.recognize(recorded.recordings[query]).nearest
    except PoseError:
        return False
    return nearest == str(recorded.labels[query])


def main() -> None:
    """Print one line a set and method, one column for each way to show the gestures."""
    given = set_arguments(__doc__, draws=8, queries=60).parse_args()
    print(f"{'set':10} {'method':15} " + " ".join(f"{shown:>20}" for shown in SHOWN))
    for recorded in all_sets(given.data / "trajectories", given.sets):
        right: dict[tuple[str, str], Share] = {}
        for drawn in draw_languages(recorded, given.draws, given.queries, given.seed):
            for method, shown, share in score(recorded, drawn):
                right[method, shown] = right.get((method, shown), Share(0, 0)) + share
        for method in dict.fromkeys(method for method, _ in right):
            columns = " ".join(f"{right[method, shown]!s:>20}" for shown in SHOWN)
            print(f"{recorded.name:10} {method:15} {columns}", flush=True)


if __name__ == "__main__":
    main()
