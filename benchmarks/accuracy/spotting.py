"""Spotting: precision, recall and false alarms in continuous streams without salutes.

Half of a set's classes make a language, one template each by one person; streams are composed of
that person's or of other people's takes, of the classes left out, and of accidental movements
(`benchmarks/sets/streams.py`). A gesture counts as found if a report has its label and the middle
of the report lies within the gesture; every other report is a false alarm.

    python -m benchmarks.accuracy.spotting ../shared/data --streams 3 --events 30 --seed 1
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

import numpy as np

from app.evaluation.share import Share
from app.recognition import Language, Recognizer
from app.recognition.estimation.factory import create_estimator
from app.recognition.recording.video import read_frames
from app.recognition.spotting import Spotted, Spotter
from benchmarks.sets.one_shot_draws import demonstrated
from benchmarks.sets.recorded_sets import RecordedSet, recorded_sets
from benchmarks.sets.streams import Event, Stream, compose, with_body
from languages.build import FOLDER

SETS = ("digits", "letters", "grufba3d")
BARS = (0.5, 0.7, 0.8, 0.9, 0.95)
"""Thresholds on a report's confidence; the spotter runs with the first."""

CLIP_FRAMES = 60
"""Frames of a clip on which pose estimation is timed."""


@dataclass(frozen=True)
class Detections:
    """A stream with all its reports and their times."""

    stream: Stream
    reports: list[tuple[float, Spotted]]
    seconds_worked: float


def streams(
    recorded: RecordedSet, others: bool, count: int, events: int, seed: int
) -> Iterator[tuple[Recognizer, Stream]]:
    """Draw languages, and compose a stream for each."""
    random = np.random.default_rng(seed)
    classes = np.unique(recorded.labels)
    for _ in range(count):
        own = recorded.people == random.choice(np.unique(recorded.people))
        known = random.permutation(classes)[: len(classes) // 2 + 1]
        templates = [
            int(random.choice(np.flatnonzero(own & (recorded.labels == label)))) for label in known
        ]
        recognizer = Recognizer(Language(recorded.name, demonstrated(recorded, templates)))
        people = ~own if others else own
        yield recognizer, compose(recorded, known.tolist(), people, events, random)


def detect(recognizer: Recognizer, stream: Stream) -> Detections:
    """Listen to a stream frame by frame."""
    spotter = Spotter(recognizer, confident=BARS[0])
    reports: list[tuple[float, Spotted]] = []
    begun = perf_counter()
    for moment in stream.poses.time.tolist():
        found = spotter.feed(stream.poses.between(moment, moment))
        reports += [(moment, each) for each in found]
    worked = perf_counter() - begun
    end = float(stream.poses.time[-1])
    return Detections(stream, reports + [(end, each) for each in spotter.finish()], worked)


def judge(one: Detections, bar: float) -> tuple[int, int, Counter[str]]:
    """Count hits, reports, and the events on which false alarms fall."""
    unfound = [event for event in one.stream.events if event.label is not None]
    found, alarms = 0, Counter[str]()
    reports = [each for _, each in one.reports if each.recognition.confidence >= bar]
    for report in reports:
        middle = (report.start + report.end) / 2
        meant = _at(one.stream.events, middle)
        if meant in unfound and meant is not None and meant.label == report.recognition.label:
            unfound.remove(meant)
            found += 1
        else:
            alarms[meant.kind if meant else "between"] += 1
    return found, len(reports), alarms


def _at(events: tuple[Event, ...], moment: float) -> Event | None:
    return next((event for event in events if event.start <= moment <= event.end), None)


def print_judgement(name: str, everything: list[Detections]) -> None:
    """Print one line per threshold."""
    hours = sum(one.stream.poses.duration for one in everything) / 3600
    gestures = sum(e.label is not None for one in everything for e in one.stream.events)
    for bar in BARS:
        found, reported, alarms = 0, 0, Counter[str]()
        for one in everything:
            right, reports, wrong = judge(one, bar)
            found, reported, alarms = found + right, reported + reports, alarms + wrong
        print(
            f"{name:16} {bar:4} precision {Share(found, reported)} recall {Share(found, gestures)} "
            f"false/h {sum(alarms.values()) / hours:.0f} {dict(alarms)}, n {gestures}, "
            f"{60 * hours:.0f} min",
            flush=True,
        )
    delays = [moment - each.end for one in everything for moment, each in one.reports]
    print(f"{name:16} seconds from end to report, 50 and 95 %: {np.percentile(delays, (50, 95))}")


def pose_seconds() -> float:
    """Time pose and hand estimation of one frame of a sample clip."""
    estimator = create_estimator()
    lasted = []
    with read_frames(FOLDER / "clips" / "circle-test-1.mp4") as reader:
        for frame, _ in zip(reader, range(CLIP_FRAMES), strict=False):
            begun = perf_counter()
            estimator.estimate(frame.image, frame.time)
            lasted.append(perf_counter() - begun)
    estimator.close()
    return float(np.median(lasted))


def main() -> None:
    """Print precision, recall and false alarms per set, and the processing time per frame."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("data", type=Path, help="the folder that holds trajectories/")
    parser.add_argument("--streams", type=int, default=3, help="streams per set")
    parser.add_argument("--events", type=int, default=30, help="events per stream")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    worked, frames = 0.0, 0
    for bodiless in recorded_sets(given.data / "trajectories"):
        if bodiless.name not in SETS:
            continue
        recorded = with_body(bodiless)
        for others in (False, True) if len(np.unique(recorded.people)) > 1 else (False,):
            drawn = streams(recorded, others, given.streams, given.events, given.seed)
            everything = [detect(recognizer, stream) for recognizer, stream in drawn]
            print_judgement(f"{recorded.name} {'other' if others else 'same'}", everything)
            worked += sum(one.seconds_worked for one in everything)
            frames += sum(len(one.stream.poses) for one in everything)
    print(f"work a frame over pose estimation of one: {worked / frames / pose_seconds():.2f}")


if __name__ == "__main__":
    main()
