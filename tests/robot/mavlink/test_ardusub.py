"""Versions of ArduSub: what each takes is done, and what it refuses is told."""

from __future__ import annotations

import pytest

pytest.importorskip("pymavlink", reason="needs the extra mavlink")

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from tests.robot.mavlink.test_bridge import diving


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
    ("version", "label", "said"),
    [
        ((4, 5, 3), "up", "refused (FAILED): surface"),
        ((4, 1, 2), "up", "done: surface"),
        ((4, 7, 0), "up", "done: surface"),
    ],
)
def test_what_ardusub_refuses_is_told_as_refused(
    version: tuple[int, int, int], label: str, said: str
) -> None:
    with diving(version=version) as diver:
        diver.confirm(label)
        assert diver.wait_for("done", "refused", "NOT DONE") == said


def test_lights_with_a_function_of_their_own_are_told_as_refused() -> None:
    with diving(function=181) as diver:  # Lights1
        diver.confirm("bright")
        assert diver.wait_for("done", "refused") == "refused (FAILED): lights 50 %"
