"""Rules that would give commands at the wrong moment are refused."""

from __future__ import annotations

import math

import pytest

from app.robot.commands.rules import Rules


@pytest.mark.parametrize(
    ("wrong", "error"),
    [
        ({"confirm_seconds": 0.0}, "confirm_seconds is 0.0"),
        ({"stale_seconds": math.nan}, "stale_seconds is nan"),
        ({"stale_seconds": True}, "stale_seconds is True"),
        ({"emergency_seconds": "10"}, "emergency_seconds is '10'"),
        ({"confirm_seconds": math.inf}, "confirm_seconds is inf"),
        ({"least_confidence": "0.5"}, "least_confidence is '0.5'"),
        ({"least_confidence": 1.5}, "least_confidence is 1.5"),
        ({"emergency_seconds": 0.0}, "emergency_seconds is 0.0"),
        ({"emergency_confidence": math.nan}, "emergency_confidence is nan"),
        ({"cancel": frozenset({"line"}), "emergency": frozenset({"line"})}, "'line'"),
    ],
)
def test_rules_that_contradict_themselves_are_refused(wrong: dict[str, object], error: str) -> None:
    with pytest.raises(ValueError, match=error):
        Rules(**wrong)  # type: ignore[arg-type]
