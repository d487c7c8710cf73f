"""What each stage from the camera to the recognition costs, measured on the same frames in one run.

The paper gives frames per second of the camera alone, with pose estimation, and with everything
(Sec. IV; on a Jetson Orin 15, 4.91 and 4.06): what recognition itself costs is the last step.
"""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Final, Literal, get_args

from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.water import WaterCorrection, correct_colours
from app.recognition.recording.extraction import build_frame_sequence
from app.recognition.recording.salute import best_salute
from app.robot.energy import EnergyMeter
from app.robot.events import TakeRecognized, TakeRejected
from app.robot.listeners.salute_listener import Hearing
from app.robot.sources.source import Frame, Source

Stage = Literal["grab", "pose", "hands", "salute", "recognition"]

STAGES: Final[tuple[Stage, ...]] = get_args(Stage)
"""In order; each adds to those before it."""

WARM_UP: Final = 10
"""Frames that are not counted: the first ones load code and find the person."""


@dataclass(frozen=True)
class Cost:
    """What something took.

    Attributes
    ----------
    seconds
        Of the clock on the wall.
    joules
        0 where nothing measures.
    processor
        Seconds of all processors together, of this process alone.

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
    """What the stages took.

    Attributes
    ----------
    frames
        Counted.
    takes
        Ends of takes among them, recognised or rejected: recognition works at these alone.
    costs
        By stage: what it added to those before it.
    energy
        What measured the joules; None: nothing did.

    """

    frames: int = 0
    takes: int = 0
    costs: dict[Stage, Cost] = field(default_factory=lambda: {stage: Cost() for stage in STAGES})
    energy: str | None = None

    def frames_per_second(self, stage: Stage) -> float:
        """Return the rate with this stage and all before it."""
        seconds = sum(self.costs[each].seconds for each in _up_to(stage))
        return self.frames / seconds if seconds else 0.0

    def joules_per_frame(self, stage: Stage) -> float | None:
        """Return the energy of a frame with this stage and all before it."""
        if self.energy is None or not self.frames:
            return None
        return sum(self.costs[each].joules for each in _up_to(stage)) / self.frames

    @property
    def share(self) -> float:
        """By how much salutes and recognition lower the rate of pose and hands, in [0, 1]."""
        before, after = self.frames_per_second("hands"), self.frames_per_second("recognition")
        return 1 - after / before if before else 0.0

    @property
    def processor_share(self) -> float:
        """Share of the processors' time that goes to salutes and recognition, in [0, 1].

        It hardly depends on what else the machine does, nor on which stages run side by side.
        """
        whole = sum(cost.processor for cost in self.costs.values())
        ours = self.costs["salute"].processor + self.costs["recognition"].processor
        return ours / whole if whole else 0.0

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON types."""
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
    """Runs a source through two estimators, one without hands, and counts what each stage takes.

    The hands cost what the whole estimator takes more than the body alone, frame by frame: the two
    run side by side where there are processors for both.

    Parameters
    ----------
    body, whole
        Estimators without and with hands, otherwise the same.
    listener
        What hears gestures.
    water
        As in `Runtime`.
    meter
        What counts energy.

    """

    def __init__(
        self,
        body: PoseEstimator,
        whole: PoseEstimator,
        listener: Hearing,
        *,
        water: WaterCorrection = "auto",
        meter: EnergyMeter | None = None,
    ) -> None:
        self._body = body
        self._whole = whole
        self._listener = listener
        self._water = water
        self._meter = meter
        self._profile = StageProfile(energy=meter.name if meter else None)
        self._last = Cost()
        self._takes = 0

    def run(self, source: Source, is_over: Callable[[], bool]) -> StageProfile:
        """Profile a source until it ends or `is_over`, which is asked after every frame."""
        self._body.reset()
        self._whole.reset()
        self._lap()
        number = 0
        for given in source:
            if isinstance(given, Frame):
                costs: dict[Stage, Cost] = {"grab": self._lap(), **self._look(given)}
                number += 1
                if number > WARM_UP:
                    self._add(costs)
            if is_over():
                break
            self._lap()
        return self._profile

    def _look(self, frame: Frame) -> dict[Stage, Cost]:
        """Do all that a robot does with a frame, and return what each stage added."""
        image = correct_colours(frame.image, self._water)
        correction = self._lap()
        self._body.estimate(image, frame.time)
        body = self._lap()
        found = self._whole.estimate(image, frame.time)
        whole = self._lap()
        score = best_salute(found.hands)
        salute = self._lap()
        height, width = frame.image.shape[:2]
        told = self._listener.feed(build_frame_sequence(found, frame.time, (width, height)), score)
        recognition = self._lap()
        self._takes = sum(isinstance(event, TakeRecognized | TakeRejected) for event in told)
        return {
            "pose": correction + body,
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
        """Return what was taken since the last call."""
        joules = self._meter.joules() if self._meter else 0.0
        now = Cost(clock.perf_counter(), joules, clock.process_time())
        taken, self._last = now - self._last, now
        return taken


def _up_to(stage: Stage) -> tuple[Stage, ...]:
    return STAGES[: STAGES.index(stage) + 1]
