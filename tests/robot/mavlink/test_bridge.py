"""The bridge: a vehicle obeys only a diver's confirmed commands; both sides use pymavlink."""

from __future__ import annotations

import queue
import random
from dataclasses import replace

import pytest

pytest.importorskip("pymavlink", reason="needs the extra mavlink")

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from app.recognition.phrases.grammar import Grammar
from app.recognition.phrases.phrase import OneOf, Phrase, Slot, SlotType
from app.robot import (
    ActiveLanguage,
    FrameRateChanged,
    OutputFailed,
    PhraseHeard,
    PhraseListener,
    RecognitionReady,
    SourceEnded,
    TriggerListener,
)
from app.robot.mavlink import peer
from app.robot.mavlink.bridge import MavlinkBridge
from app.robot.mavlink.links import open_link
from app.robot.mavlink.table import VehicleTable
from app.robot.mavlink.talk import TEXT_BYTES, fit_text
from app.robot.runtime import build_language_changed
from tests.api.recordings import recording_of
from tests.robot.languages import language_of, run_listener, spoken
from tests.robot.mavlink.diver import (
    DOES,
    DONE,
    TABLE,
    WAIT,
    a_take,
    crew,
    diving,
    talking,
    wait_until,
)
from tests.robot.mavlink.vehicle import sailing


@pytest.mark.parametrize(("kind", "missions"), [("simulated", 100), ("udpin", 10), ("tcpin", 10)])
def test_confirmed_missions_are_obeyed_though_a_fifth_is_lost_and_the_vehicle_restarts(
    kind: str, missions: int
) -> None:
    chance, photos = random.Random(0), 0
    with diving(kind, loss=0.2, seed=1) as diver:
        shown = ""
        for number in range(missions):
            shown = chance.choice([label for label in DONE if label != shown])
            diver.vehicle.obeyed.clear()
            if number % 10 == 9:
                # A restart shows by a clock that goes back, so the clock has to go on before.
                diver.wait_until(lambda: diver.vehicle.uptime > 1.5)
                diver.vehicle.restarts_at_next = True
            diver.confirm(shown)
            assert diver.wait_for("done", "refused", "NOT DONE").startswith("done")
            assert DOES[shown](diver.vehicle)
            assert set(diver.vehicle.obeyed) <= set(DONE[shown])
            photos += shown == "photo"
            # A repeated request has the number of the first, by which a camera may know it.
            assert len(set(diver.vehicle.pictures)) == photos


def test_nothing_that_was_not_confirmed_is_asked_of_the_vehicle() -> None:
    chance = random.Random(0)
    with diving() as diver:
        for _ in range(100):
            label = chance.choice([*DONE])
            other = chance.choice([each for each in [*DONE, "other"] if each != label])
            match chance.randrange(7):
                case 0:  # once, and something else
                    diver.show(label)
                    diver.show(other)
                case 1:  # taken back
                    diver.show(label)
                    diver.show("no")
                    diver.show(other)
                case 2:  # not recognised
                    diver.show(label)
                    diver.show(None)
                case 3:  # too late
                    diver.show(label)
                    diver.time += 30.0
                case 4:  # stale
                    diver.delay = 4.0
                    diver.confirm(label)
                    diver.delay = 0.0
                case 5:  # of another language
                    diver.show(label, spoken("circle"))
                    diver.show(label, spoken("circle"))
                case 6:  # between two gestures, twice or followed by a third
                    diver.show(None, pair=(label, "help"))
                    diver.show(None, pair=(label, "help"))
                    diver.show(None, pair=("help", label))
                    diver.show("other")
            diver.show("no")
        diver.wait_for("nothing to cancel")
    assert diver.vehicle.asked == 0
    assert diver.vehicle.obeyed == []


@pytest.mark.withstands(row="H36")
def test_a_cancel_stops_a_confirmed_command_that_is_not_carried_out_yet() -> None:
    with diving(is_slow=True) as diver:
        diver.confirm("deep")
        diver.wait_until(lambda: diver.vehicle.asked > 0)
        diver.show("no")
        said = diver.wait_for("cancelled", "nothing")
        assert said.startswith("cancelled: depth 5 m; DO_SET_MODE ALT_HOLD was sent ")
        asked = diver.vehicle.asked
        diver.vehicle.is_slow = False
        diver.wait_until(lambda: diver.vehicle.mode == mavlink.SUB_MODE_ALT_HOLD)
        diver.wait(0.3)
        diver.show("no")
        assert diver.wait_for("cancelled", "nothing") == "nothing to cancel"
    assert diver.vehicle.asked <= asked + 1
    assert diver.vehicle.obeyed == ["ALT_HOLD"]
    assert fit_text(said).decode() in diver.vehicle.texts


def test_a_cancel_never_stops_an_emergency() -> None:
    with diving(is_slow=True) as diver:
        diver.show("help")
        diver.show("no")
        assert diver.wait_for("EMERGENCY is") == "EMERGENCY is not cancelled: surface"
        diver.vehicle.is_slow = False
        assert diver.wait_for("done") == "done: surface"


def test_a_pilot_who_sets_the_old_mode_again_and_again_is_not_fought() -> None:
    with diving(pilot=mavlink.SUB_MODE_MANUAL) as diver:
        for label, words in (("help", "surface"), ("stop", "hold")):
            diver.vehicle.obeyed.clear()
            if label == "help":
                diver.show(label)
            else:
                diver.confirm(label)
            said = diver.wait_for("done", "NOT DONE")
            assert said == f"NOT DONE, stays in MANUAL: {words}"
            assert len(diver.vehicle.obeyed) <= 2
    assert diver.vehicle.texts.count("NOT DONE, stays in MANUAL: surface") == 1


@pytest.mark.withstands(row="H35")
@pytest.mark.parametrize("label", ["help", "stop"])
def test_a_pilot_who_changes_the_mode_ends_the_order(label: str) -> None:
    with diving(is_slow=True) as diver:
        if label == "help":
            diver.show(label)
        else:
            diver.confirm(label)
        diver.wait_until(lambda: diver.vehicle.asked > 0)
        diver.wait(0.1)  # the first heartbeat after a request may be older than it
        diver.vehicle.pilot = mavlink.SUB_MODE_STABILIZE
        assert diver.wait_for("done", "NOT DONE").startswith(
            "NOT DONE, the pilot changed the mode: "
        )
        asked = diver.vehicle.asked
        diver.wait(0.3)
        assert diver.vehicle.asked == asked


@pytest.mark.withstands(row="H35")
def test_a_disarmed_vehicle_is_told_and_never_done() -> None:
    with diving(armed=False) as diver:
        diver.wait_until(lambda: diver.bridge._talk.peer.sender is not None)
        diver.wait(0.1)
        for label, words in (("stop", "hold"), ("deep", "depth 5 m")):
            diver.confirm(label)
            assert diver.wait_for("done", "NOT DONE") == f"NOT DONE, vehicle is disarmed: {words}"
        assert diver.vehicle.asked == 0
        diver.confirm("bright")
        assert diver.wait_for("done", "NOT DONE") == "done: lights 50 %"
        diver.show("help")
        assert diver.wait_for("done", "vehicle is") == "vehicle is disarmed: surface"
        diver.wait_until(lambda: diver.vehicle.mode == mavlink.SUB_MODE_SURFACE)
        diver.wait(0.2)
        assert diver.lines.empty()
        diver.vehicle.armed = True
        assert diver.wait_for("done", "NOT DONE") == "done: surface"
    assert "vehicle is disarmed: surface" in diver.vehicle.texts


def test_a_vehicle_that_is_disarmed_ends_an_ordinary_order() -> None:
    with diving(is_slow=True) as diver:
        diver.confirm("stop")
        diver.wait_until(lambda: diver.vehicle.asked > 0)
        diver.vehicle.armed = False
        assert diver.wait_for("done", "NOT DONE") == "NOT DONE, vehicle is disarmed: hold"


@pytest.mark.parametrize("stopped", [True, False])
def test_a_robot_that_ends_lets_go_of_a_vehicle_that_does_not_answer(stopped: bool) -> None:
    with diving() as diver:
        diver.vehicle.loss = 1.0
        diver.show("help")
        diver.wait_for("EMERGENCY")
        diver.bridge.publish(SourceEnded(diver.time, 100, 0, stopped))
        diver.close()
        assert not diver.bridge._talk._thread.is_alive()
        reason = "robot is stopped" if stopped else "robot has ended"
        assert diver.wait_for("NOT DONE") == f"NOT DONE, {reason}: surface"


def test_what_a_diver_must_know_of_the_robot_is_on_the_vehicles_displays() -> None:
    with diving() as diver:
        diver.wait_until(lambda: diver.bridge._talk.peer.sender is not None)
        diver.bridge.publish(RecognitionReady(1.0))
        diver.bridge.publish(FrameRateChanged(6.0, 2.0, False))
        diver.bridge.publish(OutputFailed(7.0, "stdout", "No space left on device"))
    assert diver.vehicle.texts[:3] == [
        "ready for gestures",
        "too slow for gestures: 2.0 frames a second",
        "stdout cannot be written",
    ]


def test_without_salutes_a_new_language_without_phrases_commands_nothing() -> None:
    table = VehicleTable.model_validate(TABLE)
    lines: queue.Queue[str] = queue.Queue()
    with sailing() as vehicle:
        link = open_link(f"udpout:127.0.0.1:{vehicle.port}", 1, 1)
        opened = MavlinkBridge(table, link, crew, lines.put, without_salutes=True)
        with talking(opened):
            opened.publish(build_language_changed(0.0, crew()))
            assert lines.get(timeout=WAIT).startswith("no commands without salutes: ")
            opened.publish(replace(a_take(), label="help", time=5.0, sha256=crew().sha256))
            assert lines.get(timeout=WAIT) == "'help' has no command"
    assert vehicle.asked == 0


def test_an_emergency_that_is_refused_is_told_once_and_sent_again() -> None:
    with diving(refused=frozenset({int(mavlink.MAV_CMD_DO_SET_MODE)})) as diver:
        diver.show("help")
        assert diver.wait_for("refused") == "refused (DENIED): surface"
        asked = diver.vehicle.asked
        while diver.vehicle.asked < asked + 3:
            diver.wait(0.01)
        diver.vehicle.refused = frozenset()
        assert diver.wait_for("refused", "done") == "done: surface"
    assert diver.vehicle.obeyed == ["SURFACE"]


def test_a_refusal_and_silence_are_told_and_not_taken_for_obedience() -> None:
    refused = frozenset({int(mavlink.MAV_CMD_DO_SET_SERVO)})
    quick = {"vehicle": {"repeat_seconds": 0.02, "give_up_seconds": 0.2}}
    with diving(changes=quick, refused=refused) as diver:
        diver.confirm("bright")
        assert diver.wait_for("refused") == "refused (DENIED): lights 50 %"
        diver.vehicle.loss = 1.0
        diver.confirm("stop")
        said = diver.wait_for("NOT DONE")
        assert said.startswith("NOT DONE, no answer: hold; DO_SET_MODE ALT_HOLD was sent ")
    assert diver.vehicle.obeyed == []


def test_a_vehicle_that_starts_again_or_falls_silent_is_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(peer, "SILENT_SECONDS", 0.2)
    with diving() as diver:
        diver.confirm("deep")
        assert diver.wait_for("done")
        diver.vehicle.restarts_at_next = True
        diver.confirm("up")
        assert diver.wait_for("vehicle has started again")
        assert diver.wait_for("done") == "done: surface"
        diver.vehicle.loss = 1.0
        assert diver.wait_for("vehicle is silent")
        diver.vehicle.loss = 0.0
        assert diver.wait_for("vehicle is back")


def test_what_is_asked_and_done_is_spoken_back_in_fifty_characters() -> None:
    with diving() as diver:
        diver.confirm("deep")
        diver.wait_for("done")
        diver.show("other")
    texts = diver.vehicle.texts
    assert "repeat 'deep' to confirm: depth 5 m" in texts
    assert texts.index("confirmed: depth 5 m") < texts.index("done: depth 5 m")
    assert all(len(text.encode()) <= TEXT_BYTES for text in texts)
    assert fit_text("é" * 30).decode() == "é" * 25


def test_what_is_told_last_is_spoken_before_the_bridge_is_closed() -> None:
    with diving() as diver:
        diver.confirm("deep")
        diver.wait_for("done")
        diver.show("deep")
    assert diver.vehicle.texts.count("repeat 'deep' to confirm: depth 5 m") == 2


@pytest.mark.parametrize("metres", [2, 50])
def test_a_message_is_obeyed_with_its_values_within_the_limits(metres: int) -> None:
    go = Phrase("go", (OneOf(("circle",)), Slot("metres", "number")), {}, "go to {metres}")
    grammar = Grammar((go,), (SlotType("number", "number", {"line": metres}),), timeout=5)
    made = replace(language_of("circle", "line"), grammar=grammar)
    language = ActiveLanguage.from_json(made.to_json())
    shown = recording_of("circle", "line", "circle", "line")
    events = run_listener(PhraseListener(TriggerListener(language)), shown)
    assert [each.phrase.kind for each in events if isinstance(each, PhraseHeard)].count(
        "complete"
    ) == 2
    go_to = {"phrases": {"go": {"do": "depth", "metres": {"slot": "metres"}}}}
    table = VehicleTable.model_validate(
        {key: TABLE[key] for key in ("format", "version", "vehicle")} | go_to
    )
    lines: list[str] = []
    with sailing() as vehicle:
        link = open_link(f"udpout:127.0.0.1:{vehicle.port}", 1, 1)
        with talking(MavlinkBridge(table, link, lambda: language, lines.append)) as opened:
            for event in (build_language_changed(0.0, language), *events):
                opened.publish(event)
    assert vehicle.obeyed == (["ALT_HOLD", "depth 2"] if metres == 2 else [])
    assert ("done: depth 2 m" if metres == 2 else "no depth: 50, of 0 to 30 m") in lines


@pytest.mark.parametrize("is_emergency", [False, True])
def test_the_cancel_of_the_phrases_drops_an_order_unless_it_is_an_emergency(
    is_emergency: bool,
) -> None:
    go = Phrase("go", (OneOf(("circle",)),), {}, "go")
    made = replace(language_of("circle", "line"), grammar=Grammar((go,), cancel="line"))
    language = ActiveLanguage.from_json(made.to_json())
    shown = recording_of("circle", "circle", "line")
    events = run_listener(PhraseListener(TriggerListener(language)), shown)
    table = {key: TABLE[key] for key in ("format", "version", "vehicle")}
    table |= {"phrases": {"go": {"do": "hold"}}}
    table |= {"emergency": {"line": "surface"}} if is_emergency else {}
    lines: list[str] = []
    with sailing() as vehicle:
        link = open_link(f"udpout:127.0.0.1:{vehicle.port}", 1, 1)
        parsed = VehicleTable.model_validate(table)
        with talking(MavlinkBridge(parsed, link, lambda: language, lines.append)) as opened:
            wait_until(lambda: opened._talk.peer.sender is not None)
            vehicle.loss = 1.0
            for event in (build_language_changed(0.0, language), *events):
                opened.publish(event)
            vehicle.loss = 0.0
    assert "confirmed: hold" in lines
    if is_emergency:
        assert [line for line in lines if "cancelled" in line] == []
        assert vehicle.obeyed == ["SURFACE"]
    else:
        assert [line for line in lines if line.startswith("cancelled: hold")]
        assert vehicle.obeyed == []
