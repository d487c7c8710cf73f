"""What is lost with the landmarks that other pose estimators do not have.

First the sample clips, found by MediaPipe's 33 landmarks and cut down to the 17 of COCO (by name
the same as OpenPose's 18, and all of BODY_25 that gestures follow): a language defined with either
set recognises takes with either set. Then NATOPS (other people's arms, with wrists, elbows, thumbs
and hand tips): one template a class, everything of all joints or of wrists and elbows alone. What a
profile would refuse counts as wrong in the column "label" and by its nearest gesture in "nearest".

    python -m benchmarks.landmark_sets ../shared/data
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import replace
from pathlib import Path

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
from app.recognition.estimation import create_estimator
from app.recognition.landmark_sets import COCO_17
from app.recognition.landmarks import POSE_LANDMARKS
from app.recognition.profile import PROFILES
from benchmarks.methods.ours import gesture_of
from benchmarks.one_shot_draws import draws
from benchmarks.recorded_sets import RecordedSet, recorded_sets

SAMPLES = Path(__file__).parents[1] / "languages" / "clips"
SETS = {"33": POSE_LANDMARKS, "COCO": COCO_17}

Query = tuple[str, PoseSequence]
"""The gesture that is shown, and its recording."""


def shares(recognizer: Recognizer, queries: Sequence[Query]) -> tuple[Share, Share]:
    """Count the right labels, and the right nearest gestures."""
    labels = nearest = 0
    for label, poses in queries:
        try:
            result = recognizer.recognize(poses)
        except PoseError:
            continue
        labels += result.label == label
        nearest += result.nearest == label
    return Share(labels, len(queries)), Share(nearest, len(queries))


def sample_strokes() -> tuple[list[Query], list[Query]]:
    """Return demonstrations and tests: what lies between the salutes of the sample clips."""
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
        language = Language("samples", gestures).calibrated()
        for profile in PROFILES:
            recognizer = Recognizer(language, profile)
            for asked, seen in SETS.items():
                queries = [(label, poses.select(seen)) for label, poses in tests]
                line(f"samples, {defined} -> {asked}", profile, *shares(recognizer, queries))


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
            right, nearest = Share(0, 0), Share(0, 0)
            for draw in draws(recorded, count, queries, seed):
                gestures = [
                    gesture_of(str(recorded.labels[template]), recorded.recordings[template])
                    for template in draw.templates
                ]
                asked = [
                    (str(recorded.labels[query]), recorded.recordings[query]) for query in draw.own
                ]
                found = shares(Recognizer(Language("natops", gestures), profile), asked)
                right, nearest = right + found[0], nearest + found[1]
            line(f"natops, {name}", profile, right, nearest)


def line(name: str, profile: str, right: Share, nearest: Share) -> None:
    """Print one line of the report."""
    print(f"{name:22} {profile:6} {right!s:>18} {nearest!s:>18} {right.asked:5}", flush=True)


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
