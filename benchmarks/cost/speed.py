"""Speed: processor time of the recogniser's work relative to other work in the same run.

A language of twenty gestures, takes of three seconds and 33 landmarks, drawn at random. Compared
are: one frame of pose estimation (body and hands of a sample clip), the published implementation's
steps (draw, describe and compare once for each gesture, without the picture that it writes to the
disk each time), the paper's steps done once for each gesture by our own code, larger languages, and
corrections of water. Processor time of all threads, so that other programs do not count; OpenCV
works in one, since its idle threads spin, and with ``OMP_NUM_THREADS=1`` so do products of
matrices.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import closing
from functools import partial
from itertools import cycle, islice
from pathlib import Path
from statistics import fmean, median
from time import process_time

import cv2
import numpy as np

from app.recognition import Gesture, Language, PoseSequence, Recognizer, record
from app.recognition.estimation.factory import create_estimator
from app.recognition.estimation.water import CORRECTIONS, apply_correction
from app.recognition.gestures.profile import PROFILES
from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.recognition.recording.video import read_frames
from app.resources import samples_dir
from benchmarks.figures import Figure, Measurement, ratio
from benchmarks.methods.base import Demonstration

CLIPS = samples_dir() / "clips"
GESTURES = 20
SIZES = (100, 1000)
SMALLEST = 8
IN_A_ROW = 4
"""Runs of a task in its turn: the first follows another task, the others follow the same task."""

FRAMES = 60
"""Frames of a clip that are estimated, about two seconds."""

LARGE = (1768, 994)
"""Pixels of the largest of the real clips, which is enlarged from a sample clip here."""

ARM = {"elbow": 0.5, "wrist": 1.0, "index": 1.15, "pinky": 1.15, "thumb": 1.1}
"""Position of a landmark along the right arm, from 0 at the shoulder to 1 at the wrist."""


def wander(seed: int) -> PoseSequence:
    """Let a standing diver draw a smooth random figure with the right arm; all 33 landmarks."""
    random = np.random.default_rng(seed)
    time = np.linspace(0.0, 3.0, 90)
    phase = 2 * np.pi * np.outer(np.arange(1, 5), time / time[-1])
    size = random.normal(size=(2, 4)) / np.arange(1, 5)
    wrist = size @ np.sin(phase + random.uniform(0, 2 * np.pi, size=(4, 1)))
    wrist = 200 + (wrist * 120 / np.ptp(wrist, axis=1).max()).T
    xy = np.stack([np.full(len(POSE_LANDMARKS), 320.0), np.linspace(80, 460, 33)], axis=1)
    xy = xy + random.normal(0, 0.7, (len(time), len(POSE_LANDMARKS), 2))
    shoulder = np.array([260.0, 160.0])
    for name, place in (
        ("right_shoulder", shoulder),
        ("left_shoulder", np.array([380.0, 160.0])),
        ("right_hip", np.array([280.0, 340.0])),
        ("left_hip", np.array([360.0, 340.0])),
        *((f"right_{part}", shoulder + along * (wrist - shoulder)) for part, along in ARM.items()),
    ):
        xy[:, POSE_LANDMARKS.index(name)] = place
    return PoseSequence(
        landmarks=POSE_LANDMARKS,
        xy=xy + random.normal(0, 0.5, xy.shape),
        time=time,
        frame_size=(640, 480),
    )


def learn(count: int) -> Language:
    """Return a language of that many random figures."""
    return Language("bench", [Gesture.from_demonstration(f"{n}", wander(n)) for n in range(count)])


def seconds(work: Callable[[], object]) -> float:
    """Return the processor time of some work."""
    start = process_time()
    work()
    return process_time() - start


def compare_work(quick: bool) -> Iterator[Figure]:
    """Compare a recognition by profile ``full`` with other work; every round does all of it."""
    cv2.setNumThreads(1)
    language, query = learn(GESTURES), wander(GESTURES)
    recognizer = Recognizer(language, "full")
    alone = [Recognizer(Language("one", [each]), "paper") for each in language.gestures]

    def add() -> None:
        Recognizer(language.with_gesture(Gesture.from_demonstration("one more", query)), "full")

    works: dict[str, Callable[[], object]] = {
        "recognition": partial(recognizer.recognize, query),
        "paper": lambda: [one.recognize(query) for one in alone],
    }
    try:
        from benchmarks.methods.published import PublishedCode
    except ModuleNotFoundError:
        print("The published steps are left out: mahotas has no wheel for this platform.")
    else:
        method = PublishedCode()
        method.fit([Demonstration(f"{n}", wander(n)) for n in range(GESTURES)])
        works["published"] = partial(method.name, method.gather(query))
    found: dict[str, list[float]] = {}
    with read_frames(CLIPS / "circle-demonstration.mp4") as reader:
        images = [each.image for each in islice(reader, FRAMES)]
    with closing(create_estimator()) as estimator:
        frames = cycle(partial(estimator.estimate, each) for each in images)
        for number in range(5 if quick else 25):
            frame = fmean(
                seconds(partial(next(frames), 0.04 * (number * IN_A_ROW + each)))
                for each in range(IN_A_ROW)
            )
            turns = {name: [seconds(work) for _ in range(IN_A_ROW)] for name, work in works.items()}
            if number == 0:  # it loads code
                continue
            first, *again = turns.pop("recognition")
            found.setdefault("of-a-frame", []).append(first / frame)
            for name, (other_first, *other_again) in turns.items():
                found.setdefault(f"of-{name}", []).append(median(again) / median(other_again))
                found.setdefault(f"of-{name}-at-first", []).append(first / other_first)
    recognition = median(seconds(works["recognition"]) for _ in range(25))
    found["adding"] = [seconds(add) / recognition for _ in range(3)]
    yield from (ratio(name, values) for name, values in found.items())


def compare_sizes(quick: bool) -> Iterator[Figure]:
    """Compare recognitions by larger languages with one of eight gestures.

    The query is rendered and described once per distinct set of salient keypoints, so a thousand
    gestures must cost far less than 125 times as much as eight.
    """
    whole, query = learn(max(SIZES)), wander(max(SIZES))
    for profile in PROFILES:
        recognizers = [
            Recognizer(Language("bench", whole.gestures[:size]), profile)
            for size in (SMALLEST, *SIZES)
        ]
        rounds = [
            [seconds(partial(each.recognize, query)) for each in recognizers]
            for _ in range(4 if quick else 16)
        ][1:]
        for place, size in enumerate(SIZES, 1):
            yield ratio(f"{profile}/{size}", [each[place] / each[0] for each in rounds])


def compare_water(quick: bool) -> Iterator[Figure]:
    """Compare the automatic water correction with none, and each correction with a frame."""
    clips = sorted(CLIPS.glob("*-test-1.mp4"))[: 1 if quick else 6]
    automatic = []
    with closing(create_estimator()) as estimator:
        read = partial(record, estimator=estimator)
        for clip in clips:
            without = seconds(partial(read, clip, water="off"))
            automatic.append(seconds(partial(read, clip, water="auto")) / without)
        with read_frames(clips[0]) as reader:
            images = [each.image for each in islice(reader, FRAMES)]
        frame = median(
            seconds(partial(estimator.estimate, image, 0.04 * number))
            for number, image in enumerate(images)
        )
    yield ratio("automatic", automatic)
    for name, image in (("small", images[0]), ("large", cv2.resize(images[0], LARGE))):
        for correction in CORRECTIONS[1:]:
            work = partial(apply_correction, np.asarray(image, np.uint8), correction)
            work()
            yield ratio(f"{name}/{correction}", [seconds(work) / frame for _ in range(10)])


def measurements(folder: Path, methods: tuple[str, ...]) -> Iterator[Measurement]:
    """Yield what each part of the recogniser costs."""
    for name, run, data, protocol in (
        ("recognition", compare_work, "random figures", "a recognition to other work, 24 rounds"),
        ("gestures", compare_sizes, "random figures", "languages of 100 and 1000 gestures to 8"),
        ("water", compare_water, "sample clips", "the choice of a water correction, to none"),
    ):
        protocol += "; processor time, median and range"
        yield Measurement(f"speed/{name}", run, data, protocol, alone=True)
