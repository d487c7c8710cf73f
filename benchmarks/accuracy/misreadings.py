"""Misreadings: whether what an explanation claims of real misread takes is true.

`misreadings.csv` lists takes by other people, and rendered clips whose hands or keypoints cannot be
followed, that were not read as what was shown: columns take, expected, read_as (empty: asked back
or refused; "no take"), reader_1 and reader_2. Two readers saw pictures of each take, no sentence of
the studio, and wrote down every cause that they would accept.

- named: a reader accepts the cause that is claimed; false: none does; silent: none is claimed.
- alike: that two gestures are alike is claimed, which is a property of the two, not of a take.
- odd: a demonstration is blamed, which takes that the claim did not use confirm.
- changed: the take is read right by now, or a take is found where the readers saw that none was.

People's takes are in two parts: the sets' takes by which rules were made, and *new* ones, which
were drawn once the rules stood. ``hard_clips/`` holds the rendered clips of
`languages.render.hard_cast`: ``python -m languages.render NAME... --out FOLDER/hard_clips``.
"""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import closing, suppress
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import numpy as np

from app.evaluation.labelled_takes import ClipRecorder
from app.recognition import Gesture, Language, OsgError, PoseSequence, Recognizer, Recording
from app.recognition.explanation.context import KnownTake, KnownTakes, RecognitionContext
from app.recognition.explanation.explanation import explain
from app.recognition.recording.clip_range import find_clip_range
from app.recognition.recording.extraction import explain_missing_salutes
from app.recognition.recording.segmentation import takes_in
from app.resources import samples_dir
from benchmarks.figures import ROOT, Figure, Measurement, Results, share, table
from benchmarks.sets.every_set import all_sets, find_files
from benchmarks.sets.one_shot_draws import demonstrated, draws

TABLE: Final = Path(__file__).with_suffix(".csv")
SETS: Final = ("digits", "letters", "commands", "utd_signals", "utd_other", "utkinect")
HARD: Final = "hard_clips"
CLIPS: Final = ("rendered_letters", "strokes", "samples")

DRAWS, QUERIES, SEEDS = 3, 40, (50, 51)
"""Draws of each seed; takes of the second one were listed and read once the rules stood."""

NO_TAKE: Final = "no take"
OUTCOMES: Final = ("named", "odd", "alike", "false", "silent", "changed")

CLAIMS: Final = {
    "the first salute was": "second_salute",
    "the second salute was": "first_salute",
    "degrees away": "turned_away",
    "no hand in": "no_hand",
    "outside of the picture": "not_seen",
    "hands seen in": "no_hand",
}
"""Causes that the words claim which are told of a clip without a take."""

Row = dict[str, str]


def read_table(sets: Iterable[str], *, new: bool = False) -> list[Row]:
    """Return the rows of some sets or folders of clips; of people's takes the new ones or not."""
    with TABLE.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    parts = [(row, row["take"].split("/")) for row in rows]
    return [
        row
        for row, (name, number, *_) in parts
        if name in sets and (name not in SETS or (int(number) >= DRAWS) is new)
    ]


def know(recognizer: Recognizer, takes: Iterable[tuple[str, PoseSequence]]) -> list[KnownTake]:
    """Return labelled takes as a team would have them in its test set."""
    known = []
    for label, poses in takes:
        with suppress(OsgError):
            known.append(KnownTake(label, recognizer.query(poses)))
    return known


def judge(row: Row, context: RecognitionContext | None, claim: str, *, odd: bool = False) -> str:
    """Return the outcome of a row, by what is claimed of its take; None: there is none."""
    read_as = NO_TAKE if context is None else context.result.label or ""
    if read_as == row["expected"] or (row["read_as"] == NO_TAKE) != (context is None):
        return "changed"
    if claim == "near_gesture":
        return "alike"
    if claim in (*row["reader_1"].split(), *row["reader_2"].split()):
        return "named"
    return "odd" if odd else "false" if claim else "silent"


def claim_cause(row: Row, context: RecognitionContext, known: list[KnownTake]) -> str:
    """Return the kind of the cause that is claimed of a take; empty: none."""
    causes = explain(replace(context, known=tuple(known)), row["expected"]).causes
    return causes[0].kind.value if causes else ""


def claim_absence(recording: Recording) -> str:
    """Return what is claimed of a clip without a take: a salute or hands not seen, or a turn."""
    told = next(explain_missing_salutes(recording.poses, recording.salute, recording.hands), "")
    return next((claim for words, claim in CLAIMS.items() if words in told), "")


def measure_people(trajectories: Path, new: bool, quick: bool) -> Iterator[Figure]:
    """Yield what is claimed of people's misread takes."""
    outcomes = Counter[str]()
    rows = read_table(SETS, new=new)[:: 8 if quick else 1]
    for recorded in all_sets(trajectories, SETS):
        takes, labels = recorded.recordings, recorded.labels
        drawn = [each for seed in SEEDS for each in draws(recorded, DRAWS, QUERIES, seed)]
        for row in (each for each in rows if each["take"].startswith(f"{recorded.name}/")):
            number, index = map(int, row["take"].split("/")[1:])
            language = Language(recorded.name, demonstrated(recorded, drawn[number].templates))
            recognizer, queries = Recognizer(language, "full"), drawn[number].others.tolist()
            context = RecognitionContext(
                recognizer=recognizer, poses=takes[index], whole=takes[index]
            )
            others = [each for each in queries if each != index]
            known = know(recognizer, ((str(labels[each]), takes[each]) for each in others))
            claim, odd, label = claim_cause(row, context, known), False, row["expected"]
            if claim == "demonstration":
                # With more than half of the known takes in its place more unseen takes are right.
                own = np.flatnonzero(labels == label).tolist()
                unseen = [takes[each] for each in own if each not in queries][:40]
                instead = [each for each in own if each in others]
                changed = [language.with_changed(*demonstrated(recorded, [e])) for e in instead]
                counts = [count_right(each, label, unseen) for each in (language, *changed)]
                odd = bool(instead) and float(np.median(counts[1:])) > counts[0]
            outcomes[judge(row, context, claim, odd=odd)] += 1
    yield from count_outcomes(outcomes)


def count_right(language: Language, label: str, unseen: list[PoseSequence]) -> int:
    """Return how many takes of a gesture a language reads right."""
    recognizer = Recognizer(language, "full")
    known = KnownTakes(recognizer, know(recognizer, ((label, each) for each in unseen)))
    return sum(read == label for read in known.readings)


def count_outcomes(outcomes: Counter[str]) -> Iterator[Figure]:
    """Yield the share of each outcome."""
    for name in OUTCOMES:
        yield share(name, outcomes[name], outcomes.total())


def label_of(clip: Path) -> str:
    """Return the gesture that a clip shows, by its name."""
    return "triangle" if clip.stem == "unfinished-triangle" else re.split("[-_]", clip.stem)[0]


def measure_clips(folder: Path, sets: tuple[str, ...], quick: bool) -> Iterator[Figure]:
    """Yield what is claimed of misread takes in clips.

    Known are the other takes of its gesture, and of the one that is nearest.
    """
    outcomes = Counter[str]()
    with TemporaryDirectory() as keep, closing(ClipRecorder(Path(keep))) as recorder:
        read = cache(recorder.record)
        for row in read_table(sets)[-1 if quick else 0 :]:
            name, _, clip = row["take"].partition("/")
            samples = name in ("samples", HARD)
            place = samples_dir() / "clips" if name == "samples" else folder / name
            recording = read(place / f"{clip}.mp4")
            language = Language.load(samples_dir() / "osg-table-2.json")
            if not samples:
                demonstrations = sorted(place.glob("*_demo.mp4"))
                language = Language(
                    name,
                    [
                        Gesture.from_demonstration(
                            label_of(each), find_clip_range(read(each)).poses
                        )
                        for each in demonstrations
                    ],
                )
            recognizer, (take, *_) = Recognizer(language, "full"), (*takes_in(recording), None)
            if take is None:
                outcomes[judge(row, None, claim_absence(recording))] += 1
                continue
            context = RecognitionContext.of_take(recognizer, take)
            asked = {row["expected"], context.result.nearest}
            others = STORED.glob("*-test-*.npz") if samples else place.glob("*_t*.mp4")
            known = [
                (label_of(each), found.poses)
                for each in sorted(others)
                if label_of(each) in asked and each.stem != clip
                for found in takes_in(read(each))
            ]
            claim = claim_cause(row, context, know(recognizer, known))
            outcomes[judge(row, context, claim)] += 1
    yield from count_outcomes(outcomes)


STORED: Final = ROOT / "tests" / "recordings" / "avx512"
"""Recordings of the sample clips."""


def measurements(folder: Path, methods: tuple[str, ...]) -> Iterator[Measurement]:
    """Yield what is claimed of each part of the table."""
    trajectories = folder / "trajectories"
    reads = find_files(trajectories, SETS)
    for part, new in (("people", False), ("people-new", True)):
        yield Measurement(
            f"misreadings/{part}",
            partial(measure_people, trajectories, new),
            "misread takes by people of six recorded sets",
            "causes that two readers accept, from pictures alone, against the one that is claimed",
            reads=reads,
        )
    for part, sets in (("rendered", CLIPS), ("hard", (HARD,))):
        yield Measurement(
            f"misreadings/{part}",
            partial(measure_clips, folder, sets),
            f"misread takes of rendered clips: {', '.join(sets)}",
            "causes that two readers accept, from pictures alone, against the one that is claimed",
            reads=tuple(folder / name for name in sets if name != "samples"),
        )


WORDS: Final = {
    "named": "names a cause that a reader accepts",
    "odd": "says that the demonstration is odd, which takes that it did not use confirm",
    "alike": "says that the two gestures are nearly alike",
    "false": "claims a cause that no reader accepts",
    "silent": "claims none: tells the strokes of both",
    "changed": "is not needed: read right by now, or a take is found where none was",
}


def write_claims(results: Results) -> str:
    """Write how often a claim is true, false, or not made."""
    parts = ("people", "people-new", "rendered", "hard")
    head = ["the sentence"]
    for part in parts:
        head.append(f"{part}, n {results.show(f'misreadings/{part}', 'named', 'n?')}")
    rows = []
    for name, words in WORDS.items():
        shown = [results.show(f"misreadings/{part}", name, "hits?") for part in parts]
        rows.append([words, *shown])
    return table(head, rows)


TABLES = {"misreadings": write_claims}
