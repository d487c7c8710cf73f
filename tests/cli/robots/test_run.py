"""Control of a run: what signals and uploads may do, and when."""

from __future__ import annotations

from typing import Any, cast

import pytest

pytest.importorskip("pymavlink", reason="needs the extra mavlink")

from app.cli.robots.run import Control
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
