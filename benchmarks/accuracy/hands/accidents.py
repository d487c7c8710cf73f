"""Accidents: what a property of one demonstration decides that its diver may not have meant.

Random languages of eight gestures are shown once and asked with takes of other people. Each row
switches one property off that may count by itself; the first row is the program as it is. *Fires*
is the share of gestures for which the property counts. *By accident* is the same where it cannot be
meant: the two gestures of a language are the same gesture, shown by two people. For `wrist_bend` it
is the voter's weight, for salient keypoints whether the two people's differ.

    python -m benchmarks.accuracy.hands.accidents ../shared/data
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

import numpy as np
import numpy.typing as npt

from app.evaluation.share import Share
from app.recognition import Gesture, Language, PoseError, Recognizer, find_takes
from app.recognition.errors import GestureError
from app.recognition.gestures.profile import AS_THE_PROFILE, Tuning
from app.recognition.gestures.switches import Switches
from app.resources import samples_dir
from benchmarks.arguments import set_arguments
from benchmarks.sets.held_signs import HeldSigns, read_held_signs
from benchmarks.sets.recorded_sets import RecordedSet, recorded_sets
from benchmarks.sets.rendered_clips import rendered_clips
from benchmarks.sets.whole_body_sets import whole_body_sets

GESTURES = 8
"""Gestures of a language, as in the paper's Table 2."""

PAIRS = 200
"""Pairs of takes of one gesture that are compared, a set."""

RENDERED = "rendered"
"""Name of the rendered clips as one set; no two takes of a gesture are by the same person."""

OUTCOMES = ("right", "asked back with it", "asked back without it", "refused", "wrong")


Fires = Callable[[Recognizer], list[bool]]
"""Returns for each gesture of a language whether a property counts."""

Change = Callable[[Recognizer, RecordedSet], list[Gesture]]
"""Returns the gestures of a language as they are without a property, or with one that is meant."""


def _keep(recognizer: Recognizer, _: RecordedSet) -> list[Gesture]:
    return [*recognizer.language.gestures]


@dataclass(frozen=True)
class Property:
    """A property that may count by itself.

    Attributes
    ----------
    fires
        Whether it counts; for no gesture where that cannot be told.
    change
        The gestures without it.
    tuning
        In which it does not count.

    """

    fires: Fires = lambda recognizer: []
    change: Change = _keep
    tuning: Tuning = AS_THE_PROFILE


def _by_switch(name: Literal["direction", "tempo"]) -> Property:
    def fires(recognizer: Recognizer) -> list[bool]:
        found = [recognizer.sensitivity(label) for label in recognizer.language.labels]
        return [each is not None and bool(getattr(each, name)) for each in found]

    def change(recognizer: Recognizer, _: RecordedSet) -> list[Gesture]:
        return [
            replace(each, switches=Switches(**{**vars(each.switches), name: "off"}))
            for each in recognizer.language.gestures
        ]

    return Property(fires, change)


def _weighs_bends(recognizer: Recognizer) -> list[bool]:
    return [recognizer.vote.weights["wrist_bend"] > 0] * len(recognizer.language.labels)


def _asks(recognizer: Recognizer) -> list[bool]:
    asked = {label for pair in recognizer.undecided_twins for label in pair}
    return [label in asked for label in recognizer.language.labels]


def _mean_hands(recognizer: Recognizer, _: RecordedSet) -> list[Gesture]:
    """Switch the hand shapes on that the author is asked about."""
    gestures = zip(recognizer.language.gestures, _asks(recognizer), strict=True)
    return [
        replace(each, switches=replace(each.switches, hand_shape="on")) if asked else each
        for each, asked in gestures
    ]


def _with_usual_salient(recognizer: Recognizer, recorded: RecordedSet) -> list[Gesture]:
    """Take the salient keypoints of most takes of each gesture."""
    return [_take_usual(recorded, each) for each in recognizer.language.gestures]


def _take_usual(recorded: RecordedSet, gesture: Gesture) -> Gesture:
    takes = np.flatnonzero(recorded.labels == gesture.label).tolist()
    made = [make_gesture(recorded, take) for take in takes]
    usual = Counter(each.salient for each in made if each is not None and each.salient)
    try:
        return gesture.with_salient(usual.most_common(1)[0][0]) if usual else gesture
    except GestureError:
        return gesture


SALIENT = "salient keypoints"

PROPERTIES = {
    "as it is": Property(),
    "hand shape, if meant": Property(_asks, _mean_hands),
    "direction": _by_switch("direction"),
    "tempo": _by_switch("tempo"),
    "wrist bend": Property(_weighs_bends, tuning=Tuning(weights={"wrist_bend": 0.0})),
    SALIENT: Property(change=_with_usual_salient),
}


@dataclass
class Tally:
    """What was counted of one property."""

    outcomes: Counter[str] = field(default_factory=Counter)
    fired: list[bool] = field(default_factory=list)
    by_accident: list[bool] = field(default_factory=list)


def judge(recognizer: Recognizer, recorded: RecordedSet, query: int) -> str:
    """Return what a take is read as, one of `OUTCOMES`."""
    meant = str(recorded.labels[query])
    try:
        result = recognizer.recognize(recorded.recordings[query])
    except PoseError:
        return "refused"
    if result.pair is not None:
        return "asked back with it" if meant in result.pair else "asked back without it"
    if result.label is None:
        return "refused"
    return "right" if result.label == meant else "wrong"


def draw(
    recorded: RecordedSet, random: np.random.Generator, queries: int
) -> tuple[list[int], npt.NDArray[np.intp]]:
    """Draw demonstrations, by one person where one has shown all, and takes of other people."""
    labels, people = recorded.labels, recorded.people
    chosen = random.choice(np.unique(labels), min(GESTURES, len(np.unique(labels))), replace=False)
    able = [
        person
        for person in np.unique(people)
        if set(chosen) <= set(labels[people == person]) and (people != person).any()
    ]
    own = people == random.choice(able) if able else np.ones(len(labels), dtype=np.bool_)
    shown = [int(random.choice(np.flatnonzero(own & (labels == label)))) for label in chosen]
    asked = np.isin(labels, chosen) & (~own if able else True)
    asked[shown] = False
    pool = np.flatnonzero(asked)
    return shown, random.choice(pool, min(queries, len(pool)), replace=False)


_made: dict[tuple[str, int], Gesture | None] = {}


def make_gesture(recorded: RecordedSet, take: int) -> Gesture | None:
    """Return the gesture that a take shows; None where it cannot be one."""
    key = recorded.name, take
    if key not in _made:
        try:
            label = str(recorded.labels[take])
            _made[key] = Gesture.from_demonstration(label, recorded.recordings[take])
        except (GestureError, PoseError):
            _made[key] = None
    return _made[key]


def measure(recorded: RecordedSet, count: int, queries: int, seed: int) -> dict[str, Tally]:
    """Count the outcomes of every property in `count` languages, and how often it fires."""
    random = np.random.default_rng(seed)
    found = {name: Tally() for name in PROPERTIES}
    for _ in range(count):
        shown, asked = draw(recorded, random, queries)
        made = [make_gesture(recorded, take) for take in shown]
        if any(each is None for each in made):
            continue
        gestures = [each for each in made if each is not None]
        as_it_is = Recognizer(Language("drawn", gestures))
        for name, each in PROPERTIES.items():
            fired = each.fires(as_it_is)
            found[name].fired += fired
            changed = Language("drawn", each.change(as_it_is, recorded))
            recognizer = Recognizer(changed, tuning=each.tuning)
            found[name].outcomes.update(judge(recognizer, recorded, query) for query in asked)
    for one, other in draw_pairs(recorded, random):
        twins = Recognizer(Language("same", [one, replace(other, label=f"{other.label} again")]))
        for name, each in PROPERTIES.items():
            fired = each.fires(twins)
            if name == SALIENT:
                fired = [one.salient != other.salient]
            found[name].by_accident += [any(fired)] if fired else []
    return found


def draw_pairs(
    recorded: RecordedSet, random: np.random.Generator
) -> Iterator[tuple[Gesture, Gesture]]:
    """Yield gestures of two people's takes of the same one."""
    for _ in range(PAIRS):
        one = int(random.integers(len(recorded.labels)))
        same = recorded.labels == recorded.labels[one]
        others = np.flatnonzero(same & (recorded.people != recorded.people[one]))
        if not len(others):
            continue
        pair = make_gesture(recorded, one), make_gesture(recorded, int(random.choice(others)))
        if pair[0] is not None and pair[1] is not None:
            yield pair[0], pair[1]


def read_rendered(folder: Path) -> RecordedSet:
    """Read the rendered clips of both folders and the sample clips as one set."""
    recordings, labels = [], []
    for each in rendered_clips(folder, ("rendered_letters", "rendered_alike")):
        recordings += each.recordings
        labels += each.labels.tolist()
    for clip in sorted((samples_dir() / "clips").glob("*-*-*.mp4")) + sorted(
        (samples_dir() / "clips").glob("*-demonstration.mp4")
    ):
        if takes := find_takes(clip):
            recordings.append(takes[0].poses)
            labels.append(clip.stem.partition("-")[0])
    people = np.array([f"clip {index}" for index in range(len(labels))])
    return RecordedSet(RENDERED, recordings, np.array(labels), people)


def report_held(recorded: RecordedSet | HeldSigns, name: str) -> str:
    """Return how many takes are held hand shapes, and how many of these two in sequence."""
    number = len(recorded.labels)
    takes = recorded.takes if isinstance(recorded, HeldSigns) else recorded.recordings
    held, sequences = 0, 0
    for poses in takes:
        try:
            shapes = Gesture.from_demonstration("take", poses).held_shapes
        except (GestureError, PoseError):
            shapes = ()
        held += bool(shapes)
        sequences += len(shapes) > 1
    return f"{name}: held {Share(held, number)}, in sequence {Share(sequences, number)} of {number}"


def report(name: str, tallies: dict[str, Tally]) -> Iterator[str]:
    """Yield the rows of one set."""
    for row, tally in tallies.items():
        asked = sum(tally.outcomes.values())
        counts = " | ".join(str(tally.outcomes[each]) for each in OUTCOMES)
        wrong = Share(tally.outcomes["wrong"], asked)
        fired, accident = (Share(sum(each), len(each)) for each in (tally.fired, tally.by_accident))
        yield f"| {name} | {row} | {fired} | {accident} | {asked} | {counts} | {wrong} |"


def main(arguments: Sequence[str] | None = None) -> None:
    """Print one row for each set and property."""
    parser = set_arguments(__doc__, draws=60, queries=40)
    given = parser.parse_args(arguments)
    trajectories = given.data / "trajectories"
    wanted = given.sets or [RENDERED, "digits", "letters", "commands", "utd_signals", "utd_other"]
    sets = [read_rendered(given.data)] if RENDERED in wanted else []
    sets += recorded_sets(trajectories, wanted)
    sets += whole_body_sets(trajectories, [name for name in wanted if name.startswith("ut")])
    print(f"| set | off | fires | by accident | n | {' | '.join(OUTCOMES)} | wrong |")
    print("| --- " * (6 + len(OUTCOMES)) + "|")
    for recorded in sets:
        for line in report(
            recorded.name, measure(recorded, given.draws, given.queries, given.seed)
        ):
            print(line, flush=True)
        if recorded.name == RENDERED:
            print(report_held(recorded, RENDERED))
            print(report_held(read_held_signs(trajectories), "scuba_hands"))


if __name__ == "__main__":
    main()
