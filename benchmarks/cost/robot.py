"""Robot: its share of a frame's time, its memory over long, and what it reads at low frame rates.

`stages`: the frame rate with each stage of the runtime, to decoding alone (`stages.py`, which also
profiles a camera and language of your own). `endurance`: a clip in a loop, as one stream through
the runtime. What the process has of the system's memory is distinguished from what is allocated in
it: an allocator keeps pieces that are free. `rates`: the test clips of the sample languages through
the runtime, thinned to a number of frames a second.
"""

from __future__ import annotations

import ctypes
import gc
import re
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, closing
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Final, Protocol

import numpy as np

from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.factory import NO_HANDS, create_estimator
from app.recognition.estimation.water import WaterCorrection
from app.recognition.poses.frame import FrameLandmarks
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
    create_listener,
    open_source,
)
from benchmarks.cost.stages import STAGES, StageProfiler
from benchmarks.figures import Figure, Measurement, Results, share, table

CLIPS = samples_dir() / "clips"
LANGUAGE = samples_dir() / "osg-table-2.json"

SETTLING: Final = 2 * (LONGEST_TAKE + LONGEST_TRIGGER)
"""Seconds left out of the slope, until caches are filled."""

SAME: Final = 0.02
"""Tolerance of a time stamp between loops, in seconds: half a frame."""

BEAT: Final = 1e-6
"""Tolerance of sums of periods, in seconds."""

OWN: Final = re.compile(r"^(?:RssAnon|VmSwap):\s+(\d+) kB$", re.MULTILINE)

STOCK_EVERY: Final = 10
"""Frames between two measurements of the memory; the last one in a loop counts."""

RATES: Final = (25, 8, 6, 5, 4, 3, 2.5, 2, 1.5)
"""Frames a second; the clips have 25."""

MEASURES: Final = ("app/recognition", "app/robot")

OUTCOMES: Final = ("right", "wrong", "rejected", "none")


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
        Stream time, rounded up to whole loops; 0: the clip once.
    rate
        Most frames a second, at even steps within a loop.

    Attributes
    ----------
    period
        Seconds of one loop.

    """

    live = False
    began = None

    def __init__(self, clip: Path, seconds: float = 0.0, rate: float = np.inf) -> None:
        self.name = f"{clip.name}, looped"
        self._clip, self._step = clip, 1 / rate
        with FrameReader(clip) as reader:
            self.frame_size = (reader.info.width, reader.info.height)
            times = [frame.time for frame in reader]
        self.period = times[-1] + times[1]
        self.loops = max(1, int(np.ceil(seconds / self.period)))

    def __iter__(self) -> Iterator[Frame | Notice]:
        """Iterate over the frames of every loop."""
        for loop in range(self.loops):
            due = 0.0
            with FrameReader(self._clip) as reader:
                for frame in reader:
                    if frame.time >= due - BEAT:
                        due += self._step
                        yield Frame(loop * self.period + frame.time, frame.image)
            # PyAV's objects form reference cycles: without this, what each opening leaves would
            # stay until Python's next full collection, hours later. A camera is opened only once.
            del reader, frame
            gc.collect()

    def close(self) -> None:
        """Do nothing: every loop closes its file."""


@dataclass
class Lap:
    """One loop of the stream.

    Attributes
    ----------
    frames
        Number of frames processed.
    remembered
        Largest number of frames that the listener remembered.
    memory, allocated
        Bytes at the loop's end, see `own_bytes` and `allocated_bytes`.
    answers
        Label (None: rejected), start and end in seconds after its loop began, and confidence (None:
        the recogniser was not asked) of each take.

    """

    frames: int = 0
    remembered: int = 0
    memory: int = 0
    allocated: int = 0
    answers: list[tuple[str | None, float, float, float | None]] = field(default_factory=list)

    def is_same(self, other: Lap) -> bool:
        """Return whether both loops gave the same answers at the same moments."""
        return len(self.answers) == len(other.answers) and all(
            one[0] == two[0] and max(abs(one[1] - two[1]), abs(one[2] - two[2])) <= SAME
            for one, two in zip(self.answers, other.answers, strict=True)
        )


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

    for event in Runtime(source, estimator, listener, water=water, observer=take_stock):
        if isinstance(event, TakeRecognized | TakeRejected):
            loop = int((event.end + BEAT) // source.period)
            start, end = (moment - loop * source.period for moment in (event.start, event.end))
            label = event.label if isinstance(event, TakeRecognized) else None
            laps[loop].answers.append((label, start, end, event.confidence))
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


def fit_slope(name: str, values: Sequence[float], step: float) -> Figure:
    """Return the growth of values that are `step` apart, by least squares, with a 95 % interval."""
    value = np.array(values, dtype=np.float64)
    place = np.arange(len(value)) * step
    centred = place - place.mean()
    slope = float(centred @ value / (centred @ centred))
    left = value - value.mean() - slope * centred
    error = float(np.sqrt(left @ left / max(1, len(value) - 2) / (centred @ centred)))
    return Figure(name, slope, len(value), (slope - 1.96 * error, slope + 1.96 * error), "")


def measure_endurance(quick: bool) -> Iterator[Figure]:
    """Loop a clip for minutes of stream time, and yield kilobytes a minute and equal loops."""
    source = LoopedClip(CLIPS / "line-test-1.mp4", 180 if quick else 600, rate=12.5)
    with closing(create_estimator()) as estimator:
        laps = endure(source, estimator, TriggerListener(ActiveLanguage.load(LANGUAGE)))
    settled = laps[int(SETTLING / source.period) :]
    yield share("same-answers", sum(lap.is_same(settled[0]) for lap in laps), len(laps))
    for name in ("memory", "allocated"):
        kilobytes = [getattr(lap, name) / 1e3 for lap in settled]
        yield fit_slope(name, kilobytes, source.period / 60)
    remembered = max(lap.remembered for lap in laps)
    seconds = remembered * source.period / max(lap.frames for lap in laps)
    yield Figure("remembered-seconds", seconds, len(laps), unit="")


def measure_stages(quick: bool) -> Iterator[Figure]:
    """Profile the stages on three sample clips."""
    language = ActiveLanguage.load(LANGUAGE)
    rates: dict[str, list[float]] = defaultdict(list)
    for name in ("square", "circle", "line")[: 1 if quick else None]:
        with ExitStack() as opened:
            source = opened.enter_context(closing(open_source(str(CLIPS / f"{name}-test-1.mp4"))))
            whole = opened.enter_context(closing(create_estimator()))
            body = opened.enter_context(closing(create_estimator(hands=NO_HANDS)))
            profile = StageProfiler(body, whole, create_listener(language)).run(source)
        grabbed = profile.frames_per_second("grab")
        for stage in STAGES[1:]:
            rates[stage].append(profile.frames_per_second(stage) / grabbed)
        rates["reduction"].append(profile.share)
        rates["processor"].append(profile.processor_share)
    for name, values in rates.items():
        low, high = min(values), max(values)
        yield Figure(name, float(np.median(values)), len(values), (low, high))


def measure_rate(rate: float, quick: bool) -> Iterator[Figure]:
    """Play the test clips once at a frame rate, and yield what becomes of their takes."""
    language = ActiveLanguage.load(LANGUAGE)
    found: Counter[str] = Counter()
    clips = sorted(CLIPS.glob("*-test-*.mp4"))[: 4 if quick else None]
    with closing(create_estimator()) as estimator:
        for clip in clips:
            events = [*Runtime(LoopedClip(clip, rate=rate), estimator, create_listener(language))]
            labels = {each.label for each in events if isinstance(each, TakeRecognized)}
            if labels:
                found["right" if labels == {clip.stem.partition("-")[0]} else "wrong"] += 1
            else:
                found[
                    "rejected" if any(isinstance(e, TakeRejected) for e in events) else "none"
                ] += 1
    for outcome in OUTCOMES:
        yield share(outcome, found[outcome], len(clips))


def measurements(folder: Path, methods: tuple[str, ...]) -> Iterator[Measurement]:
    """Yield the cost of the robot's runtime."""
    yield Measurement(
        "robot/stages",
        measure_stages,
        "three sample clips",
        "frame rate up to a stage, to decoding alone; median and range",
        measures=MEASURES,
        alone=True,
    )
    yield Measurement(
        "robot/endurance",
        measure_endurance,
        "a looped sample clip",
        "ten minutes of stream at 12.5 frames a second; growth a minute after 140 s, in kB",
        measures=MEASURES,
    )
    for rate in RATES:
        yield Measurement(
            f"robot/rate-{rate:g}",
            partial(measure_rate, rate),
            "16 sample clips",
            "takes through the runtime, thinned to a number of frames a second",
            measures=MEASURES,
        )


def write_rates(results: Results) -> str:
    """Write what becomes of the sample takes at each frame rate."""
    rows = [
        [f"{rate:g}", *(results.show(f"robot/rate-{rate:g}", each, "hits") for each in OUTCOMES)]
        for rate in RATES
    ]
    return table(("frames a second", "recognised", "wrong", "rejected", "no take found"), rows)


def write_stages(results: Results) -> str:
    """Write the frame rates up to each stage beside the paper's, on a Jetson Orin (Sec. IV)."""
    paper = {"hands": "33 %", "recognition": "27 %", "reduction": "17 %"}
    names = {"reduction": "**reduction of the rate by salute and recognition**"}
    rows = [["grab", "100 %", "100 %"]] + [
        [names.get(each, f"+ {each}"), results.show("robot/stages", each), paper.get(each, "")]
        for each in (*STAGES[1:], "reduction")
    ]
    return table(("stages", "two-core computer", "paper, Jetson Orin"), rows)


TABLES = {"rates": write_rates, "stages": write_stages}
