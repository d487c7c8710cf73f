"""Sample clips of rendered divers, and the paper's protocol on simulated takes of their languages.

Eight demonstrations by one rendered diver, sixteen takes by others, read by the models. The paper
shows three and eight gestures, the latter by people; its variants are not public.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from functools import partial
from itertools import product
from pathlib import Path

from app.evaluation.one_shot import recognize_variants
from app.recognition import Gesture, Language, PoseError, PoseSequence, Recognizer, record, takes_in
from app.recognition.estimation.factory import create_estimator
from app.recognition.gestures.profile import PROFILES
from app.recognition.simulation.variation import Person
from benchmarks.figures import Figure, Measurement, share
from languages.build import FOLDER, TABLE_2

Shown = tuple[str, PoseSequence]
"""A gesture and a take of it."""

PEOPLE: tuple[Person, ...] = ("same", "another")
VARIANTS = {"osg-table-1": 200, "osg-table-2": 50}
"""Simulated takes of each gesture, by language: of three gestures and of eight."""


def read_samples() -> tuple[list[Shown], list[Shown]]:
    """Read the first takes of the demonstrations and of the test clips."""
    demonstrations: list[Shown] = []
    tests: list[Shown] = []
    with closing(create_estimator()) as estimator:
        for label in (each.label for each in TABLE_2):
            for kind in ("demonstration", "test-1", "test-2"):
                clip = FOLDER / "clips" / f"{label}-{kind}.mp4"
                takes = takes_in(record(clip, estimator=estimator))
                (demonstrations if kind == "demonstration" else tests).extend(
                    (label, take.poses) for take in takes[:1] if take.closed
                )
    return demonstrations, tests


def teach_samples(demonstrations: list[Shown]) -> Language:
    """Make the language of the sample clips."""
    return Language("samples", [Gesture.from_demonstration(*each) for each in demonstrations])


def measure_clips(quick: bool) -> Iterator[Figure]:
    """Yield how many clips have a closed take, and how many of these are recognised."""
    demonstrations, tests = read_samples()
    yield share("closed-takes", len(demonstrations) + len(tests), 3 * len(TABLE_2))
    ordinary = takes_in(record(FOLDER / "clips" / "ordinary-movement.mp4"))
    yield Figure("takes-in-ordinary-movement", len(ordinary), 1, unit="")
    language = teach_samples(demonstrations)
    for profile in PROFILES:
        recognizer = Recognizer(language, profile)
        right = sum(recognizer.recognize(poses).label == label for label, poses in tests)
        yield share(profile, right, 2 * len(TABLE_2))


def measure_variants(name: str, quick: bool) -> Iterator[Figure]:
    """Yield how many simulated takes are recognised, and how many are rejected."""
    language = Language.load(FOLDER / f"{name}.json")
    count = 5 if quick else VARIANTS[name]
    for profile, person in product(PROFILES, PEOPLE):
        matrix = recognize_variants(language, count, profile=profile, seed=1, person=person)
        yield share(f"{profile}/{person}", matrix.correct.correct, matrix.correct.asked)
        rejected = matrix.refused
        yield share(f"{profile}/{person}/rejected", rejected.correct, rejected.asked)


def is_right(recognizer: Recognizer, poses: PoseSequence, label: str) -> bool:
    """Return whether the nearest gesture is right; what cannot be compared is not."""
    try:
        return recognizer.recognize(poses).nearest == label
    except PoseError:
        return False


def measurements(folder: Path, methods: tuple[str, ...]) -> Iterator[Measurement]:
    """Yield the clips, and the paper's protocol on each language."""
    yield Measurement(
        "samples/clips",
        measure_clips,
        data="25 clips of six rendered divers",
        protocol="demonstrations by one diver, two takes of each of 8 gestures by others",
    )
    for name, count in VARIANTS.items():
        yield Measurement(
            f"samples/{name}",
            partial(measure_variants, name),
            data="simulated takes",
            protocol=f"{count} variants of each gesture of languages/{name}.json, the paper's",
        )
