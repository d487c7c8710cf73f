"""Accuracy of languages and takes with different keypoints.

First the sample clips: takes of one estimator with all of its 33 body keypoints, or only COCO's 17
(by name the same as OpenPose's 18, and all of BODY_25 that gestures follow): a language with either
set recognises takes with either set. Then NATOPS (other people's arms, with wrists, elbows, thumbs
and hand tips): one demonstration a class, with all joints or with wrists and elbows alone.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path

from app.recognition import Gesture, Language, PoseError, Recognizer
from app.recognition.gestures.profile import PROFILES
from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.recognition.poses.skeletons import COCO_17
from benchmarks.accuracy.samples import Shown, read_samples
from benchmarks.figures import Figure, Measurement, Results, share, table
from benchmarks.sets.every_set import measure_sets
from benchmarks.sets.one_shot_draws import demonstrated, draws
from benchmarks.sets.recorded_sets import RecordedSet

SETS = {"33": POSE_LANDMARKS, "coco": COCO_17}


def count_right(recognizer: Recognizer, queries: Sequence[Shown]) -> Counter[str]:
    """Count takes whose label, and whose nearest gesture, is right."""
    right = Counter[str]()
    for shown, poses in queries:
        try:
            result = recognizer.recognize(poses)
        except PoseError:
            continue
        right["label"] += result.label == shown
        right["nearest"] += result.nearest == shown
    return right


def measure_samples(quick: bool) -> Iterator[Figure]:
    """Yield the shares for every set of keypoints that defines, and every one that is read."""
    demonstrations, tests = read_samples()
    for (defined, known), profile in product(SETS.items(), PROFILES):
        gestures = [
            Gesture.from_demonstration(label, poses.select(known))
            for label, poses in demonstrations
        ]
        recognizer = Recognizer(Language("samples", gestures), profile)
        for asked, seen in SETS.items():
            right = count_right(recognizer, [(label, poses.select(seen)) for label, poses in tests])
            yield share(f"{profile}/{defined}-{asked}", right["label"], len(tests))


def natops_subsets(recorded: RecordedSet) -> Iterator[tuple[str, RecordedSet]]:
    """Yield the set with all its joints, and with those that COCO has."""
    yield "all", recorded
    names = [name for name in recorded.recordings[0].landmarks if name in COCO_17]
    reduced = [poses.select(names) for poses in recorded.recordings]
    yield "coco", replace(recorded, recordings=reduced)


def measure_natops(natops: RecordedSet, quick: bool) -> Iterator[Figure]:
    """Yield the shares with each set of joints; draws are the same for both."""
    for (name, recorded), profile in product(natops_subsets(natops), PROFILES):
        right, asked = Counter[str](), 0
        for draw in draws(recorded, 3 if quick else 30, 30, seed=1):
            language = Language("natops", demonstrated(recorded, draw.templates))
            takes = [(str(recorded.labels[each]), recorded.recordings[each]) for each in draw.own]
            right += count_right(Recognizer(language, profile), takes)
            asked += len(takes)
        for what in ("label", "nearest"):
            yield share(f"{profile}/{name}/{what}", right[what], asked)


def measurements(folder: Path, methods: tuple[str, ...]) -> Iterator[Measurement]:
    """Yield one for the sample clips, and one for NATOPS."""
    protocol = "keypoints of one estimator cut down to COCO's 17"
    yield Measurement("keypoints/samples", measure_samples, "sample clips", protocol)
    yield from measure_sets("keypoints", folder, ("natops",), measure_natops, protocol)


def write_keypoints(results: Results) -> str:
    """Write a row for each set of keypoints."""
    rows = [
        [
            f"natops, {name}",
            *(
                results.show("keypoints/natops", f"{each}/{name}/label", "cell")
                for each in PROFILES
            ),
            results.show("keypoints/natops", f"full/{name}/nearest", "cell"),
        ]
        for name in ("all", "coco")
    ]
    return table(
        ("data", *(f"`{each}`, right, %" for each in PROFILES), "`full`, nearest, %"), rows
    )


TABLES = {"keypoints": write_keypoints}
