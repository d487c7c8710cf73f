"""Versions of ArduSub: what each takes is done, and what it refuses is told."""

from __future__ import annotations

import pytest

pytest.importorskip("pymavlink", reason="needs the extra mavlink")

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.robot.mavlink.test_bridge import TABLE, diving


@pytest.mark.parametrize("version", [(4, 0, 3), (4, 1, 2), (4, 5, 3), (4, 7, 0)])
def test_a_depth_is_reached_by_every_version_of_ardusub(version: tuple[int, int, int]) -> None:
    with diving(version=version) as diver:
        diver.confirm("deep")
        assert diver.wait_for("done", "NOT DONE") == "done: depth 5 m"
        # A pilot's GUIDED meanwhile must not make the vehicle swim anywhere.
        diver.confirm("free")
        diver.wait_for("done")
        diver.vehicle.pilot = mavlink.SUB_MODE_GUIDED
        diver.confirm("deep")
        assert diver.wait_for("done", "NOT DONE").startswith("NOT DONE")
    assert diver.vehicle.obeyed[:2] == ["ALT_HOLD", "depth 5"]
    assert not [each for each in diver.vehicle.obeyed if each.startswith("swims")]


@pytest.mark.parametrize(
    ("version", "mode", "said"),
    [
        ((4, 5, 3), "SURFACE", "refused (FAILED)"),
        ((4, 1, 2), "SURFACE", "done"),
        ((4, 7, 0), "SURFACE", "done"),
        ((4, 7, 0), "POSHOLD", "refused (FAILED)"),
        ((4, 7, 0), "SURFTRAK", "done"),
        ((4, 0, 3), "SURFTRAK", "refused (UNSUPPORTED)"),
    ],
)
def test_what_ardusub_refuses_is_told_as_refused(
    version: tuple[int, int, int], mode: str, said: str
) -> None:
    modes = {"gestures": {**TABLE["gestures"], "free": {"do": "mode", "mode": mode}}}
    with diving(changes=modes, version=version) as diver:
        diver.confirm("free")
        assert diver.wait_for("done", "refused", "NOT DONE").startswith(f"{said}: ")


def test_lights_with_a_function_of_their_own_are_told_as_refused() -> None:
    with diving(function=181) as diver:  # Lights1
        diver.confirm("bright")
        assert diver.wait_for("done", "refused") == "refused (FAILED): lights 50 %"
