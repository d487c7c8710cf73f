"""Orders: which messages prove one done, and when it is given up; without a network."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

pytest.importorskip("pymavlink", reason="needs the extra mavlink")

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from app.robot.mavlink.actions import OUR_COMPONENT, VehicleFacts, build_steps
from app.robot.mavlink.orders import Order, OrderDesk, Outcome
from app.robot.mavlink.table import Action, Camera, Depth, Hold, Surface, Vehicle

VEHICLE = Vehicle(repeat_seconds=0.5, give_up_seconds=10)
HOLD, SURFACE = mavlink.SUB_MODE_ALT_HOLD, mavlink.SUB_MODE_SURFACE
SET_MODE = mavlink.MAV_CMD_DO_SET_MODE


def order(*actions: Action, emergency: bool = False) -> Order:
    steps = [step for action in actions for step in build_steps(action, VEHICLE, 1)]
    return Order("words", tuple(steps), emergency)


def from_vehicle(message: Any, system: int = 1, component: int = 1) -> Any:
    """Return a message with the head that its sender gives it."""
    message.pack(mavlink.MAVLink(None, system, component))
    return message


def heartbeat(mode: int, system: int = 1) -> Any:
    return from_vehicle(mavlink.MAVLink_heartbeat_message(12, 3, 129, mode, 4, 3), system)


def answer(
    command: int = SET_MODE,
    result: int = mavlink.MAV_RESULT_ACCEPTED,
    to: tuple[int, int] = (1, OUR_COMPONENT),
) -> Any:
    return from_vehicle(mavlink.MAVLink_command_ack_message(command, result, 0, 0, *to))


def begun(*actions: Action, emergency: bool = False) -> OrderDesk:
    """Return a desk whose order was sent once."""
    desk = OrderDesk(VEHICLE, VehicleFacts(VEHICLE))
    desk.give(order(*actions, emergency=emergency), 0.0)
    assert desk.list_due(0.0)[0].get_type() == "COMMAND_LONG"
    return desk


def kinds(desk: OrderDesk, *messages: Any) -> list[str]:
    outcomes = [desk.hear(message, 1.0) for message in messages]
    return [outcome.kind for outcome in outcomes if outcome is not None]


def test_a_mode_is_proven_by_answer_and_heartbeat_together() -> None:
    assert kinds(begun(Hold()), answer()) == []
    assert kinds(begun(Hold()), heartbeat(HOLD)) == []
    assert kinds(begun(Hold()), answer(), heartbeat(SURFACE)) == []
    assert kinds(begun(Hold()), answer(), heartbeat(HOLD)) == ["done"]
    assert kinds(begun(Hold()), heartbeat(HOLD), answer()) == ["done"]


def test_what_was_said_before_or_by_others_proves_nothing() -> None:
    desk = OrderDesk(VEHICLE, VehicleFacts(VEHICLE))
    assert kinds(desk, answer(), heartbeat(HOLD)) == []
    desk.give(order(Hold()), 0.0)
    assert kinds(desk, answer(), heartbeat(HOLD)) == []  # it was not sent yet
    desk.list_due(1.0)
    assert kinds(desk, heartbeat(HOLD)) == []
    desk = begun(Hold())
    ground_station = (255, 190)
    denied = mavlink.MAV_RESULT_DENIED
    assert kinds(desk, answer(to=ground_station), heartbeat(HOLD)) == []
    assert kinds(desk, answer(result=denied, to=ground_station)) == []
    assert kinds(desk, heartbeat(SURFACE), answer(), heartbeat(HOLD, system=2)) == []


def test_an_answer_of_an_older_vehicle_has_no_address() -> None:
    assert kinds(begun(Hold()), answer(to=(0, 0)), heartbeat(HOLD)) == ["done"]


NOISE = (
    lambda: answer(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL),
    lambda: answer(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, mavlink.MAV_RESULT_DENIED),
    lambda: answer(result=mavlink.MAV_RESULT_DENIED, to=(255, 190)),
    lambda: answer(result=mavlink.MAV_RESULT_TEMPORARILY_REJECTED),
    lambda: from_vehicle(mavlink.MAVLink_param_value_message(b"SERVO13_FUNCTION", 0, 2, 900, 7)),
)
ORDERS: list[tuple[tuple[Action, ...], bool]] = [
    ((Hold(),), False),
    ((Surface(),), True),
    ((Depth(do="depth", metres=5.0),), False),
    ((Hold(), Surface()), False),
]


@given(
    asked=st.sampled_from(ORDERS),
    to_vehicle=st.integers(0, 8),
    to_us=st.integers(0, 15),
    result=st.sampled_from([mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_IN_PROGRESS]),
    copies=st.integers(1, 3),
    phase=st.integers(0, 9),
    noise=st.lists(st.sampled_from(NOISE), min_size=1, max_size=7),
)
def test_what_the_vehicle_obeys_is_done_within_two_heartbeats(
    asked: tuple[tuple[Action, ...], bool],
    to_vehicle: int,
    to_us: int,
    result: int,
    copies: int,
    phase: int,
    noise: list[Callable[[], Any]],
) -> None:
    """Tenths of seconds; answers are late, doubled, for others, or IN_PROGRESS for ever."""
    desk = OrderDesk(VEHICLE, VehicleFacts(VEHICLE))
    mode, target, changed = mavlink.SUB_MODE_MANUAL, -1.0, 0
    requests: list[tuple[int, Any]] = []
    answers: list[tuple[int, Any]] = []
    told: list[tuple[int, str]] = []
    desk.hear(heartbeat(mode), 0.0)
    desk.give(order(*asked[0], emergency=asked[1]), 0.0)
    for tick in range(1, 150):
        for arrives, request in requests:
            if arrives != tick or request.get_type() == "AUTOPILOT_VERSION_REQUEST":
                continue
            before = (mode, target)
            if request.get_type() == "COMMAND_LONG":
                mode = int(request.param2)
                answers += [(tick + to_us, answer(result=result))] * copies
            elif mode == HOLD:
                target = request.alt
            changed = changed if (mode, target) == before else tick
        heard = [each for arrives, each in answers if arrives == tick]
        heard += [noise[tick % len(noise)]()]
        if tick % 10 == phase:
            heard += [heartbeat(mode), noise[tick % len(noise)]()]
            heard += [
                from_vehicle(mavlink.MAVLink_vfr_hud_message(0, 0, 0, 0, -1.0, 0)),
                from_vehicle(
                    mavlink.MAVLink_nav_controller_output_message(0, 0, 0, 0, 0, target + 1, 0, 0)
                ),
            ]
        outcomes = [desk.hear(each, tick / 10) for each in heard]
        outcomes.append(desk.check_deadline(tick / 10))
        told += [(tick, outcome.kind) for outcome in outcomes if outcome is not None]
        due = desk.list_due(tick / 10)
        assert not (due and told)
        requests += [(tick + 1 + to_vehicle, request) for request in due]
    assert [kind for _, kind in told] == ["done"]
    assert told[0][0] - changed <= to_us + 20


def test_a_refusal_takes_back_what_was_acknowledged() -> None:
    desk = begun(Surface(), emergency=True)
    refusal = answer(result=mavlink.MAV_RESULT_FAILED)
    assert kinds(desk, answer(), refusal, heartbeat(SURFACE)) == ["refused"]
    # It is asked again, though its first answer was an acceptance.
    assert [message.param2 for message in desk.list_due(1.0)] == [SURFACE]
    assert kinds(desk, answer()) == ["done"]


def test_a_camera_is_proven_by_its_own_answer_alone() -> None:
    desk = begun(Camera(do="camera"))
    assert kinds(desk, answer(), answer(mavlink.MAV_CMD_IMAGE_START_CAPTURE)) == ["done"]


def test_a_depth_is_proven_by_the_vehicles_target() -> None:
    desk = begun(Depth(do="depth", metres=5.0))
    assert kinds(desk, answer(), heartbeat(HOLD)) == []
    sent = desk.list_due(1.0)[0]
    assert (sent.get_type(), sent.alt) == ("SET_POSITION_TARGET_GLOBAL_INT", -5.0)
    shown = from_vehicle(mavlink.MAVLink_vfr_hud_message(0, 0, 0, 0, -2.0, 0))
    away = from_vehicle(mavlink.MAVLink_nav_controller_output_message(0, 0, 0, 0, 0, -1, 0, 0))
    there = from_vehicle(mavlink.MAVLink_nav_controller_output_message(0, 0, 0, 0, 0, -3, 0, 0))
    assert kinds(desk, shown, away) == []
    assert kinds(desk, there) == ["done"]


def test_it_is_repeated_until_it_is_given_up() -> None:
    desk = begun(Hold())
    assert desk.list_due(0.4) == ()
    # Nothing is repeated to a vehicle that says nothing: it would obey all of it later.
    assert desk.list_due(0.5) == ()
    # What was on its way before the vehicle could answer is no sign that the request was lost.
    desk.hear(heartbeat(0), 0.4)
    assert desk.list_due(0.5) == ()
    desk.hear(heartbeat(0), 0.5)
    assert [message.confirmation for message in desk.list_due(0.5)] == [1]
    assert desk.check_deadline(10.0) is None
    ended = desk.check_deadline(10.1)
    assert isinstance(ended, Outcome)
    assert (ended.kind, ended.sent) == ("unproven", "DO_SET_MODE ALT_HOLD was sent 2 times")
    assert desk.list_due(10.2) == ()


@pytest.mark.parametrize(
    ("result", "expected"),
    [
        (mavlink.MAV_RESULT_IN_PROGRESS, []),
        (mavlink.MAV_RESULT_TEMPORARILY_REJECTED, []),
        (mavlink.MAV_RESULT_FAILED, ["refused"]),
        (99, ["refused"]),
    ],
)
def test_what_is_no_refusal_is_waited_for(result: int, expected: list[str]) -> None:
    assert kinds(begun(Hold()), answer(result=result)) == expected


def test_a_vehicle_that_starts_again_is_told_from_the_beginning() -> None:
    desk = begun(Hold(), Camera(do="camera"))
    up = from_vehicle(mavlink.MAVLink_system_time_message(0, 60_000))
    assert kinds(desk, up, answer(), heartbeat(HOLD)) == []
    assert desk.list_due(1.0)[0].command == mavlink.MAV_CMD_IMAGE_START_CAPTURE
    late = from_vehicle(mavlink.MAVLink_system_time_message(0, 59_500))
    again = from_vehicle(mavlink.MAVLink_system_time_message(0, 200))
    assert kinds(desk, late) == []
    assert desk.reboots == 0
    assert kinds(desk, again) == []
    assert desk.reboots == 1
    assert desk.list_due(1.0)[0].command == SET_MODE


def test_a_newer_order_replaces_the_one_on_its_way() -> None:
    desk = begun(Hold())
    replaced = desk.give(order(Surface(), emergency=True), 1.0)
    assert replaced is not None
    assert replaced.kind == "replaced"
    assert desk.list_due(1.0)[0].param2 == SURFACE
    # An emergency counts heard seconds: a lost link uses up none.
    desk.hear(heartbeat(0), 1.0)
    assert desk.check_deadline(601.0) is None
    for second in range(602, 659):
        desk.hear(heartbeat(0), second)
        assert desk.check_deadline(second) is None
    desk.hear(heartbeat(0), 661)
    assert desk.check_deadline(661) is not None


@pytest.mark.parametrize("is_cancelled", [False, True])
def test_a_mode_that_comes_late_from_an_order_before_is_no_pilots(is_cancelled: bool) -> None:
    desk = OrderDesk(VEHICLE, VehicleFacts(VEHICLE))
    desk.hear(heartbeat(mavlink.SUB_MODE_MANUAL), 0.0)
    desk.give(order(Hold()), 0.0)
    desk.list_due(0.0)
    if is_cancelled:
        desk.cancel()
    desk.give(order(Surface(), emergency=True), 0.2)
    desk.list_due(0.2)  # it is lost
    heard = [
        (0.3, heartbeat(mavlink.SUB_MODE_MANUAL)),
        (0.4, answer()),  # to the order before
        (1.3, heartbeat(HOLD)),
        (1.4, from_vehicle(mavlink.MAVLink_system_time_message(0, 60_000))),
        (2.3, heartbeat(HOLD)),
    ]
    assert [desk.hear(message, now) for now, message in heard] == [None] * len(heard)
    assert [message.param2 for message in desk.list_due(2.4)] == [SURFACE]
    assert desk.hear(answer(), 2.5) is None
    ended = desk.hear(heartbeat(SURFACE), 3.3)
    assert ended is not None
    assert ended.kind == "done"


def test_of_a_mode_that_is_accepted_and_never_shown_it_is_said_what_is_shown() -> None:
    desk = begun(Hold(), emergency=True)
    ended = None
    for tick in range(100):
        now = tick / 10
        if desk.list_due(now):
            assert desk.hear(answer(), now) is None
        if tick % 10 == 0 and (ended := desk.hear(heartbeat(mavlink.SUB_MODE_MANUAL), now)):
            break
    assert ended is not None
    assert (ended.kind, ended.reason) == ("stopped", "stays in MANUAL")


def test_of_a_cancelled_order_it_is_said_whether_the_vehicle_may_have_got_it() -> None:
    desk = OrderDesk(VEHICLE, VehicleFacts(VEHICLE))
    desk.give(order(Hold()), 0.0)
    assert desk.cancel() == Outcome(order(Hold()), "cancelled")
    sent = "DO_SET_MODE ALT_HOLD was sent once"
    assert begun(Hold()).cancel() == Outcome(order(Hold()), "cancelled", sent=sent)
    stopped = begun(Hold()).stop("robot is stopped")
    assert stopped == Outcome(order(Hold()), "stopped", "robot is stopped", sent)


def test_an_emergency_is_repeated_for_five_seconds_though_nothing_is_heard() -> None:
    desk = begun(Surface(), emergency=True)
    sent = [second for tick in range(1, 1200) if desk.list_due(second := tick / 2)]
    assert sent == [tick / 2 for tick in range(1, 11)]
    desk.hear(heartbeat(mavlink.SUB_MODE_MANUAL), 600.0)
    assert len(desk.list_due(600.0)) == 1


VERSIONS = [(4, 0, 3), (4, 1, 2), (4, 5, 3), (4, 6, 0)]


@pytest.mark.parametrize("version", [None, *VERSIONS])
def test_a_depth_is_sent_as_the_vehicles_version_takes_it(
    version: tuple[int, int, int] | None,
) -> None:
    facts = VehicleFacts(VEHICLE)
    assert "AUTOPILOT_VERSION_REQUEST" in [each.get_type() for each in facts.list_due(0.0)]
    desk = OrderDesk(VEHICLE, facts)
    desk.give(order(Depth(do="depth", metres=5.0)), 0.0)
    desk.list_due(0.0)
    if version is not None:
        facts.hear(told_version(version))
    assert [*facts.list_due(0.1)] == []
    left = [each.get_type() for each in facts.list_due(1.0)]
    assert ("AUTOPILOT_VERSION_REQUEST" in left) == (version is None)
    assert kinds(desk, answer(), heartbeat(HOLD)) == []
    (sent,) = desk.list_due(1.0)
    ignored = sent.type_mask & 7
    assert ignored == (0 if version in ((4, 0, 3), (4, 1, 2)) else 3)
    # In any mode but ALT_HOLD the vehicle drops a target at a latitude that there is not.
    assert sent.lat_int > 90e7


def told_version(version: tuple[int, int, int]) -> Any:
    major, minor, patch = version
    number = major << 24 | minor << 16 | patch << 8
    rest = (number, 0, 0, 0, [0] * 8, [0] * 8, [0] * 8, 0, 0, 0)
    return from_vehicle(mavlink.MAVLink_autopilot_version_message(0, *rest))


def emergency() -> OrderDesk:
    """Return a desk whose emergency is to surface, else to hold, and was sent once."""
    desk = OrderDesk(VEHICLE, VehicleFacts(VEHICLE))
    up, stay = (
        Order(action.words, build_steps(action, VEHICLE, 1), emergency=True)
        for action in (Surface(), Hold())
    )
    desk.hear(heartbeat(mavlink.SUB_MODE_MANUAL), 0.0)
    desk.give(replace(up, others=(stay,)), 0.0)
    assert asked(desk, 0.0) == [SURFACE]
    return desk


def asked(desk: OrderDesk, now: float) -> list[int]:
    return [int(message.param2) for message in desk.list_due(now)]


def test_what_comes_next_in_an_emergency_is_tried_as_soon_as_one_is_refused() -> None:
    desk = emergency()
    refusal = answer(result=mavlink.MAV_RESULT_FAILED)
    told = desk.hear(refusal, 0.1)
    assert told is not None
    assert (told.kind, told.reason) == ("waits", "refused (FAILED), now hold")
    assert asked(desk, 0.1) == [HOLD]
    assert kinds(desk, answer(), heartbeat(HOLD)) == ["done"]


def test_an_emergency_of_which_all_is_refused_is_told_once_and_tried_in_turn() -> None:
    desk = emergency()
    refusal = answer(result=mavlink.MAV_RESULT_FAILED)
    tried, told = [], []
    for tick in range(1, 40):
        now = tick / 10
        desk.hear(heartbeat(mavlink.SUB_MODE_MANUAL), now)
        told += [outcome.kind for outcome in [desk.hear(refusal, now)] if outcome is not None]
        tried += asked(desk, now)
    assert told == ["waits", "refused"]
    assert tried[:4] == [HOLD, SURFACE, HOLD, SURFACE]
    # No faster than a command is repeated, but for the first of each.
    assert len(tried) <= 2 + 40 / 5


@pytest.mark.parametrize("result", [None, mavlink.MAV_RESULT_IN_PROGRESS, 0])
def test_what_stays_without_effect_in_an_emergency_is_followed_by_the_next(
    result: int | None,
) -> None:
    """The vehicle obeys `hold` alone; to `surface` it says nothing, or has it, and does nothing."""
    desk = emergency()
    mode, told, tried = mavlink.SUB_MODE_MANUAL, [], [SURFACE]
    for tick in range(1, 300):
        now = tick / 10
        heard = [heartbeat(mode)] if tick % 10 == 0 else []
        if result is not None and tried[-1] == SURFACE:
            heard.append(answer(result=result))
        elif tried[-1] == HOLD:
            mode = HOLD
            heard.append(answer())
        told += kinds_at(desk, now, *heard)
        tried += asked(desk, now)
    assert told == ["waits", "done"]
    assert tried.index(HOLD) <= 22  # ten heard seconds, and a heartbeat


def kinds_at(desk: OrderDesk, now: float, *messages: Any) -> list[str]:
    outcomes = [desk.hear(message, now) for message in messages]
    return [outcome.kind for outcome in outcomes if outcome is not None]


def test_a_pilot_who_changes_the_mode_ends_an_emergency_with_all_that_was_to_be_tried() -> None:
    desk = emergency()
    up = from_vehicle(mavlink.MAVLink_system_time_message(0, 60_000))
    others = [heartbeat(mavlink.SUB_MODE_STABILIZE)] * 2
    assert kinds_at(desk, 1.0, heartbeat(mavlink.SUB_MODE_MANUAL), *others, up, up) == ["stopped"]
    assert asked(desk, 5.0) == []


def test_what_an_emergency_has_reached_is_not_changed_though_its_answer_is_lost() -> None:
    desk = emergency()
    for second in range(1, 30):
        assert kinds_at(desk, second, heartbeat(SURFACE)) == []
        assert asked(desk, second) == [SURFACE]
