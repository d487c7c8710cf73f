"""Extraction: what the pacing of the models saves, and the time of all code around them.

Each clip is read twice in one run: with every hand and body looked at in every frame, and as often
as they change (`arms.ArmPace`, `body.REST_SECONDS`). Printed are the ratios of processor and wall
time, the runs of the models a frame, the keypoints' differences in torso lengths, and whether the
takes have the same labels.

With ``--bare`` a whole-clip extraction (decode, pose, hands, salute) is compared with a bare loop
that feeds the very same tensors to the very same models and does nothing else. 1.00 would mean that
decoding, cropping, tracking and the salute test are free.

    python -m benchmarks.cost.extraction ../shared/data/clips/*
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from time import perf_counter, process_time
from typing import Any
from unittest.mock import patch

import numpy as np
import onnxruntime  # type: ignore[import-untyped]

from app.recognition import Language, Recognizer, Recording, record, takes_in
from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.factory import create_estimator
from app.recognition.estimation.landmark_models import arms, body
from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.recognition.poses.sequence import FloatArray
from app.resources import samples_dir

ROUNDS = 5
"""Pairs of runs; the median of their ratios is reported, since other programs may run too."""

PAUSES = (
    (arms, "HELD_SECONDS"),
    (arms, "MOVING_SECONDS"),
    (arms, "HANGING_SECONDS"),
    (arms, "UNSEEN_SECONDS"),
    (body, "REST_SECONDS"),
)


@dataclass(frozen=True, eq=False)
class ModelCall:
    """One run of one model: the session, the requested outputs, a copy of its inputs."""

    session: Any
    outputs: list[str]
    feed: dict[str, Any]


@dataclass(frozen=True, eq=False)
class Reading:
    """One reading of a clip: the recording, seconds of processor and clock, model runs a frame."""

    recording: Recording
    processor: float
    wall: float
    runs: float


@contextmanager
def recorded_calls() -> Iterator[list[ModelCall]]:
    """Record every model run inside the context."""
    original = onnxruntime.InferenceSession.run
    calls: list[ModelCall] = []

    def run(session: Any, outputs: list[str], feed: dict[str, Any], *rest: Any) -> Any:
        copies = {name: np.copy(tensor) for name, tensor in feed.items()}
        calls.append(ModelCall(session, outputs, copies))
        return original(session, outputs, feed, *rest)

    onnxruntime.InferenceSession.run = run
    try:
        yield calls
    finally:
        onnxruntime.InferenceSession.run = original


@contextmanager
def every_frame() -> Iterator[None]:
    """Let the estimator look at every hand and body in every frame."""
    patches = [patch.object(module, name, 0.0) for module, name in PAUSES]
    for each in patches:
        each.start()
    try:
        yield
    finally:
        for each in patches:
            each.stop()


def read_clip(clip: Path, estimator: PoseEstimator) -> Reading:
    """Read a clip once."""
    counted = 0
    original = onnxruntime.InferenceSession.run

    def run(*given: Any) -> Any:
        nonlocal counted
        counted += 1
        return original(*given)

    with patch.object(onnxruntime.InferenceSession, "run", run):
        processor, wall = process_time(), perf_counter()
        recording = record(clip, estimator=estimator)
        processor, wall = process_time() - processor, perf_counter() - wall
    return Reading(recording, processor, wall, counted / len(recording.poses))


def list_differences(one: Recording, other: Recording) -> FloatArray:
    """Return the distances between the same keypoints of two recordings, in torso lengths."""
    middle = [
        one.poses.xy[:, [POSE_LANDMARKS.index(f"{side}_{joint}") for side in ("left", "right")]]
        for joint in ("shoulder", "hip")
    ]
    torso = np.nanmedian(np.linalg.norm(middle[0].mean(axis=1) - middle[1].mean(axis=1), axis=1))
    far = np.linalg.norm(one.poses.xy - other.poses.xy, axis=2) / torso
    return np.asarray(far[np.isfinite(far)])


def compare_paces(clips: list[Path]) -> None:
    """Print one line per clip, and the means."""
    recognizer = Recognizer(Language.load(samples_dir() / "osg-table-2.json"))
    print("clip | processor | wall | model runs a frame | keypoints, median and 95 % | takes")
    ratios, far = [], []
    with closing(create_estimator()) as estimator:
        for clip in clips:
            with every_frame():
                full = read_clip(clip, estimator)
            paced = read_clip(clip, estimator)
            labels = [
                [recognizer.recognize(take.poses).label for take in takes_in(each.recording)]
                for each in (full, paced)
            ]
            found = list_differences(full.recording, paced.recording)
            ratios.append((paced.processor / full.processor, paced.wall / full.wall))
            far.append(found)
            print(
                f"{clip.stem} | {ratios[-1][0]:.2f} | {ratios[-1][1]:.2f} | "
                f"{full.runs:.2f} -> {paced.runs:.2f} | {np.median(found):.3f} "
                f"{np.percentile(found, 95):.3f} | "
                f"{'same' if labels[0] == labels[1] else labels}",
                flush=True,
            )
    processor, wall = np.mean(ratios, axis=0)
    every = np.concatenate(far)
    print(
        f"mean | {processor:.2f} | {wall:.2f} | | {np.median(every):.3f} "
        f"{np.percentile(every, 95):.3f} |"
    )


def compare_bare() -> None:
    """Print the ratio to a bare loop over the models, for one sample clip."""
    clip = samples_dir() / "clips" / "circle-demonstration.mp4"
    with closing(create_estimator()) as estimator:
        with recorded_calls() as calls:
            frames = len(record(clip, estimator=estimator).poses)
        ratios = []
        for _ in range(ROUNDS):
            start = perf_counter()
            for call in calls:
                call.session.run(call.outputs, call.feed)
            middle = perf_counter()
            record(clip, estimator=estimator)
            ratios.append((middle - start) / (perf_counter() - middle))
    print(
        f"extraction / bare loop over the same models: {median(ratios):.2f} of its speed "
        f"({min(ratios):.2f} to {max(ratios):.2f}, {ROUNDS} pairs, {frames} frames, "
        f"{len(calls)} model runs)"
    )


def main() -> None:
    """Print what the pacing saves, or with ``--bare`` the ratio to a bare loop."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.cost.extraction",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("clips", nargs="*", type=Path, help="all test clips if none")
    parser.add_argument("--bare", action="store_true")
    arguments = parser.parse_args()
    if arguments.bare:
        compare_bare()
    else:
        folder = samples_dir() / "clips"
        compare_paces(arguments.clips or sorted(folder.glob("*-test-*.mp4")))


if __name__ == "__main__":
    main()
