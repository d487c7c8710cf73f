"""Viewing angles: from where a gesture will be misread is known before the dive."""

from dataclasses import replace

import pytest

from app.recognition import Gesture, Language, Recognizer, check_health
from app.recognition.health.viewing_angles import (
    ANGLES,
    AngleHealth,
    check_angles,
    find_blind_angles,
)
from app.recognition.simulation.rate_estimate import RateEstimate
from tests.recognition.strategies import SHAPES, in_space, recording

NAMES = ("circle", "line", "wedge")


def pool(*, depth: bool = True) -> Language:
    poses = {name: in_space(recording(SHAPES[name])) for name in NAMES}
    return Language(
        "pool",
        [
            Gesture.from_demonstration(name, each if depth else replace(each, world=None))
            for name, each in poses.items()
        ],
    )


def angle(degrees: int, rate: float, read_as: str | None = None) -> AngleHealth:
    return AngleHealth(degrees, RateEstimate(rate, rate, rate), read_as)


@pytest.fixture(scope="module")
def angles() -> dict[int, tuple[AngleHealth, ...]]:
    return check_angles(Recognizer(pool()))


def test_every_gesture_with_depth_has_a_rate_at_every_angle(
    angles: dict[int, tuple[AngleHealth, ...]],
) -> None:
    assert list(angles) == [0, 1, 2]
    for each in angles.values():
        assert tuple(at.degrees for at in each) == ANGLES


def test_a_line_across_is_lost_edge_on_and_not_at_thirty_degrees(
    angles: dict[int, tuple[AngleHealth, ...]],
) -> None:
    line = {at.degrees: at.missed.rate for at in angles[NAMES.index("line")]}
    assert max(line[-30], line[30]) < 0.5 < min(line[-90], line[90])


def test_without_depth_no_angle_is_known() -> None:
    assert check_angles(Recognizer(pool(depth=False))) == {}


def test_the_report_carries_the_angles_and_the_same_ones_each_time() -> None:
    once, again = (check_health(pool(), takes=2).to_dict() for _ in range(2))
    assert once == again
    assert [at["degrees"] for at in once["gestures"][0]["angles"]] == list(ANGLES)


@pytest.mark.parametrize(
    ("angles", "words"),
    [
        ([angle(30, 0.6)], "circle is mostly missed when the diver is turned by 30 degrees to the"),
        (
            [angle(-60, 0.8, "line"), angle(-30, 0.6, "line"), angle(60, 0.9, "wedge")],
            "circle is mostly missed, and read as line or wedge when the diver is turned by 60 "
            "degrees to the left and 30 or 60 degrees to the right",
        ),
        ([angle(-60, 0.8), angle(60, 0.9)], "turned by 60 degrees to either side"),
    ],
)
def test_angles_from_which_a_gesture_is_mostly_missed_are_named(
    angles: list[AngleHealth], words: str
) -> None:
    (finding,) = find_blind_angles("circle", angles)
    assert finding.code == "blind_angle"
    assert words in finding.message
    assert not finding.below_bar


def test_a_diver_seen_from_the_side_is_no_finding() -> None:
    assert find_blind_angles("circle", [angle(-90, 1.0), angle(90, 1.0), angle(30, 0.4)]) == []
