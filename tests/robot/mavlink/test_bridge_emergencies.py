"""Emergencies and takes between two gestures: what acts at once, and what asks."""

from __future__ import annotations

from contextlib import ExitStack

import pytest

pytest.importorskip("pymavlink", reason="needs the extra mavlink")

from app.robot import TriggerListener
from app.robot.commands.replies import Reply
from app.robot.mavlink.bridge import MavlinkBridge
from app.robot.mavlink.links import open_link
from app.robot.mavlink.table import VehicleTable
from app.robot.runtime import build_language_changed
from tests.api.recordings import recording_of
from tests.robot.languages import run_listener, spoken
from tests.robot.mavlink.diver import DONE, TABLE, diving, talking, wait_until
from tests.robot.mavlink.mavlink2rest import serving
from tests.robot.mavlink.vehicle import sailing


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


@pytest.mark.parametrize(
    ("link", "second", "said", "obeyed"),
    [
        ("udp", "circle", "done: hold", ["ALT_HOLD"]),
        ("tcp", "square", "done: depth 5 m", ["ALT_HOLD", "depth 5"]),
        ("mavlink2rest", "line", "is cancelled", []),
        ("udp", "rounded square", "not understood; begin again", []),
    ],
)
def test_circle_or_square_is_asked_of_the_diver_whose_answer_is_obeyed(
    link: str, second: str, said: str, obeyed: list[str]
) -> None:
    """From the landmarks of a rounded square to the vehicle, over real sockets."""
    language = spoken("circle", "square", "line")
    gestures = {"circle": {"do": "hold"}, "square": {"do": "depth", "metres": 5}}
    changes = {"gestures": gestures, "emergency": {}, "cancel": ["line"]}
    table = VehicleTable.model_validate({**TABLE, **changes, "answers": {"show": ["lights"]}})
    first, shown = (
        run_listener(TriggerListener(language), recording_of("rounded square", *further))
        for further in ((), (second,))
    )
    lines: list[str] = []
    with sailing(kind="tcpin" if link == "tcp" else "udpin") as vehicle, ExitStack() as opened:
        address = {
            "udp": f"udpout:127.0.0.1:{vehicle.port}",
            "tcp": f"tcp:127.0.0.1:{vehicle.port}",
        }.get(link) or opened.enter_context(serving(vehicle.port))
        bridge = MavlinkBridge(table, open_link(address, 1, 1), lambda: language, lines.append)
        with talking(bridge):
            wait_until(lambda: bool(vehicle.reports) and bridge._facts.function == 0)
            bridge.publish(build_language_changed(0.0, language))
            for event in first:
                bridge.publish(event)
            wait_until(lambda: len(vehicle.shown) == 2 * Reply.one_of_two.pulses)
            wait_until(lambda: bridge.has_replied)
            assert any(line.endswith("? show it again") for line in lines)
            assert [each for each in vehicle.obeyed if not each.startswith("servo")] == []
            for event in shown[len(first) :]:
                bridge.publish(event)
            wait_until(lambda: any(said in line for line in lines))
    assert [each for each in vehicle.obeyed if not each.startswith("servo")] == obeyed
    assert "circle or square? show it again" in vehicle.texts
