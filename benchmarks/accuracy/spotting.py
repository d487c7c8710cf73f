"""Spotting: precision, recall and false alarms in continuous streams without salutes.

Half of a set's classes make a language, one template each by one person; streams are composed of
that person's or of other people's takes, of the classes left out, and of accidental movements
(`benchmarks/sets/streams.py`). A gesture counts as found if a report has its label and the middle
of the report lies within the gesture; every other report is a false alarm.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from app.recognition import Language, Recognizer
from app.recognition.spotting import Spotted, Spotter
from benchmarks.figures import Figure, Measurement, Results, share, table
from benchmarks.sets.every_set import count_people, measure_sets
from benchmarks.sets.one_shot_draws import demonstrated
from benchmarks.sets.recorded_sets import RecordedSet
from benchmarks.sets.streams import Event, Stream, compose, with_body

SETS = ("digits", "letters", "grufba3d")
BARS = (0.5, 0.7, 0.8, 0.9, 0.95)
"""Thresholds on a report's confidence; the spotter runs with the first."""


@dataclass(frozen=True)
class Detections:
    """A stream with all its reports and their times."""

    stream: Stream
    reports: list[tuple[float, Spotted]]


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
    for moment in stream.poses.time.tolist():
        found = spotter.feed(stream.poses.between(moment, moment))
        reports += [(moment, each) for each in found]
    end = float(stream.poses.time[-1])
    return Detections(stream, reports + [(end, each) for each in spotter.finish()])


def judge(one: Detections, bar: float) -> tuple[int, int]:
    """Count hits and reports of at least a confidence."""
    unfound = [event for event in one.stream.events if event.label is not None]
    found = 0
    reports = [each for _, each in one.reports if each.recognition.confidence >= bar]
    for report in reports:
        meant = _at(one.stream.events, (report.start + report.end) / 2)
        if meant in unfound and meant is not None and meant.label == report.recognition.label:
            unfound.remove(meant)
            found += 1
    return found, len(reports)


def _at(events: tuple[Event, ...], moment: float) -> Event | None:
    return next((event for event in events if event.start <= moment <= event.end), None)


def measure_spotting(recorded: RecordedSet, quick: bool) -> Iterator[Figure]:
    """Yield hits and false alarms in streams of the same person's takes, and of others'."""
    recorded = with_body(recorded)
    for who in ("same", "another") if count_people(recorded) else ("anybody",):
        drawn = streams(recorded, who == "another", 1 if quick else 3, 30, seed=1)
        everything = [detect(recognizer, stream) for recognizer, stream in drawn]
        hours = sum(one.stream.poses.duration for one in everything) / 3600
        gestures = sum(e.label is not None for one in everything for e in one.stream.events)
        for bar in BARS:
            judged = [judge(one, bar) for one in everything]
            found, reported = (sum(each[index] for each in judged) for index in (0, 1))
            name = f"{who}/{bar:.0%}".rstrip("%")
            yield share(f"{name}/precision", found, reported)
            yield share(f"{name}/recall", found, gestures)
            yield Figure(f"{name}/alarms-an-hour", (reported - found) / hours, gestures, unit="")
        late = [moment - each.end for one in everything for moment, each in one.reports]
        for per_cent in (50, 95):
            seconds = float(np.percentile(late, per_cent))
            yield Figure(f"{who}/delay-{per_cent}", seconds, len(late), unit="")
        yield Figure(f"{who}/minutes", 60 * hours, len(everything), unit="")


def measurements(folder: Path, methods: tuple[str, ...]) -> Iterator[Measurement]:
    """Yield one for each set."""
    yield from measure_sets(
        "spotting",
        folder,
        SETS,
        measure_spotting,
        "3 streams of 30 gestures, foreign gestures and background motion, without salutes",
    )


def write_spotting(results: Results) -> str:
    """Write precision, recall and false alarms at the spotter's least confidence."""
    rows = []
    for name in results.names("spotting"):
        measured = f"spotting/{name}"
        for who in ("same", "another", "anybody"):
            start = f"{who}/{BARS[0]:.0%}".rstrip("%")
            if f"{start}/recall" in results.measured[measured].figures:
                rows.append(
                    [
                        f"{name}, {who}",
                        results.show(measured, f"{start}/recall", "n"),
                        results.show(measured, f"{who}/minutes", "whole"),
                        results.show(measured, f"{start}/precision", "cell"),
                        results.show(measured, f"{start}/recall", "cell"),
                        results.show(measured, f"{start}/alarms-an-hour", "whole"),
                        results.show(measured, f"{who}/delay-50", "bare"),
                    ]
                )
    head = ("stream", "gestures", "minutes", "precision, %", "recall, %", "false alarms an hour")
    return table((*head, "reported after, s"), rows)


TABLES = {"spotting": write_spotting}
