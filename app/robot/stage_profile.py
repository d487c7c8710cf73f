"""Stage profile: time and energy of each stage from camera to recognition, in one run.

The paper reports frames per second of the camera alone, with pose estimation, and with all stages
(Sec. IV; on a Jetson Orin 15, 4.91 and 4.06): the last step is the cost of recognition.
"""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Final, Literal, get_args

from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.water import WaterCorrection
from app.recognition.estimation.water_sight import WaterSight
from app.recognition.recording.extraction import build_frame_sequence
from app.recognition.recording.people_in_stream import PeopleInStream
from app.recognition.recording.salute import best_salute
from app.robot.energy import EnergyMeter
from app.robot.events import TakeRecognized, TakeRejected
from app.robot.listeners.salute_listener import LandmarkListener
from app.robot.sources.source import Frame, Source

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
        return Cost(
            self.seconds + other.seconds,
            self.joules + other.joules,
            self.processor + other.processor,
        )

    def __sub__(self, other: Cost) -> Cost:
        return Cost(
            self.seconds - other.seconds,
            self.joules - other.joules,
            self.processor - other.processor,
        )


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
        seconds = sum(self.costs[each].seconds for each in _up_to(stage))
        return self.frames / seconds if seconds else 0.0

    def joules_per_frame(self, stage: Stage) -> float | None:
        """Return the energy per frame with this stage and all before it; None without a meter."""
        if self.energy is None or not self.frames:
            return None
        return sum(self.costs[each].joules for each in _up_to(stage)) / self.frames

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
    water
        As in `Runtime`.
    meter
        Measures energy.

    """

    def __init__(
        self,
        body: PoseEstimator,
        whole: PoseEstimator,
        listener: LandmarkListener,
        *,
        water: WaterCorrection = "auto",
        meter: EnergyMeter | None = None,
    ) -> None:
        self._body = WaterSight(body, water)
        self._whole = WaterSight(whole, water)
        self._people = PeopleInStream()
        self._listener = listener
        self._meter = meter
        self._profile = StageProfile(energy=meter.name if meter else None)
        self._last = Cost()
        self._takes = 0

    def run(self, source: Source, is_over: Callable[[], bool]) -> StageProfile:
        """Profile a source until it ends or `is_over`, called after every frame, returns True."""
        self._body.reset()
        self._whole.reset()
        self._lap()
        number = 0
        for given in source:
            if isinstance(given, Frame):
                costs: dict[Stage, Cost] = {"grab": self._lap(), **self._process(given)}
                number += 1
                if number > WARM_UP:
                    self._add(costs)
            if is_over():
                break
            self._lap()
        return self._profile

    def _process(self, frame: Frame) -> dict[Stage, Cost]:
        """Run all stages on a frame and return the cost of each."""
        self._body.estimate(frame.image, frame.time)
        body = self._lap()
        found = self._whole.estimate(frame.image, frame.time)
        whole = self._lap()
        _, found = self._people.follow(frame.time, found).frames[-1]
        score = best_salute(found.hands)
        salute = self._lap()
        height, width = frame.image.shape[:2]
        moment = build_frame_sequence(found, frame.time, (width, height))
        events = self._listener.feed(moment, score)
        recognition = self._lap()
        self._takes = sum(isinstance(event, TakeRecognized | TakeRejected) for event in events)
        return {
            "pose": body,
            "hands": whole - body,
            "salute": salute,
            "recognition": recognition,
        }

    def _add(self, costs: dict[Stage, Cost]) -> None:
        profile = self._profile
        profile.frames += 1
        profile.takes += self._takes
        for stage, cost in costs.items():
            profile.costs[stage] += cost

    def _lap(self) -> Cost:
        """Return the cost since the last call."""
        joules = self._meter.read_joules() if self._meter else 0.0
        now = Cost(clock.perf_counter(), joules, clock.process_time())
        taken, self._last = now - self._last, now
        return taken


def _up_to(stage: Stage) -> tuple[Stage, ...]:
    return STAGES[: STAGES.index(stage) + 1]
