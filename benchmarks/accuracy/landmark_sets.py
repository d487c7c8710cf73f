"""Landmark sets: accuracy without the landmarks that other pose estimators lack.

First the sample clips, with MediaPipe's 33 landmarks or only COCO's 17 (by name the same as
OpenPose's 18, and all of BODY_25 that gestures follow): a language defined with either set
recognises takes with either set. Then NATOPS (other people's arms, with wrists, elbows, thumbs and
hand tips): one template per class, with all joints or with wrists and elbows alone. A rejected take
counts as wrong in the column "label", and by its nearest gesture in "nearest"; each line ends with
the most frequent confusion among the nearest gestures.

    python -m benchmarks.accuracy.landmark_sets ../shared/data
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from app.evaluation.share import Share
from app.recognition import (
    Gesture,
    Language,
    PoseError,
    PoseSequence,
    Recognizer,
    record,
    takes_in,
)
from app.recognition.estimation.factory import create_estimator
from app.recognition.gestures.profile import PROFILES
from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.recognition.poses.skeletons import COCO_17
from benchmarks.sets.one_shot_draws import demonstrated, draws
from benchmarks.sets.recorded_sets import RecordedSet, recorded_sets

SAMPLES = Path(__file__).parents[2] / "languages" / "clips"
SETS = {"33": POSE_LANDMARKS, "COCO": COCO_17}

Query = tuple[str, PoseSequence]
"""The gesture that is shown, and its recording."""


class Reading(NamedTuple):
    """A query, its label, and the nearest gesture; None if nothing could be compared."""

    shown: str
    label: str | None
    nearest: str | None


def readings(recognizer: Recognizer, queries: Sequence[Query]) -> Iterator[Reading]:
    """Recognise one query after the other."""
    for shown, poses in queries:
        try:
            result = recognizer.recognize(poses)
        except PoseError:
            yield Reading(shown, None, None)
        else:
            yield Reading(shown, result.label, result.nearest)


def sample_strokes() -> tuple[list[Query], list[Query]]:
    """Return demonstrations and test takes of the sample clips."""
    demonstrations: list[Query] = []
    tests: list[Query] = []
    with closing(create_estimator()) as estimator:
        for clip in sorted(SAMPLES.glob("*-demonstration.mp4")):
            label = clip.stem.removesuffix("-demonstration")
            for path in (clip, *sorted(SAMPLES.glob(f"{label}-test-*.mp4"))):
                (take,) = takes_in(record(path, estimator=estimator))
                (demonstrations if path == clip else tests).append((label, take.poses))
    return demonstrations, tests


def report_samples() -> None:
    """Print the sample clips' lines: every set of landmarks defined, every one recognised."""
    demonstrations, tests = sample_strokes()
    for defined, known in SETS.items():
        gestures = [
            Gesture.from_demonstration(label, poses.select(known))
            for label, poses in demonstrations
        ]
        language = Language("samples", gestures)
        for profile in PROFILES:
            recognizer = Recognizer(language, profile)
            for asked, seen in SETS.items():
                queries = [(label, poses.select(seen)) for label, poses in tests]
                line(f"samples, {defined} -> {asked}", profile, [*readings(recognizer, queries)])


def natops_subsets(recorded: RecordedSet) -> Iterator[tuple[str, RecordedSet]]:
    """Yield the set with all its joints, and with those that COCO has."""
    yield "all joints", recorded
    names = [name for name in recorded.recordings[0].landmarks if name in COCO_17]
    reduced = [poses.select(names) for poses in recorded.recordings]
    yield "COCO's", replace(recorded, recordings=reduced)


def report_natops(folder: Path, count: int, queries: int, seed: int) -> None:
    """Print NATOPS's lines; draws are the same for both sets of joints."""
    (natops,) = [each for each in recorded_sets(folder) if each.name == "natops"]
    for name, recorded in natops_subsets(natops):
        for profile in PROFILES:
            found: list[Reading] = []
            for draw in draws(recorded, count, queries, seed):
                gestures = demonstrated(recorded, draw.templates)
                asked = [
                    (str(recorded.labels[query]), recorded.recordings[query]) for query in draw.own
                ]
                found += readings(Recognizer(Language("natops", gestures), profile), asked)
            line(f"natops, {name}", profile, found)


def line(name: str, profile: str, found: Sequence[Reading]) -> None:
    """Print one line of the report."""
    right = Share(sum(each.label == each.shown for each in found), len(found))
    nearest = Share(sum(each.nearest == each.shown for each in found), len(found))
    pairs = Counter(
        " and ".join(sorted((each.shown, each.nearest)))
        for each in found
        if each.nearest not in (each.shown, None)
    )
    worst = "".join(f"  {pair}: {n} of {pairs.total()}" for pair, n in pairs.most_common(1))
    print(f"{name:22} {profile:6} {right!s:>18} {nearest!s:>18} {len(found):5}{worst}", flush=True)


def main() -> None:
    """Print one line a set and profile."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("data", type=Path, help="the folder that holds trajectories/")
    parser.add_argument("--draws", type=int, default=30, help="choices of templates")
    parser.add_argument("--queries", type=int, default=30, help="queries per choice")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    print(f"one template a class, share correct (95 % interval), seed {given.seed}")
    print(f"{'set':22} {'method':6} {'label':>18} {'nearest':>18} {'n':>5}")
    report_samples()
    report_natops(given.data / "trajectories", given.draws, given.queries, given.seed)


if __name__ == "__main__":
    main()
