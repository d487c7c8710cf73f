"""Stages: time and energy of each stage from camera to recognition, in one run.

The paper reports frames per second of the camera alone, with pose estimation, and with all stages
(Sec. IV; on a Jetson Orin 15, 4.91 and 4.06): the last step is the cost of recognition. Printed are
one JSON object on stdout and a table on stderr, at the end of the source or at Ctrl-C.

    python -m benchmarks.cost.stages --language languages/osg-table-2.json --source 0
"""

from __future__ import annotations

import argparse
import json
import operator
import re
import shutil
import subprocess
import threading
import time as clock
from collections.abc import Callable
from contextlib import ExitStack, closing, suppress
from dataclasses import astuple, dataclass, field
from pathlib import Path
from typing import Any, Final, Literal, Protocol, get_args

from rich import box
from rich.console import Console
from rich.table import Table

from app.cli.robots.run import handle_signals
from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.factory import NO_HANDS, create_estimator
from app.recognition.estimation.water import WaterSight
from app.recognition.recording.extraction import build_frame_sequence
from app.recognition.recording.live_segmentation import PeopleInStream
from app.recognition.recording.salute import best_salute
from app.robot import create_listener, open_source
from app.robot.active_language import LanguageWatcher
from app.robot.events import TakeEvent
from app.robot.listeners.trigger_listener import LandmarkListener
from app.robot.sources.source import Frame, Source

POWERCAP: Final = Path("/sys/class/powercap")
"""Folder of Linux with the energy counters of Intel's and AMD's processors (RAPL)."""

TEGRASTATS: Final = "tegrastats"

INTERVAL_MS: Final = 100
"""Milliseconds between two lines of tegrastats, a few frames; a shorter interval uses energy
itself."""

RAIL: Final = re.compile(r"(\w+) (\d+)(?:mW)?/\d+(?:mW)?(?=\s|$)")
"""Matches ``NAME now/average`` in milliwatts, with or without the unit."""

WHOLE_BOARD: Final = ("VDD_IN", "POM_5V_IN")
"""Rails that feed all others; on a board without them the sum of all rails is used."""


class EnergyMeter(Protocol):
    """Protocol of a meter that counts energy from its creation on."""

    name: str
    """Name of the measured device and of the tool."""

    def read_joules(self) -> float:
        """Return the energy used since the meter was created."""

    def close(self) -> None:
        """Stop counting."""


class RaplMeter:
    """Energy of all processors of a PC, from their own counters; an `EnergyMeter`.

    Parameters
    ----------
    folder
        Folder of the counters.

    Raises
    ------
    OSError
        When there are no counters, or this user may not read them.

    """

    name = "processor packages, RAPL"

    def __init__(self, folder: Path = POWERCAP) -> None:
        packages = [
            zone
            for zone in sorted(folder.glob("*-rapl:*"))
            if (zone / "name").read_text().startswith("package")
        ]
        if not packages:
            raise FileNotFoundError(f"no RAPL counter in {folder}")
        self._counters = [zone / "energy_uj" for zone in packages]
        self._ranges = [int((zone / "max_energy_range_uj").read_text()) for zone in packages]
        self._last = self._read()
        self._microjoules = 0

    def read_joules(self) -> float:
        """Return the energy used since creation; call it at least once per wrap of a counter."""
        now = self._read()
        for before, after, span in zip(self._last, now, self._ranges, strict=True):
            self._microjoules += (after - before) % (span + 1)
        self._last = now
        return self._microjoules / 1e6

    def close(self) -> None:
        """Do nothing: the system keeps the counters."""

    def _read(self) -> list[int]:
        return [int(counter.read_text()) for counter in self._counters]


class TegrastatsMeter:
    """Energy of a Jetson, from NVIDIA's tool tegrastats; an `EnergyMeter`.

    Parameters
    ----------
    command
        Name or path of the tool.

    Raises
    ------
    OSError
        When the tool is not installed.

    """

    name = "board, tegrastats"

    def __init__(self, command: str = TEGRASTATS) -> None:
        self._joules = 0.0
        self._process = subprocess.Popen(
            [command, "--interval", str(INTERVAL_MS)], stdout=subprocess.PIPE, text=True
        )
        self._thread = threading.Thread(target=self._read, name="tegrastats", daemon=True)
        self._thread.start()

    def read_joules(self) -> float:
        """Return the energy used since creation, up to the tool's last line."""
        return self._joules

    def close(self) -> None:
        """Stop the tool."""
        self._process.terminate()
        self._process.wait()
        self._thread.join()

    def _read(self) -> None:
        assert self._process.stdout is not None
        before = clock.monotonic()
        with self._process.stdout as lines:
            for line in lines:
                now = clock.monotonic()
                self._joules += parse_watts(line) * (now - before)
                before = now


def parse_watts(line: str) -> float:
    """Return the power in a line of tegrastats, in watts."""
    rails = {name: int(power) for name, power in RAIL.findall(line)}
    whole = [rails[name] for name in WHOLE_BOARD if name in rails]
    return (whole[0] if whole else sum(rails.values())) / 1000


def open_energy_meter() -> EnergyMeter | None:
    """Open the energy meter of this machine; None where it has none."""
    if shutil.which(TEGRASTATS):
        return TegrastatsMeter()
    with suppress(OSError, ValueError):
        return RaplMeter()
    return None


Stage = Literal["grab", "pose", "hands", "salute", "recognition"]

STAGES: Final[tuple[Stage, ...]] = get_args(Stage)
"""Stages in order; the cost of each comes on top of those before it."""

WARM_UP: Final = 10
"""Number of first frames that are not measured: these load code and find the person."""


@dataclass(frozen=True)
class Cost:
    """Cost of a stage.

    Attributes
    ----------
    seconds
        Wall-clock time.
    joules
        Energy; 0 without a meter.
    processor
        Processor time of this process, in seconds over all processors.

    """

    seconds: float = 0.0
    joules: float = 0.0
    processor: float = 0.0

    def __add__(self, other: Cost) -> Cost:
        return Cost(*map(operator.add, astuple(self), astuple(other)))

    def __sub__(self, other: Cost) -> Cost:
        return Cost(*map(operator.sub, astuple(self), astuple(other)))


@dataclass
class StageProfile:
    """Costs of the stages.

    Attributes
    ----------
    frames
        Number of measured frames.
    takes
        Takes that ended in these frames, recognised or rejected; only these need recognition.
    costs
        Cost of each stage, without those before it.
    energy
        Name of the energy meter; None without one.

    """

    frames: int = 0
    takes: int = 0
    costs: dict[Stage, Cost] = field(default_factory=lambda: {stage: Cost() for stage in STAGES})
    energy: str | None = None

    def frames_per_second(self, stage: Stage) -> float:
        """Return the frame rate with this stage and all before it."""
        seconds = self._up_to(stage).seconds
        return self.frames / seconds if seconds else 0.0

    def joules_per_frame(self, stage: Stage) -> float | None:
        """Return the energy per frame with this stage and all before it; None without a meter."""
        if self.energy is None or not self.frames:
            return None
        return self._up_to(stage).joules / self.frames

    def _up_to(self, stage: Stage) -> Cost:
        return sum((self.costs[each] for each in STAGES[: STAGES.index(stage) + 1]), Cost())

    @property
    def share(self) -> float:
        """Share by which salutes and recognition lower the rate of pose and hands, in [0, 1]."""
        before, after = self.frames_per_second("hands"), self.frames_per_second("recognition")
        return 1 - after / before if before else 0.0

    @property
    def processor_share(self) -> float:
        """Share of salutes and recognition in the processor time, in [0, 1].

        It hardly depends on the machine's other load or on stages that run in parallel.
        """
        whole = sum(cost.processor for cost in self.costs.values())
        ours = self.costs["salute"].processor + self.costs["recognition"].processor
        return ours / whole if whole else 0.0

    def to_dict(self) -> dict[str, Any]:
        """Convert to plain JSON types."""
        return {
            "frames": self.frames,
            "takes": self.takes,
            "stages": [
                {
                    "up_to": stage,
                    "frames_per_second": self.frames_per_second(stage),
                    "joules_per_frame": self.joules_per_frame(stage),
                }
                for stage in STAGES
            ],
            "share_of_recognition": self.share,
            "share_of_processor_time": self.processor_share,
            "energy": self.energy,
        }


class StageProfiler:
    """Profiler: runs a source through two estimators, one without hands, and measures each stage.

    The cost of the hands is the difference between the two estimators, frame by frame, because body
    and hands run in parallel if there are processors for both.

    Parameters
    ----------
    body, whole
        Estimators without and with hands, otherwise the same.
    listener
        Recognises gestures.
    meter
        Measures energy.

    """

    def __init__(
        self,
        body: PoseEstimator,
        whole: PoseEstimator,
        listener: LandmarkListener,
        *,
        meter: EnergyMeter | None = None,
    ) -> None:
        self._body = WaterSight(body, "auto")
        self._whole = WaterSight(whole, "auto")
        self._people = PeopleInStream()
        self._listener = listener
        self._meter = meter
        self._last = Cost()

    def run(self, source: Source, is_over: Callable[[], bool] = bool) -> StageProfile:
        """Profile a source until it ends or `is_over`, called after every frame, returns True."""
        profile = StageProfile(energy=self._meter.name if self._meter else None)
        self._body.reset()
        self._whole.reset()
        self._lap()
        number = 0
        for given in source:
            if isinstance(given, Frame):
                costs: dict[Stage, Cost] = {"grab": self._lap()}
                takes = self._process(given, costs)
                number += 1
                if number > WARM_UP:
                    profile.frames += 1
                    profile.takes += takes
                    for stage, cost in costs.items():
                        profile.costs[stage] += cost
            if is_over():
                break
            self._lap()
        return profile

    def _process(self, frame: Frame, costs: dict[Stage, Cost]) -> int:
        """Run all stages on a frame, add the cost of each, and return the takes that ended."""
        self._body.estimate(frame.image, frame.time)
        costs["pose"] = self._lap()
        found = self._whole.estimate(frame.image, frame.time)
        costs["hands"] = self._lap() - costs["pose"]
        _, found = self._people.follow(frame.time, found).frames[-1]
        score = best_salute(found.hands)
        costs["salute"] = self._lap()
        height, width = frame.image.shape[:2]
        moment = build_frame_sequence(found, frame.time, (width, height))
        events = self._listener.feed(moment, score)
        costs["recognition"] = self._lap()
        return sum(isinstance(event, TakeEvent) for event in events)

    def _lap(self) -> Cost:
        """Return the cost since the last call."""
        joules = self._meter.read_joules() if self._meter else 0.0
        now = Cost(clock.perf_counter(), joules, clock.process_time())
        taken, self._last = now - self._last, now
        return taken


def build_table(profile: StageProfile) -> Table:
    """Build a table with one row per stage: frame rate and energy up to this stage."""
    takes = "1 take" if profile.takes == 1 else f"{profile.takes} takes"
    caption = (
        f"{profile.frames} frames, {takes}; recognition lowers the rate of pose and "
        f"hands by {profile.share:.1%} and takes {profile.processor_share:.1%} of the processor's "
        f"time; energy: {profile.energy or 'not measured on this machine'}"
    )
    table = Table("with", caption=caption, caption_justify="left", box=box.SIMPLE_HEAD)
    table.add_column("frames a second", justify="right")
    table.add_column("joules a frame", justify="right")
    for stage in STAGES:
        joules = profile.joules_per_frame(stage)
        energy = "" if joules is None else f"{joules:.2f}"
        table.add_row(f"+ {stage}", f"{profile.frames_per_second(stage):.1f}", energy)
    return table


def main(arguments: list[str] | None = None) -> None:
    """Profile a source until it ends, or a signal stops it."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--language", type=Path, required=True, help="language file")
    parser.add_argument("--source", default="0", help="as of `osg-studio robot`")
    parser.add_argument("--estimator", default="onnx", help="as of `osg-studio robot`")
    options = parser.parse_args(arguments)
    stops: list[bool] = []
    with ExitStack() as opened:
        watcher = opened.enter_context(LanguageWatcher(options.language))
        listener = create_listener(watcher.first)
        source = opened.enter_context(closing(open_source(options.source)))
        whole = opened.enter_context(closing(create_estimator(options.estimator)))
        body = opened.enter_context(closing(create_estimator(options.estimator, hands=NO_HANDS)))
        opened.enter_context(handle_signals(lambda: stops.append(True), lambda: None))
        if meter := open_energy_meter():
            opened.enter_context(closing(meter))
        profile = StageProfiler(body, whole, listener, meter=meter).run(source, lambda: bool(stops))
    print(json.dumps(profile.to_dict(), allow_nan=False))
    Console(stderr=True).print(build_table(profile))


if __name__ == "__main__":
    main()
