"""Control of a run: what signals and uploads may do, and when."""

from __future__ import annotations

import signal
from typing import Any, cast

import pytest

pytest.importorskip("pymavlink", reason="needs the extra mavlink")

from app.cli.robots.run import Control, handle_signals
from tests.robot.mavlink.test_bridge import diving


class Stoppable:
    """A runtime and a watcher that are only stopped."""

    stopped = False

    def stop(self) -> None:
        self.stopped = True


def test_a_vehicle_table_is_not_replaced_during_an_emergency() -> None:
    control, run = Control(), Stoppable()
    with diving() as diver:
        control.begin(cast("Any", run), cast("Any", run), diver.bridge)
        assert control.find_obstacle("vehicle") == ""
        diver.vehicle.is_slow = True
        diver.show("help")
        assert control.find_obstacle("vehicle").startswith("an emergency is in progress")
        assert control.find_obstacle("language") == ""
        diver.vehicle.is_slow = False
        diver.wait_for("done: surface")
        assert control.find_obstacle("vehicle") == ""
    control.take_file("vehicle")
    assert run.stopped


@pytest.mark.parametrize("first", [signal.SIGINT, signal.SIGTERM])
def test_a_second_signal_of_any_kind_ends_at_once(first: signal.Signals) -> None:
    before = [signal.getsignal(kind) for kind in (signal.SIGINT, signal.SIGTERM)]
    stops: list[bool] = []
    with handle_signals(lambda: stops.append(True), lambda: None):
        assert signal.getsignal(first) not in before
        signal.raise_signal(first)
        after = [signal.getsignal(kind) for kind in (signal.SIGINT, signal.SIGTERM)]
    assert stops == [True]
    assert after == before
