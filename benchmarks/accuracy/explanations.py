"""Explanations: whether what is claimed of takes and gestures is true.

*Known faults*: languages are drawn from recordings of several people, one person demonstrates every
gesture, takes are by the others. Takes that are read right are spoilt, each in one way; of those
that are no longer read right, the first cause is counted: *named*, or *false*, another one. That
gestures are nearly alike is a cause of every take. Where a fault is the same as another one for a
gesture (a circle drawn backwards is its mirror image), which is measured on the demonstration
itself, either name is right. *Another gesture*: takes as they are, said to be meant as another one:
no cause is right.

*Alike pairs*: a pair of gestures is mixed up if at least `LEAST_TAKES` takes of the two by others,
and a tenth of them, are read as the other one or asked back with it. The studio names the pairs of
which the demonstration of one is nearer to the other than `ALIKE`.

*Transcripts*: `transcripts.csv` lists 37 drawings by people and the strokes that two readers wrote
who saw pictures of the wrists' paths alone. A stroke agrees if it does not differ as in an
explanation (`Piece.differs`); counted are the drawings in which all strokes agree with a reader's,
and those in which the two readers agree with each other.

*Blame*: whether the one bad demonstration of a language is found by known takes, and no good one.
One person demonstrates every gesture, five takes of each by others are the known ones. A
language keeps the gestures whose demonstration reads at least half of further takes, which blame
does not see, so that it has no bad demonstration. Then one demonstration is spoilt, or none; where
that costs at least half of the gesture's known takes, it should be blamed first (`faults`: by what
was spoilt). `good`: languages without a bad demonstration that are blamed; of languages as they are
drawn, with all gestures, it is counted how many have a bad demonstration (`drawn/bad`), how many
are blamed, and of how many of these the demonstration is truly bad.

The weights and the least evidence of a set are chosen on the sets by other people, with at most
`MOST_BLAMED` of the languages without a bad demonstration blamed.

Real misread takes: `benchmarks.accuracy.misreadings`.
"""

from __future__ import annotations

import csv
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from functools import partial
from itertools import chain, combinations, permutations, product
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
from pydantic import TypeAdapter

from app.recognition import Gesture, GestureError, Language, PoseError, PoseSequence, Recognizer
from app.recognition.explanation.blame import Blame, find_blame
from app.recognition.explanation.causes import ALIKE, find_causes
from app.recognition.explanation.context import KnownTake, KnownTakes, RecognitionContext
from app.recognition.explanation.strokes import DIRECTIONS, Piece, transcribe
from app.recognition.explanation.transcript import compare_transcripts
from app.recognition.explanation.undoing import Comparison
from app.recognition.features.motion import find_hands
from app.recognition.gestures.demonstration import condense
from app.recognition.poses.trajectory import Trajectory
from app.resources import samples_dir
from benchmarks.figures import Figure, Measurement, share
from benchmarks.methods.ours import gesture_of
from benchmarks.sets.every_set import all_sets, find_files
from benchmarks.sets.faults import DEMONSTRATION_FAULTS, TAKE_FAULTS
from benchmarks.sets.one_shot_draws import Draw, demonstrated, draws
from benchmarks.sets.recorded_sets import RecordedSet
from benchmarks.sets.simulated_bodies import CARRIED

FAULT_SETS = ("utd_signals", "utkinect", "utd_other", "carried_figures", "carried_letters")
"""Sets of whole bodies by several people."""

SLOWEST_FRAMES = 0.08
"""Most seconds between frames in which keypoints are made to jump: slower, a jump is a stroke."""

PER_LANGUAGE = 4
"""Takes of a language that are spoilt in each way."""

ANOTHER, NEAR, RIGHT = "another-gesture", "near_gesture", "right"


def read(recognizer: Recognizer, poses: PoseSequence) -> str | None:
    """Return what a take is read as."""
    try:
        return recognizer.recognize(poses).label
    except PoseError:
        return None


def name_first(recognizer: Recognizer, poses: PoseSequence, label: str) -> str:
    """Return the kind of a take's first cause, empty if none is; `RIGHT` where it is none."""
    context = RecognitionContext(recognizer=recognizer, poses=poses, whole=poses)
    try:
        if context.result.label == label:
            return RIGHT
        causes = find_causes(context, label)
    except PoseError:
        return RIGHT
    return causes[0].kind.value if causes else ""


def list_equal_faults(
    recognizer: Recognizer, gesture: Gesture, spoilt: PoseSequence, fault: str
) -> set[str]:
    """Return the causes that a fault is for a gesture, measured on its spoilt demonstration."""
    try:
        query = condense(recognizer.query(spoilt))
    except PoseError:
        return {fault}
    undone: dict[str, float] = {}
    vote: Any = recognizer.vote
    for each in Comparison(vote, query, gesture, None).undo_all():
        undone[each.kind] = min(each.novelty, undone.get(each.kind, np.inf))
    least = max(0.1, undone.get(fault, 0.0))
    return {fault} | {kind for kind, novelty in undone.items() if novelty <= least}


def name_causes(
    recorded: RecordedSet, drawn: Draw, random: np.random.Generator
) -> Iterator[tuple[str, str]]:
    """Yield fault and first cause of every spoilt take that is no longer read right."""
    gestures = demonstrated(recorded, drawn.templates)
    recognizer = Recognizer(Language(recorded.name, gestures), "full")
    labels, takes = recognizer.language.labels, recorded.recordings
    right = [
        (index, str(recorded.labels[index]))
        for index in drawn.others.tolist()
        if read(recognizer, takes[index]) == recorded.labels[index]
    ]
    for fault, spoil in TAKE_FAULTS.items():
        for number in random.permutation(len(right))[:PER_LANGUAGE].tolist():
            index, label = right[number]
            poses, gesture = takes[index], recognizer.language.gesture(label)
            if fault in ("mirrored", "upside_down") and find_hands(gesture.salient) != 1:
                continue
            if fault == "keypoints_jumped" and np.median(np.diff(poses.time)) > SLOWEST_FRAMES:
                continue
            first = name_first(recognizer, spoil(poses, random), label)
            shown = takes[drawn.templates[labels.index(label)]]
            spoilt = spoil(shown, np.random.default_rng(0))
            same = list_equal_faults(recognizer, gesture, spoilt, fault)
            yield fault, fault if first in same else first
    for number in random.permutation(len(right))[: 2 * PER_LANGUAGE].tolist():
        index, label = right[number]
        meant = str(random.choice([each for each in labels if each != label]))
        yield ANOTHER, name_first(recognizer, takes[index], meant)


def measure_faults(trajectories: Path, quick: bool) -> Iterator[Figure]:
    """Yield for each fault how often it, or a false one, is named first."""
    found: Mapping[str, Counter[str]] = defaultdict(Counter)
    for recorded in all_sets(trajectories, FAULT_SETS):
        random = np.random.default_rng(1)
        for drawn in draws(recorded, 1 if quick else 4, 30 if quick else 120, seed=1):
            for fault, cause in name_causes(recorded, drawn, random):
                if cause != RIGHT:
                    found[fault][cause] += 1
    for fault, causes in found.items():
        number = causes.total()
        if fault != ANOTHER:
            yield share(f"{fault}/named", causes[fault], number)
        false = number - causes[fault] - causes[""] - causes[NEAR]
        yield share(f"{fault}/false", false, number)


PAIR_SETS: Final = ("digits", "letters", "commands", "utd_signals", "utkinect", "utd_other")

LEAST_TAKES: Final = 2
LEAST_SHARE: Final = 0.1
LEAST_SHOWN: Final = 4
"""Fewest takes of the two gestures of a pair that counts."""


def list_pairs(recorded: RecordedSet, drawn: Draw) -> Iterator[tuple[bool, bool]]:
    """Yield of the pairs of a language whether each is named, and whether it is mixed up."""
    gestures = demonstrated(recorded, drawn.templates)
    recognizer = Recognizer(Language(recorded.name, gestures), "full")
    labels = recognizer.language.labels
    # By gesture and by what its takes may be read as; last: all of them.
    counts = np.zeros((len(labels), len(labels) + 1))
    for query in drawn.others:
        own = labels.index(str(recorded.labels[query]))
        with suppress(PoseError):
            result = recognizer.recognize(recorded.recordings[query])
            counts[own, -1] += 1
            for label in {result.label, *result.between} - {None}:
                counts[own, labels.index(str(label))] += 1
    tables = [recognizer.compare(each.trajectory) for each in gestures if each.trajectory]
    novelty = np.array([each.novelty for each in tables])
    for a, b in combinations(range(len(labels)), 2):
        shown, mixed = counts[[a, b], -1].sum(), counts[a, b] + counts[b, a]
        if shown >= LEAST_SHOWN:
            named = min(novelty[a, b], novelty[b, a]) < ALIKE
            yield bool(named), bool(mixed >= max(LEAST_TAKES, LEAST_SHARE * shown))


def measure_pairs(trajectories: Path, quick: bool) -> Iterator[Figure]:
    """Yield how many pairs are mixed up, named of these, and of the named ones in vain."""
    pairs = [
        pair
        for recorded in all_sets(trajectories, PAIR_SETS)
        for drawn in draws(recorded, 1 if quick else 4, 60, seed=91)
        for pair in list_pairs(recorded, drawn)
    ]
    named, mixed = (sum(each) for each in zip(*pairs, strict=True))
    truly = sum(a and b for a, b in pairs)
    yield share("mixed", mixed, len(pairs))
    yield share("named", truly, mixed)
    yield share("in-vain", named - truly, named)


TABLE: Final = Path(__file__).with_name("transcripts.csv")

PIECE: Final = TypeAdapter(Piece)

DRAWN_SETS: Final = {"digits": 10, "letters": 10, "commands": 12}
"""Sets of drawing hands, and of how many classes one drawing is taken, each by another person."""


def list_drawings(trajectories: Path) -> Iterator[tuple[str, Trajectory]]:
    """Yield the drawings: the eight sample gestures, and one of each class by some person."""
    for gesture in Language.load(samples_dir() / "osg-table-2.json").gestures:
        assert gesture.trajectory is not None
        yield f"sample {gesture.label}", gesture.trajectory
    generator = np.random.default_rng(7)
    for recorded in all_sets(trajectories, list(DRAWN_SETS)):
        for label in np.unique(recorded.labels)[: DRAWN_SETS[recorded.name]]:
            index = int(generator.choice(np.flatnonzero(recorded.labels == label)))
            yield f"{recorded.name} {index}", Trajectory.from_poses(recorded.recordings[index])


def parse_strokes(words: str) -> list[Piece]:
    """Return the strokes that a reader wrote, of both hands one after the other."""
    pieces = []
    for hand, part in enumerate(words.split(";")):
        for stroke in map(str.strip, part.split(",")):
            sense = -1.0 if "anticlockwise" in stroke else 1.0
            way = max((way for way in DIRECTIONS if stroke.endswith(way)), key=len, default=None)
            kinds = [kind for kind in ("arc", "loop", "curve", "pause") if kind in stroke]
            kind = kinds[0] if kinds else "line"
            content = {
                "kind": kind,
                "hand": str(hand),
                "direction": None if way is None else 45.0 * DIRECTIONS.index(way),
                "turn": {"arc": 180.0, "loop": 360.0}.get(kind, 0.0) * sense,
                "start": 0.0,
                "end": 0.0,
            }
            pieces.append(PIECE.validate_python(content))
    return pieces


def agree(one: Sequence[Piece], other: Sequence[Piece]) -> bool:
    """Return whether two transcripts tell the same strokes, whichever hand comes first."""
    hands = {piece.hand: [each for each in other if each.hand == piece.hand] for piece in other}
    orders = [list(chain(*row)) for row in permutations(hands.values())]
    return any(compare_transcripts(one, order).differs is None for order in orders)


def measure_transcripts(trajectories: Path, quick: bool) -> Iterator[Figure]:
    """Yield in how many drawings a reader agrees, and the readers with each other."""
    drawings = dict(list_drawings(trajectories))
    with TABLE.open() as file:
        rows = list(csv.DictReader(file))
    either = readers = 0
    for row in rows:
        told = transcribe(drawings[row["drawing"]])
        first, second = (parse_strokes(row[f"reader_{number}"]) for number in (1, 2))
        either += agree(told, first) or agree(told, second)
        readers += agree(first, second)
    yield share("a-reader", either, len(rows))
    yield share("readers", readers, len(rows))


BLAME_SETS = ("utd_signals", "utd_other", "utkinect", *CARRIED)
"""Sets of whole bodies by several people."""

EVERYBODY = 100_000
"""Most takes by others: all of them."""

KNOWN, UNSEEN = 5, 15
"""Takes of each gesture that blame sees, and most of those that it does not see."""

FEWEST_UNSEEN = 4
"""Least unseen takes by which a demonstration is good or bad."""

GOOD = 0.5
"""Least share of unseen takes that a good demonstration reads."""

FEWEST_GESTURES = 3
"""Least gestures with good demonstrations in a language."""

LEAST_HARM = 0.5
"""Least share of a gesture's known takes that its spoilt demonstration must cost."""

MOST_BLAMED = 0.03
"""Largest share of good languages that may be blamed on the sets that the constants are chosen on:
below the 5 % that are wanted, since other sets differ."""

WEIGHTS = tuple(product((0.0, 0.25, 0.5, 0.75, 1.0), (0.0, 0.1, 0.2, 0.3, 0.4)))
"""Weights of failing takes and of what a change gains to choose from."""

NONE, DRAWN = "good", "drawn"
"""No fault; nothing sorted out."""


class Case(NamedTuple):
    """A language, in which one demonstration was spoilt or none.

    Attributes
    ----------
    fault
        What was spoilt, `NONE` or `DRAWN`.
    bad
        Gestures whose demonstrations are bad.
    suspects
        Every demonstration that might be blamed.

    """

    fault: str
    bad: frozenset[str]
    suspects: tuple[Blame, ...]

    def blame(self, weights: tuple[float, float]) -> tuple[float, str | None]:
        """Return the evidence against the first suspect, and its gesture."""
        weighed = [(each.evidence.weigh(*weights), each.label) for each in self.suspects]
        return max(weighed, default=(-np.inf, None))


Taught = dict[str, tuple[PoseSequence, list[PoseSequence]]]
"""Of each gesture its demonstration, and the takes by others that blame sees."""


def recognizer_of(taught: Taught) -> Recognizer:
    """Return the recogniser of a language."""
    gestures = [gesture_of(label, shown) for label, (shown, _) in taught.items()]
    return Recognizer(Language("drawn", gestures), "full")


def know(recognizer: Recognizer, taught: Taught) -> KnownTakes:
    """Return the takes as blame knows them."""
    takes = [(label, poses) for label, (_, known) in taught.items() for poses in known]
    return KnownTakes(
        recognizer, [KnownTake(label, recognizer.query(poses)) for label, poses in takes]
    )


def find_suspects(recognizer: Recognizer, taught: Taught) -> tuple[Blame, ...]:
    """Find all demonstrations that might be blamed, whatever the constants."""
    return find_blame(know(recognizer, taught), least=-np.inf)


def draw_cases(recorded: RecordedSet, drawn: Draw, random: np.random.Generator) -> Iterator[Case]:
    """Yield the language as drawn; of its good gestures one with each fault, and one without."""
    takes, taught, unseen = recorded.recordings, Taught(), {}
    for template in drawn.templates:
        label = str(recorded.labels[template])
        pool = random.permutation(drawn.others[recorded.labels[drawn.others] == label])
        others = [takes[each] for each in pool[: KNOWN + UNSEEN]]
        taught[label], unseen[label] = (takes[template], others[:KNOWN]), others[KNOWN:]
    recognizer = recognizer_of(taught)
    good = {
        label
        for label, others in unseen.items()
        if len(others) >= FEWEST_UNSEEN
        and sum(read(recognizer, each) == label for each in others) >= GOOD * len(others)
    }
    yield Case(DRAWN, frozenset(taught.keys() - good), find_suspects(recognizer, taught))
    if len(good) >= FEWEST_GESTURES:
        yield from spoil_each({label: taught[label] for label in taught if label in good}, random)


def spoil_each(taught: Taught, random: np.random.Generator) -> Iterator[Case]:
    """Yield a case for each fault that costs half of its gesture's takes, and one without."""
    labels, recognizer = [*taught], recognizer_of(taught)
    for fault in (*DEMONSTRATION_FAULTS, ANOTHER):
        at = int(random.integers(len(labels)))
        other = (at + 1 + int(random.integers(len(labels) - 1))) % len(labels)
        label, poses = labels[at], taught[labels[other]][0]
        if fault != ANOTHER:
            poses = DEMONSTRATION_FAULTS[fault](taught[label][0], random)
        try:
            language = recognizer.language.with_changed(gesture_of(label, poses))
        except GestureError:
            continue
        spoilt, known = Recognizer(language, "full"), taught[label][1]
        _, broken = know(recognizer, {label: taught[label]}).try_change(spoilt)
        if len(broken) >= LEAST_HARM * len(known):
            yield Case(fault, frozenset({label}), find_suspects(spoilt, taught))
    yield Case(NONE, frozenset(), find_suspects(recognizer, taught))


Constants = tuple[tuple[float, float], float]
"""The two weights of `Evidence.weigh`, and the least evidence."""


def choose(cases: Sequence[Case]) -> Constants:
    """Choose the constants that blame most bad demonstrations first."""
    tried: list[tuple[int, Constants]] = []
    for weights in WEIGHTS:
        tops = sorted(
            (each.blame(weights)[0] for each in cases if each.fault == NONE), reverse=True
        )
        least = max(0.0, float(tops[int(MOST_BLAMED * len(tops))]) + 1e-6)
        first = [
            (each.blame(weights), each.bad) for each in cases if each.fault not in (NONE, DRAWN)
        ]
        hits = sum(evidence >= least and label in bad for (evidence, label), bad in first)
        tried.append((hits, (weights, least)))
    return max(tried, key=lambda each: each[0])[1]


def find_people(name: str) -> str:
    """Return whose recordings a set holds."""
    return "3DMadLabSD" if name in CARRIED[1:] else name.partition("_")[0]


def measure_blame(trajectories: Path, quick: bool) -> Iterator[Figure]:
    """Yield how many bad demonstrations, and how many good ones, are blamed first."""
    cases: dict[str, list[Case]] = defaultdict(list)
    for recorded in all_sets(trajectories, BLAME_SETS):
        random = np.random.default_rng(1)
        for drawn in draws(recorded, 1 if quick else 8, EVERYBODY, seed=1):
            cases[recorded.name] += draw_cases(recorded, drawn, random)
    # By fault: whether a demonstration is blamed, whether truly, and whether one is bad.
    found: dict[str, list[tuple[bool, bool, bool]]] = defaultdict(list)
    for name, own in cases.items():
        others = [
            case
            for other, row in cases.items()
            if find_people(other) != find_people(name)
            for case in row
        ]
        weights, least = choose(others)
        for case in own:
            evidence, label = case.blame(weights)
            blamed = evidence >= least
            found[case.fault].append((blamed, blamed and label in case.bad, bool(case.bad)))
    for fault in (*DEMONSTRATION_FAULTS, ANOTHER):
        yield share(f"faults/{fault}", sum(each[1] for each in found[fault]), len(found[fault]))
    told = [each for fault, row in found.items() if fault not in (NONE, DRAWN) for each in row]
    yield share("faults/all", sum(each[1] for each in told), len(told))
    blamed, truly, bad = (sum(each) for each in zip(*found[DRAWN], strict=True))
    yield share("good/blamed", sum(each[0] for each in found[NONE]), len(found[NONE]))
    yield share("drawn/bad", bad, len(found[DRAWN]))
    yield share("drawn/blamed", blamed, len(found[DRAWN]))
    yield share("drawn/truly", truly, blamed)


def measurements(folder: Path, methods: tuple[str, ...]) -> Iterator[Measurement]:
    """Yield whether causes of known faults, and transcripts, are true."""
    trajectories = folder / "trajectories"
    yield Measurement(
        "explanations/known-faults",
        partial(measure_faults, trajectories),
        ", ".join(FAULT_SETS),
        "4 languages a set, four takes by others spoilt in each way",
        reads=find_files(trajectories, FAULT_SETS),
    )
    yield Measurement(
        "explanations/alike-pairs",
        partial(measure_pairs, trajectories),
        ", ".join(PAIR_SETS),
        "4 languages a set, 60 takes by others",
        reads=find_files(trajectories, PAIR_SETS),
    )
    yield Measurement(
        "explanations/transcripts",
        partial(measure_transcripts, trajectories),
        "37 drawings by people, of digits, letters, commands and sample gestures",
        "two readers wrote the strokes from pictures alone",
        reads=find_files(trajectories, DRAWN_SETS),
    )
    yield Measurement(
        "explanations/blame",
        partial(measure_blame, trajectories),
        ", ".join(BLAME_SETS),
        "8 languages a set, five known takes a gesture, a demonstration spoilt in each way",
        reads=find_files(trajectories, BLAME_SETS),
    )
