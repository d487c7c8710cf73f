"""Emergencies and takes between two gestures: what acts at once, and what asks."""

from __future__ import annotations

import pytest

pytest.importorskip("pymavlink", reason="needs the extra mavlink")

from tests.robot.mavlink.test_bridge import DONE, diving


def test_the_showing_after_a_pair_is_obeyed() -> None:
    with diving() as diver:
        diver.show(None, pair=("bright", "help"))
        assert diver.wait_for("help", "bright") == "help or bright? show it again"
        diver.show("bright")
        assert diver.wait_for("done") == "done: lights 50 %"
    assert diver.vehicle.obeyed == DONE["bright"]
    assert "help or bright? show it again" in diver.vehicle.texts


def test_an_emergency_is_obeyed_only_when_it_is_near() -> None:
    with diving() as diver:
        diver.show("help", novelty=0.9)
        assert diver.wait_for("not", "EMERGENCY").startswith("not understood")
        diver.show("help", novelty=0.7)
        assert diver.wait_for("done") == "done: surface"


def test_an_emergency_is_obeyed_at_once_and_somewhat_late() -> None:
    with diving() as diver:
        diver.delay = 9.0
        diver.show("help")
        assert diver.wait_for("done") == "done: surface"
    assert diver.vehicle.obeyed == ["SURFACE"]
    assert "EMERGENCY: surface" in diver.vehicle.texts


def test_an_emergency_replaces_what_is_on_its_way() -> None:
    with diving() as diver:
        diver.vehicle.loss = 1.0
        diver.confirm("bright")
        diver.show("help")
        assert diver.wait_for("replaced") == "replaced: lights 50 %"
        diver.vehicle.loss = 0.0
        assert diver.wait_for("done") == "done: surface"
    assert diver.vehicle.obeyed == ["SURFACE"]


def test_an_ordinary_command_never_replaces_an_emergency() -> None:
    with diving() as diver:
        diver.vehicle.loss = 1.0
        diver.show("help")
        diver.confirm("free")
        assert diver.wait_for("replaced", "NOT DONE") == (
            "NOT DONE, EMERGENCY goes on: mode STABILIZE"
        )
        diver.vehicle.loss = 0.0
        assert diver.wait_for("done") == "done: surface"
        diver.confirm("free")
        assert diver.wait_for("done") == "done: mode STABILIZE"
    assert diver.vehicle.obeyed == ["SURFACE", "STABILIZE"]
