"""Speed: time of a recognition by profile ``full`` relative to the other work on a frame.

A language of twenty gestures, recordings of three seconds and 33 landmarks. Compared are one frame
of pose estimation (body and hands of a sample clip), the published implementation's steps (draw,
describe and compare once for each gesture, without the picture that it writes to the disk each
time), and the paper's steps done once for each gesture by our own code. Processor time of all
threads, so that other programs do not count; OpenCV works in one (`main`), and with
``OMP_NUM_THREADS=1`` so do the products of matrices.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass
from itertools import islice
from statistics import median
from time import process_time

import cv2
import numpy as np

from app.recognition import Gesture, Language, PoseSequence, Recognizer
from app.recognition.estimation.factory import create_estimator
from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.recognition.recording.video import read_frames
from app.resources import samples_dir
from benchmarks.cost.recognition import wander

GESTURES = 20
ROUNDS = 25
IN_A_ROW = 4
"""Runs of a task in its turn: the first follows another task, the others follow the same task."""

FRAMES = 60

ARM = {"elbow": 0.5, "wrist": 1.0, "index": 1.15, "pinky": 1.15, "thumb": 1.1}
"""Position of a landmark along the right arm, from 0 at the shoulder to 1 at the wrist."""


def whole_body(seed: int) -> PoseSequence:
    """Let a standing diver draw a smooth random figure with the right arm; all 33 landmarks."""
    drawn, random = wander(seed), np.random.default_rng(seed)
    xy = random.normal(0, 0.7, (len(drawn), len(POSE_LANDMARKS), 2))
    xy += np.stack([np.full(len(POSE_LANDMARKS), 320.0), np.linspace(80, 460, 33)], axis=1)
    for name in drawn.landmarks:
        xy[:, POSE_LANDMARKS.index(name)] = drawn.column(name)
    shoulder, wrist = drawn.column("right_shoulder"), drawn.column("right_wrist")
    for part, share in ARM.items():
        xy[:, POSE_LANDMARKS.index(f"right_{part}")] = shoulder + share * (wrist - shoulder)
    return PoseSequence(
        landmarks=POSE_LANDMARKS,
        xy=xy + random.normal(0, 0.5, xy.shape),
        time=drawn.time,
        frame_size=drawn.frame_size,
    )


@dataclass(frozen=True)
class Took:
    """The median processor time of a task, in seconds.

    Attributes
    ----------
    at_first
        Right after another task, with its own code and data no longer in the caches: as a robot
        recognises a take after hundreds of frames.
    again
        Right after the same task, as it is usually measured.

    """

    at_first: float
    again: float


def measure_seconds(*works: Callable[[], object], rounds: int = ROUNDS) -> list[Took]:
    """Measure some tasks, each after one run that does not count.

    They take turns, so that a temporary load on the machine slows all of them down alike.
    """
    for work in works:
        work()
    times: list[list[list[float]]] = [[] for _ in works]
    for _ in range(rounds):
        for work, turns in zip(works, times, strict=True):
            turns.append([_seconds(work) for _ in range(IN_A_ROW)])
    return [
        Took(
            at_first=median(turn[0] for turn in turns),
            again=median(each for turn in turns for each in turn[1:]),
        )
        for turns in times
    ]


def _seconds(work: Callable[[], object]) -> float:
    start = process_time()
    work()
    return process_time() - start


def seconds_a_frame() -> float:
    """Return the median processor time of finding body and hands in a frame of a sample clip."""
    clip = samples_dir() / "clips" / "circle-demonstration.mp4"
    times = []
    with read_frames(clip) as reader, closing(create_estimator()) as estimator:
        for frame in islice(reader, FRAMES):
            start = process_time()
            estimator.estimate(frame.image, frame.time)
            times.append(process_time() - start)
    return median(times)


def published_steps(
    demonstrations: list[PoseSequence], query: PoseSequence
) -> Callable[[], object] | None:
    """Return a function that labels a query by the published steps; None without mahotas."""
    try:
        from benchmarks.methods.base import Demonstration
        from benchmarks.methods.published import PublishedCode
    except ModuleNotFoundError:
        return None
    method = PublishedCode()
    method.fit([Demonstration(f"figure {at}", each) for at, each in enumerate(demonstrations)])
    frames = method.gather(query)  # as they arrive there, one by one
    return lambda: method.name(frames)


def main() -> None:
    """Print the ratios."""
    # Idle threads of OpenCV spin, and their time would count for the published steps.
    cv2.setNumThreads(1)
    demonstrations = [whole_body(seed) for seed in range(GESTURES)]
    gestures = [
        Gesture.from_demonstration(f"figure {number}", poses)
        for number, poses in enumerate(demonstrations)
    ]
    language, query = Language("bench", gestures), whole_body(GESTURES)
    recognizer = Recognizer(language, "full")
    alone = [Recognizer(Language("one", [gesture]), "paper") for gesture in gestures]
    steps = published_steps(demonstrations, query)
    recognition, once_each, published = measure_seconds(
        lambda: recognizer.recognize(query),
        lambda: [one.recognize(query) for one in alone],
        steps or (lambda: None),
    )
    frame = seconds_a_frame()

    def add() -> Recognizer:
        added = Gesture.from_demonstration("one more", query)
        return Recognizer(language.with_gesture(added), "full")

    (adding,) = measure_seconds(add, rounds=3)
    head = f"profile full, {GESTURES} gestures, {len(POSE_LANDMARKS)} landmarks: "
    of_a_frame = recognition.at_first / frame
    print(f"{head}a recognition takes {of_a_frame:.2f} of one frame of pose estimation")
    if steps is None:
        print(f"{head}the published steps need mahotas, which has no wheel for this platform")
    else:
        print(f"{head}a recognition takes {_ratio(recognition, published)} of the published steps")
    print(
        f"{head}a recognition takes {_ratio(recognition, once_each)} of the paper's steps done "
        "once a gesture by our own code"
    )
    print(
        f"{head}adding a gesture takes {adding.again / recognition.again:.0f} recognitions, "
        f"{adding.again / frame:.0f} frames of pose estimation"
    )


def _ratio(one: Took, other: Took) -> str:
    again, at_first = one.again / other.again, one.at_first / other.at_first
    return f"{again:.3f} ({at_first:.3f} right after other work)"
