"""The runtime for hours: a repeated stream gives the same answers, in constant memory."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from app.recognition.poses.frame import FrameLandmarks, Image
from app.recognition.recording.live_segmentation import LONGEST_TRIGGER
from app.recognition.recording.segmentation import LONGEST_TAKE
from app.robot import Frame, Notice, TriggerListener
from benchmarks.cost.robot import Lap, LoopedClip, endure, fit_slope
from tests.api.recordings import FRAME_SIZE, RATE, recording_of
from tests.conftest import ROOT
from tests.recognition.damaged_clips import write_clip
from tests.recognition.recording.test_live_segmentation import frames_of
from tests.robot.languages import spoken

MINUTES = 6
"""Stream time: a leak of one frame's landmarks per frame would amount to 20 MB."""


class LoopedLandmarks:
    """A stream whose landmarks are known: a source, and the estimator that finds them."""

    live = False
    began = None
    name = "landmarks"
    frame_size = FRAME_SIZE

    def __init__(self, *shapes: str, seconds: float) -> None:
        self._frames = list(frames_of(recording_of(*shapes)))
        self.period = len(self._frames) / RATE
        self._loops = round(seconds / self.period)
        self._number = 0

    def __iter__(self) -> Iterator[Frame | Notice]:
        width, height = FRAME_SIZE
        image = np.zeros((height, width, 3), np.uint8)
        for loop in range(self._loops):
            for time, _ in self._frames:
                yield Frame(loop * self.period + time, image)

    def estimate(self, image: Image, time: float) -> FrameLandmarks:
        found = self._frames[self._number % len(self._frames)][1]
        self._number += 1
        return found

    def reset(self) -> None:
        self._number = 0

    def close(self) -> None:
        pass


@pytest.mark.slow
def test_every_loop_says_the_same_in_the_same_memory() -> None:
    stream = LoopedLandmarks("circle", "line", seconds=60 * MINUTES)
    listener = TriggerListener(spoken("circle", "line"))
    laps = endure(stream, stream, listener, water="off")
    assert len(laps) == round(60 * MINUTES / stream.period)
    for lap in laps:
        assert [label for label, *_ in lap.answers] == ["circle", "line"]
        assert lap.is_same(laps[0])
        for (*_, confidence), (*_, first) in zip(lap.answers, laps[0].answers, strict=True):
            # Rounding of later times moves the edge of a stroke by one frame, which changes a
            # confidence from 1.00 to 0.94.
            assert confidence == pytest.approx(first, abs=0.1)
        # Plus the frame whose stamp ends the longest take.
        assert lap.remembered <= (LONGEST_TAKE + LONGEST_TRIGGER) * RATE + 1
    settled = laps[len(laps) // 2 :]
    assert settled[-1].memory - settled[0].memory < 4e6


@pytest.mark.slow
def test_a_looped_clip_is_one_stream(tmp_path: Path) -> None:
    clip = write_clip(tmp_path / "dive.mp4", frames=10)
    source = LoopedClip(clip, 1.0, rate=12.5)
    times = [given.time for given in source if isinstance(given, Frame)]
    assert source.period == pytest.approx(0.4)
    assert source.loops == 3
    assert times == pytest.approx(np.arange(15) * 0.08)


def test_loops_that_say_something_else_or_later_differ() -> None:
    said = Lap(answers=[("circle", 1.0, 2.0, 0.9)])
    assert said.is_same(Lap(answers=[("circle", 1.01, 2.0, 0.7)]))
    assert not said.is_same(Lap())
    for label, end in (("line", 2.0), ("circle", 2.1)):
        assert not said.is_same(Lap(answers=[(label, 1.0, end, 0.9)]))


def test_the_slope_is_that_of_the_line_through_the_laps() -> None:
    slope = fit_slope("memory", [1000 + 300 * number for number in range(10)], step=0.5)
    assert slope.value == pytest.approx(600)
    assert slope.interval == pytest.approx((600, 600), abs=1e-6)


ALLOCATE = """
import numpy as np
from benchmarks.cost.robot import allocated_bytes

before = allocated_bytes()
kept = np.ones(10_000_000, np.uint8)
print(allocated_bytes() - before)
"""


def test_what_is_allocated_is_counted() -> None:
    # In a process of its own: threads of other tests free some memory meanwhile.
    run = subprocess.run(
        [sys.executable, "-c", ALLOCATE], cwd=ROOT, stdout=subprocess.PIPE, check=True
    )
    assert int(run.stdout) >= 10_000_000
