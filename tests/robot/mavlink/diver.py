"""A diver who shows gestures to a bridge, before a vehicle in simulated time or by sockets."""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, closing, contextmanager
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

pytest.importorskip("pymavlink", reason="needs the extra mavlink")

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from app.recognition import Gesture, Language, takes_in
from app.robot import (
    ActiveLanguage,
    TakeRecognized,
    TakeRejected,
    TriggerListener,
)
from app.robot.mavlink import bridge, talk
from app.robot.mavlink.bridge import MavlinkBridge
from app.robot.mavlink.links import VehicleLink, open_link
from app.robot.mavlink.table import VehicleTable
from app.robot.runtime import build_language_changed
from tests.api.recordings import recording_of
from tests.robot.languages import run_listener, spoken
from tests.robot.mavlink.vehicle import STEP, Ardusub, SimulatedVehicle, sailing

TABLE: dict[str, Any] = {
    "format": "osg-studio/vehicle-table",
    "version": 1,
    "gestures": {
        "stop": {"do": "hold"},
        "up": {"do": "surface"},
        "free": {"do": "mode", "mode": "STABILIZE"},
        "bright": {"do": "lights", "percent": 50},
        "photo": {"do": "camera"},
        "deep": {"do": "depth", "metres": 5},
    },
    "emergency": {"help": "surface"},
    "cancel": ["no"],
    "vehicle": {"repeat_seconds": 0.02, "give_up_seconds": 5},
}
DONE = {
    "stop": ["ALT_HOLD"],
    "up": ["SURFACE"],
    "free": ["STABILIZE"],
    "bright": ["servo 13 1500"],
    "photo": ["picture"],
    "deep": ["ALT_HOLD", "depth 5"],
}
DOES: dict[str, Callable[[Ardusub], bool]] = {
    "stop": lambda vehicle: vehicle.mode == mavlink.SUB_MODE_ALT_HOLD,
    "up": lambda vehicle: vehicle.mode == mavlink.SUB_MODE_SURFACE,
    "free": lambda vehicle: vehicle.mode == mavlink.SUB_MODE_STABILIZE,
    "bright": lambda vehicle: vehicle.pulse == 1500,
    "photo": lambda vehicle: "picture" in vehicle.obeyed,
    "deep": lambda vehicle: (vehicle.mode, vehicle.target) == (mavlink.SUB_MODE_ALT_HOLD, -5),
}
WAIT = 20.0


@cache
def crew() -> ActiveLanguage:
    """Return a language with the gestures of the table, and one that it does not name."""
    demonstration = takes_in(recording_of("circle"))[0].poses
    labels = [*DONE, "help", "no", "other"]
    gestures = [Gesture.from_demonstration(label, demonstration) for label in labels]
    return ActiveLanguage.from_json(Language("crew", gestures).to_json())


@cache
def a_take() -> TakeRecognized:
    events = run_listener(TriggerListener(spoken("circle")), recording_of("circle"))
    return next(event for event in events if isinstance(event, TakeRecognized))


@cache
def a_rejected_take() -> TakeRejected:
    events = run_listener(TriggerListener(spoken("circle")), recording_of("line"))
    return next(event for event in events if isinstance(event, TakeRejected))


class Diver:
    """Shows gestures to a bridge, one every five seconds of the source's clock."""

    def __init__(
        self,
        vehicle: Ardusub | None,
        address: str,
        table: VehicleTable,
        link: VehicleLink | None = None,
        memory: Path | None = None,
    ) -> None:
        self.time = 0.0
        self.delay = 0.0
        self.lines: queue.Queue[str] = queue.Queue()
        self._simulated = vehicle if isinstance(vehicle, SimulatedVehicle) else None
        if vehicle is not None:
            self.vehicle = vehicle
        link = link or open_link(address, table.vehicle.system, table.vehicle.component)
        clock: Callable[[], float] = lambda: self.time + self.delay  # noqa: E731
        self.bridge = MavlinkBridge(table, link, crew, self.lines.put, clock, memory=memory)
        self.bridge.start()
        self.bridge.publish(build_language_changed(0.0, crew()))

    def show(
        self,
        label: str | None,
        language: ActiveLanguage | None = None,
        *,
        pair: tuple[str, str] | None = None,
        novelty: float = 0.1,
    ) -> None:
        """Show a gesture: recognised, rejected (None), or between two."""
        self.time += 5.0
        recognition = a_take().recognition.model_copy(update={"novelty": np.full(1, novelty)})
        take: TakeRecognized | TakeRejected = replace(a_rejected_take(), pair=pair)
        if label is not None:
            take = replace(a_take(), label=label, recognition=recognition)
        sha256 = (language or crew()).sha256
        self.bridge.publish(
            replace(take, time=self.time, start=self.time - 3, end=self.time - 1, sha256=sha256)
        )

    def confirm(self, label: str) -> None:
        """Show a gesture twice."""
        self.show(label)
        self.show(label)

    def wait_for(self, *beginnings: str) -> str:
        """Return the next line that begins in one of these ways."""
        while True:
            if self._simulated is not None:
                self.wait_until(lambda: not self.lines.empty())
            line = self.lines.get(timeout=WAIT)
            if line.startswith(beginnings):
                return line

    def wait(self, seconds: float) -> None:
        """Let time pass, on the vehicle's clock."""
        if self._simulated is None:
            time.sleep(seconds)
        else:
            self._simulated.wait(seconds)

    def wait_until(self, happens: Callable[[], bool]) -> None:
        """Wait until something happens; an error after a long time."""
        if self._simulated is None:
            wait_until(happens)
            return
        by = self._simulated.now + WAIT
        while not happens():
            assert self._simulated.now < by
            self._simulated.wait(STEP)

    def close(self) -> None:
        """Close the bridge, while time passes."""
        bridge = self.bridge
        closes = threading.Thread(target=bridge.close)
        closes.start()
        bridge._talk.closing.wait()
        while self._simulated is not None and bridge._talk._thread.is_alive():
            self._simulated.wait(STEP)
        closes.join()


@contextmanager
def talking(opened: MavlinkBridge) -> Iterator[MavlinkBridge]:
    """Let a bridge talk with its vehicle until the end of the block."""
    opened.start()
    with closing(opened):
        yield opened


def wait_until(happens: Callable[[], bool]) -> None:
    """Wait until something happens; an error after a long time."""
    by = time.monotonic() + WAIT
    while not happens():
        assert time.monotonic() < by
        time.sleep(0.01)


@contextmanager
def diving(
    kind: str = "simulated",
    changes: Mapping[str, object] = TABLE,
    memory: Path | None = None,
    **settings: Any,
) -> Iterator[Diver]:
    """Put a diver and a vehicle into the water, with a bridge between them.

    In simulated time, or by the sockets of a kind: ``udpin`` or ``tcpin``.
    """
    table = VehicleTable.model_validate({**TABLE, **changes})
    scheme = {"udpin": "udpout", "tcpin": "tcp"}.get(kind)
    with ExitStack() as opened:
        if scheme is None:
            vehicle = SimulatedVehicle(**settings)
            patched = opened.enter_context(pytest.MonkeyPatch.context())
            for module in (bridge, talk):
                clock = SimpleNamespace(monotonic=lambda: vehicle.now)
                patched.setattr(module, "clock", clock)
            diver = Diver(vehicle, "", table, cast("VehicleLink", vehicle), memory)
        else:
            real = opened.enter_context(sailing(kind=kind, **settings))
            diver = Diver(real, f"{scheme}:127.0.0.1:{real.port}", table, memory=memory)
        opened.enter_context(closing(diver))
        yield diver
