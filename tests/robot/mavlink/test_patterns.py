"""Answers to the diver: blinks and nods of a vehicle, counted as a diver sees them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from itertools import pairwise
from typing import Any

import pytest

pytest.importorskip("pymavlink", reason="needs the extra mavlink")

from pydantic import ValidationError
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from app.recognition.recording.segmentation import TakeState
from app.robot import RecognitionReady, SourceEnded, StateChanged
from app.robot.commands.replies import Reply
from app.robot.mavlink import patterns
from app.robot.mavlink.table import VehicleTable
from tests.robot.mavlink.diver import TABLE, Diver, diving

LIGHTS = {"answers": {"show": ["lights"]}}
LOW, BRIGHT = 1100, 1660


@contextmanager
def answering(changes: Mapping[str, object] = LIGHTS, **settings: Any) -> Iterator[Diver]:
    """Put a diver into the water whose vehicle answers, and reports its lights already."""
    with diving(changes=changes, **settings) as diver:
        diver.wait_until(lambda: bool(diver.vehicle.reports))
        if diver.vehicle.function is not None:
            diver.wait_until(lambda: diver.bridge._facts.function == diver.vehicle.function)
        diver.wait(0.05)
        yield diver


def wait_for_pattern(diver: Diver, pulses: int) -> None:
    """Wait until a pattern is over and what was before is restored."""
    diver.wait_until(lambda: len(diver.vehicle.shown) >= 2 * pulses)
    diver.wait_until(lambda: diver.bridge.has_replied)


SHOWINGS = {
    Reply.listening: lambda diver: diver.bridge.publish(RecognitionReady(1.0)),
    Reply.repeat: lambda diver: diver.show("stop"),
    Reply.one_of_two: lambda diver: diver.show(None, pair=("stop", "up")),
    Reply.done: lambda diver: diver.show("help"),
    Reply.refused: lambda diver: diver.show(None),
}


@pytest.mark.parametrize("answer", Reply, ids=lambda answer: answer.value)
def test_each_answer_is_shown_once_within_half_a_second(answer: Reply) -> None:
    with answering() as diver:
        began = diver.vehicle._now()
        SHOWINGS[answer](diver)
        wait_for_pattern(diver, answer.pulses)
        diver.wait(0.5)
        levels = [value for _, _, value in diver.vehicle.shown]
        assert levels == [BRIGHT, LOW] * answer.pulses
        times = [moment for moment, _, _ in diver.vehicle.shown]
        assert times[0] - began < 0.5
        # Fewer than three flashes a second, each of three frames at 15 frames a second.
        assert min(b - a for a, b in pairwise(times[::2])) > 1 / 3 if len(times) > 2 else True
        assert min(b - a for a, b in pairwise(times)) > 3 / 15


def test_lights_that_are_on_blink_off_and_keep_their_brightness() -> None:
    with answering(lights=1700.0) as diver:
        diver.show(None)
        wait_for_pattern(diver, Reply.refused.pulses)
    assert [value for _, _, value in diver.vehicle.shown] == [LOW, 1700] * Reply.refused.pulses


def test_lights_with_a_limit_of_their_own_blink_and_are_restored() -> None:
    with answering(brightest=1500.0) as diver:
        diver.show("stop")
        wait_for_pattern(diver, Reply.repeat.pulses)
        assert diver.vehicle.pulse == LOW
    assert [value for _, _, value in diver.vehicle.shown] == [1500, LOW] * Reply.repeat.pulses


def test_a_camera_nods_and_looks_where_it_looked_before() -> None:
    with answering({"answers": {"show": ["tilt"]}}, yaw=-25.0) as diver:
        diver.show("stop")
        wait_for_pattern(diver, Reply.repeat.pulses)
    shown = [round(value) for _, _, value in diver.vehicle.shown]
    assert shown == [-12, 0] * Reply.repeat.pulses
    assert diver.vehicle.yaw == pytest.approx(-25, abs=0.01)


def test_the_pilot_keeps_the_lights_that_he_changes_during_a_pattern() -> None:
    with answering() as diver:
        diver.show(None)
        diver.wait_until(lambda: len(diver.vehicle.shown) == 3)
        diver.vehicle.turn_lights(1300)
        diver.wait(1.0)
        assert diver.vehicle.pulse == 1300
        assert len(diver.vehicle.shown) == 4
        diver.show(None)
        diver.wait(0.5)
        assert diver.vehicle.pulse == 1300


def test_nothing_is_shown_after_the_pilot_has_changed_the_lights(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(patterns, "LATEST_SECONDS", 0.3)
    with answering() as diver:
        diver.vehicle.turn_lights(1300)
        diver.wait(0.1)
        diver.show("stop")
        said = diver.wait_for(patterns.NOT_SHOWN)
        assert said == "not shown to the diver, pilot has changed lights: repeat"
    assert len(diver.vehicle.shown) == 1


def test_a_pattern_ends_when_a_take_begins_and_none_begins_in_a_take() -> None:
    with answering() as diver:
        diver.show(None)
        diver.wait_until(lambda: len(diver.vehicle.shown) == 3)
        diver.bridge.publish(StateChanged(diver.time, TakeState.recording))
        diver.wait_until(lambda: diver.bridge.has_replied)
        assert [value for _, _, value in diver.vehicle.shown] == [BRIGHT, LOW, BRIGHT, LOW]
        diver.bridge.publish(RecognitionReady(diver.time))
        diver.wait(0.4)
        assert len(diver.vehicle.shown) == 4
        diver.bridge.publish(StateChanged(diver.time, TakeState.done))
        diver.wait_until(lambda: len(diver.vehicle.shown) > 4)


def test_an_emergency_is_answered_first() -> None:
    with answering() as diver:
        diver.show(None)
        diver.wait_until(lambda: len(diver.vehicle.shown) == 1)
        diver.show("help")
        diver.show("other")
        diver.wait_until(lambda: diver.bridge.has_replied)
    levels = [value for _, _, value in diver.vehicle.shown]
    assert levels == [BRIGHT, LOW] * (len(levels) // 2)
    assert len(levels) in (2 + 2 * Reply.done.pulses, 4 + 2 * Reply.done.pulses)


@pytest.mark.parametrize("stopped", [True, False])
def test_the_lights_are_as_before_when_the_robot_ends(stopped: bool) -> None:
    with answering() as diver:
        diver.show(None)
        diver.wait_until(lambda: len(diver.vehicle.shown) == 3)
        diver.bridge.publish(SourceEnded(diver.time, 100, 0, stopped))
    assert diver.vehicle.pulse == LOW
    assert len(diver.vehicle.shown) == 4


def test_the_lights_are_as_before_after_a_lost_link(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(patterns, "FRESH_SECONDS", 0.2)
    with answering() as diver:
        diver.show(None)
        diver.wait_until(lambda: len(diver.vehicle.shown) == 3)
        diver.vehicle.loss = 1.0
        diver.wait(0.6)
        assert diver.vehicle.pulse == BRIGHT
        diver.vehicle.loss = 0.0
        diver.wait_until(lambda: diver.bridge.has_replied)
        assert diver.vehicle.pulse == LOW
        assert len(diver.vehicle.shown) == 4


def test_an_order_for_the_lights_is_proven_by_its_own_answer_alone() -> None:
    with answering() as diver:
        diver.show("bright")
        diver.wait_until(lambda: len(diver.vehicle.shown) == 1)
        diver.show("bright")
        assert diver.wait_for("done", "NOT DONE") == "done: lights 50 %"
        assert diver.vehicle.pulse == 1500
        shown = len(diver.vehicle.shown)
        wait_for_pattern(diver, shown // 2 + Reply.done.pulses)
        assert diver.vehicle.pulse == 1500
        assert len(diver.vehicle.shown) == shown + 2 * Reply.done.pulses


def test_a_fifth_of_all_messages_lost_leaves_the_count_and_the_lights() -> None:
    with answering(loss=0.2, seed=3) as diver:
        for _ in range(3):
            diver.vehicle.shown.clear()
            diver.show("stop")
            wait_for_pattern(diver, Reply.repeat.pulses)
            assert diver.vehicle.pulse == LOW
            assert len(diver.vehicle.shown) == 2 * Reply.repeat.pulses
            diver.show("no")
            wait_for_pattern(diver, Reply.repeat.pulses + Reply.done.pulses)


def test_lights_that_the_vehicle_refuses_to_set_are_told_once() -> None:
    refused = frozenset({int(mavlink.MAV_CMD_DO_SET_SERVO)})
    with answering(refused=refused) as diver:
        diver.show("stop")
        diver.wait_until(lambda: diver.bridge.has_replied)
    assert diver.vehicle.shown == []


def test_a_table_without_answers_asks_the_vehicle_for_nothing() -> None:
    with diving() as diver:
        diver.wait_until(lambda: diver.bridge._talk.peer.sender is not None)
        diver.show(None)
        diver.wait(0.3)
    assert diver.vehicle.asked == 0
    assert diver.vehicle.shown == []


@pytest.mark.parametrize(
    ("answers", "reason"),
    [
        ({"show": []}, "at least 1"),
        ({"show": ["bell"]}, "'lights' or 'tilt'"),
        ({"show": ["lights", "lights"]}, "twice"),
        ({"show": ["lights"], "done": 2}, "two answers have 2 pulses"),
    ],
)
def test_answers_that_a_diver_could_not_tell_apart_are_refused(
    answers: dict[str, object], reason: str
) -> None:
    with pytest.raises(ValidationError, match=reason):
        VehicleTable.model_validate({**TABLE, "answers": answers})
