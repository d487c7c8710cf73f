"""Endurance: runs the robot's runtime on a looped clip and measures its memory over days.

``python -m benchmarks.cost.endurance`` runs 30 minutes of stream time as fast as it goes, and
states how memory grows, how many frames are remembered, and whether every loop says the same. What
the process has of the system's memory is distinguished from what is allocated in it: an allocator
keeps pieces that are free, and takes more when several stages need theirs in the same moment.
``--models-once`` lets the models look at the first loop alone: all else is done for every frame.
"""

from __future__ import annotations

import argparse
import ctypes
import gc
import re
import sys
from collections import defaultdict
from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, Protocol

import numpy as np

from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.factory import create_estimator
from app.recognition.estimation.water import WaterCorrection
from app.recognition.poses.frame import FrameLandmarks, Image
from app.recognition.recording.live_segmentation import LONGEST_TRIGGER
from app.recognition.recording.segmentation import LONGEST_TAKE
from app.recognition.recording.video import FrameReader
from app.resources import samples_dir
from app.robot import (
    ActiveLanguage,
    Frame,
    Notice,
    Runtime,
    Source,
    TakeRecognized,
    TakeRejected,
    TriggerListener,
)

SETTLING: Final = 2 * (LONGEST_TAKE + LONGEST_TRIGGER)
"""Seconds left out of the slope, until caches are filled."""

SAME: Final = 0.02
"""Tolerance of a time stamp between loops, in seconds: half a frame."""


BEAT: Final = 1e-6
"""Tolerance of sums of periods, in seconds."""

OWN: Final = re.compile(r"^(?:RssAnon|VmSwap):\s+(\d+) kB$", re.MULTILINE)

STOCK_EVERY: Final = 10
"""Frames between two measurements of the memory; the last one in a loop counts."""


class Looped(Source, Protocol):
    """A source that repeats the same frames.

    Attributes
    ----------
    period
        Seconds of one loop.

    """

    period: float


class LoopedClip:
    """A `Source` that loops a clip for a given time on one steady clock.

    Parameters
    ----------
    clip
        The file, opened again for every loop.
    seconds
        Stream time, rounded up to whole loops.
    every
        One frame out of this many is given: with 3, a clip of 25 frames a second gives 8 a second.

    Attributes
    ----------
    period
        Seconds of one loop.
    frames
        Number of frames given in one loop.

    """

    live = False
    began = None

    def __init__(self, clip: Path, seconds: float, every: int = 1) -> None:
        self.name = f"{clip.name}, looped"
        self._clip = clip
        self._every = every
        with FrameReader(clip) as reader:
            self.frame_size = (reader.info.width, reader.info.height)
            times = [frame.time for frame in reader]
        self.period = times[-1] + times[1]
        self.frames = len(times[::every])
        self.loops = int(np.ceil(seconds / self.period))

    def __iter__(self) -> Iterator[Frame | Notice]:
        """Iterate over the frames of every loop."""
        for loop in range(self.loops):
            with FrameReader(self._clip) as reader:
                for frame in reader:
                    if frame.index % self._every == 0:
                        yield Frame(loop * self.period + frame.time, frame.image)
            # PyAV's objects form reference cycles: without this, what each opening leaves would
            # stay until Python's next full collection, hours later. A camera is opened only once.
            del reader, frame
            gc.collect()

    def close(self) -> None:
        """Do nothing: every loop closes its file."""


class FirstLoopEstimator:
    """Finds landmarks in the first loop and repeats them in all others; a `PoseEstimator`.

    Parameters
    ----------
    estimator
        The estimator that finds the landmarks.
    frames
        Number of frames in one loop.

    """

    def __init__(self, estimator: PoseEstimator, frames: int) -> None:
        self._estimator = estimator
        self._frames = frames
        self._found: list[FrameLandmarks] = []
        self._number = 0

    def estimate(self, image: Image, time: float) -> FrameLandmarks:
        """Return the result of this frame in the first loop."""
        if len(self._found) < self._frames:
            self._found.append(self._estimator.estimate(image, time))
            return self._found[-1]
        self._number += 1
        return self._found[(self._number - 1) % self._frames]

    def reset(self) -> None:
        """Clear the stored results."""
        self._estimator.reset()
        self._found.clear()
        self._number = 0

    def close(self) -> None:
        """Release the models."""
        self._estimator.close()


@dataclass(frozen=True)
class LoopAnswer:
    """The answer to one take.

    Attributes
    ----------
    label
        The label; None if rejected.
    start, end
        Seconds after its loop began.
    confidence
        In [0, 1]; None where the recogniser was not asked.

    """

    label: str | None
    start: float
    end: float
    confidence: float | None

    def is_same(self, other: LoopAnswer) -> bool:
        """Return whether two loops gave the same answer at the same moments."""
        apart = max(abs(self.start - other.start), abs(self.end - other.end))
        return self.label == other.label and apart <= SAME


@dataclass
class Lap:
    """One loop of the stream.

    Attributes
    ----------
    frames
        Number of frames processed.
    remembered
        Largest number of frames that the listener remembered.
    memory
        Bytes at the loop's end, see `own_bytes`.
    allocated
        Bytes at the loop's end, see `allocated_bytes`.
    objects
        Blocks that Python has allocated at the loop's end, of an object or two each.
    answers
        The answers to its takes.

    """

    frames: int = 0
    remembered: int = 0
    memory: int = 0
    allocated: int = 0
    objects: int = 0
    answers: list[LoopAnswer] = field(default_factory=list)


def endure(
    source: Looped,
    estimator: PoseEstimator,
    listener: TriggerListener,
    water: WaterCorrection = "auto",
) -> list[Lap]:
    """Run a looped stream to its end and measure every loop."""
    laps: defaultdict[int, Lap] = defaultdict(Lap)

    def take_stock(frame: Frame, found: FrameLandmarks) -> None:
        lap = laps[int((frame.time + BEAT) // source.period)]
        lap.frames += 1
        lap.remembered = max(lap.remembered, len(listener))
        if lap.frames % STOCK_EVERY == 0:
            lap.memory, lap.allocated = own_bytes(), allocated_bytes()
            lap.objects = sys.getallocatedblocks()

    for event in Runtime(source, estimator, listener, water=water, observer=take_stock):
        if isinstance(event, TakeRecognized | TakeRejected):
            loop = int((event.end + BEAT) // source.period)
            start, end = (moment - loop * source.period for moment in (event.start, event.end))
            label = event.label if isinstance(event, TakeRecognized) else None
            laps[loop].answers.append(LoopAnswer(label, start, end, event.confidence))
    return [laps[loop] for loop in sorted(laps)]


def own_bytes() -> int:
    """Return the private memory of this process, swapped out or not (Linux).

    The resident size would also vary with pages that the system swaps out and in.
    """
    status = Path("/proc/self/status").read_text()
    return sum(int(kilobytes) for kilobytes in OWN.findall(status)) * 1024


class HeapStatistics(ctypes.Structure):
    """Heap statistics of glibc (``struct mallinfo2``)."""

    _fields_ = tuple(
        (name, ctypes.c_size_t)
        for name in (
            *("arena", "ordblks", "smblks", "hblks", "hblkhd"),
            *("usmblks", "fsmblks", "uordblks", "fordblks", "keepcost"),
        )
    )


def allocated_bytes() -> int:
    """Return the bytes allocated in this process (glibc), without Python's objects."""
    mallinfo2 = ctypes.CDLL(None).mallinfo2
    mallinfo2.restype = HeapStatistics
    heaps = mallinfo2()
    return int(heaps.uordblks + heaps.hblkhd)


def slope_of(values: Sequence[float], period: float) -> tuple[float, float]:
    """Return the growth of a loop's value per minute of stream time, by least squares.

    Returns
    -------
    The slope, and half of its 95 % interval.

    """
    value = np.array(values, dtype=np.float64)
    minutes = np.arange(len(value)) * period / 60
    centred = minutes - minutes.mean()
    slope = float(centred @ value / (centred @ centred))
    left = value - value.mean() - slope * centred
    error = float(np.sqrt(left @ left / max(1, len(value) - 2) / (centred @ centred)))
    return slope, 1.96 * error


def report(laps: Sequence[Lap], period: float) -> None:
    """Print the result of the loops after the settling time."""
    settled = laps[int(SETTLING / period) :]
    first = settled[0].answers
    same = sum(
        len(lap.answers) == len(first)
        and all(one.is_same(other) for one, other in zip(lap.answers, first, strict=True))
        for lap in laps
    )
    sure = [
        answer.confidence for lap in laps for answer in lap.answers if answer.confidence is not None
    ]
    frames = sum(lap.frames for lap in laps)
    print(f"{len(laps)} loops, {len(laps) * period / 60:.1f} min of stream, {frames} frames")
    for name, unit, values in (
        ("memory", "kB", [lap.memory / 1e3 for lap in settled]),
        ("allocated", "kB", [lap.allocated / 1e3 for lap in settled]),
        ("Python's objects", "blocks", [lap.objects for lap in settled]),
    ):
        slope, half = slope_of(values, period)
        print(f"{name}: {values[0]:.0f} {unit} at first, {values[-1]:.0f} at last, ", end="")
        print(f"{slope:+.2f} a minute (95 %: {half:.2f} more or less)")
    print(f"most frames remembered in a loop: {laps[0].remembered} in the first, ", end="")
    print(f"{max(lap.remembered for lap in laps)} in any")
    print(f"loops that say {[said.label for said in first]}: {same} of {len(laps)}, ", end="")
    print(f"confidences {min(sure):.4f} to {max(sure):.4f}")


def main() -> None:
    """Run the stream and report."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.cost.endurance", description=__doc__
    )
    parser.add_argument("--minutes", type=float, default=30.0, help="of stream time")
    parser.add_argument("--every", type=int, default=1, help="look at one frame of so many")
    parser.add_argument("--models-once", action="store_true", help="in the first loop alone")
    parser.add_argument("--clip", type=Path, default=samples_dir() / "clips" / "line-test-1.mp4")
    parser.add_argument("--language", type=Path, default=samples_dir() / "osg-table-2.json")
    chosen = parser.parse_args()
    source = LoopedClip(chosen.clip, 60 * chosen.minutes, chosen.every)
    with closing(create_estimator()) as models:
        once = chosen.models_once
        estimator = FirstLoopEstimator(models, source.frames) if once else models
        laps = endure(source, estimator, TriggerListener(ActiveLanguage.load(chosen.language)))
    report(laps, source.period)


if __name__ == "__main__":
    main()
