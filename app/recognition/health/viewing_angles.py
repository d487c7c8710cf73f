"""Viewing angles: from where a gesture will be misread, by simulated takes of a turned diver."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from app.recognition.health.finding import Finding
from app.recognition.health.simulated_trials import SimulatedTrials, simulate_trials
from app.recognition.recognizer import Recognizer
from app.recognition.simulation.rate_estimate import RateEstimate
from app.recognition.simulation.variation import Person

ANGLES: Final = (-90, -60, -30, 30, 60, 90)
"""Degrees by which the diver is turned from the demonstration, positive to the diver's own left.
Straight ahead is what the other trials simulate."""

TAKES: Final = 4
"""Simulated takes of each gesture at each angle: at six angles, half as many again as in the other
trials."""

MOST_MISSED = 0.5
"""Estimated rate of misses from which an angle is named: every second command."""

FORESEEABLE = 60
"""Largest turn in degrees that a finding reports: beyond it, the far arm is hidden in any
language."""


@dataclass(frozen=True)
class AngleHealth:
    """Estimated rate of one gesture when its diver is turned.

    Attributes
    ----------
    degrees
        Turn from the demonstration, positive to the diver's own left.
    missed
        Rate of takes that are confused or rejected.
    read_as
        The other gesture that most of the simulated takes are nearer to; None where they are
        nearest to their own.

    """

    degrees: int
    missed: RateEstimate
    read_as: str | None

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON types."""
        return {"degrees": self.degrees, "missed": self.missed.to_dict(), "read_as": self.read_as}


def check_angles(
    recognizer: Recognizer,
    *,
    seed: int = 0,
    person: Person = "another",
    advance: Callable[[], None] = lambda: None,
) -> dict[int, tuple[AngleHealth, ...]]:
    """Estimate how often gestures are missed when the diver is turned.

    Parameters
    ----------
    recognizer
        Of the language, profile ``full``.
    seed, person, advance
        As for `simulate_trials`.

    Returns
    -------
    By the index of each movement whose demonstration has depth, its angles in the order of
    `ANGLES`; the others cannot be turned.

    """
    gestures = [
        index
        for index, gesture in enumerate(recognizer.language.gestures)
        if gesture.trajectory is not None
        and gesture.trajectory.facing is not None
        and not gesture.is_held
    ]
    trials = [
        simulate_trials(
            recognizer,
            TAKES,
            gestures=gestures,
            seed=seed,
            person=person,
            advance=advance,
            turned=degrees,
        )
        for degrees in (ANGLES if gestures else ())
    ]
    labels = recognizer.language.labels
    return {
        gesture: tuple(
            AngleHealth(degrees, each.missed(row), _read_as(each, row, labels))
            for degrees, each in zip(ANGLES, trials, strict=True)
        )
        for row, gesture in enumerate(gestures)
    }


def _read_as(trials: SimulatedTrials, row: int, labels: Sequence[str]) -> str | None:
    """Return the other gesture that most takes are nearest to; None for their own or for none."""
    nearest = trials.rivals[row][trials.scores[row].argmin(axis=1)]
    values, counts = np.unique(nearest, return_counts=True)
    most = int(values[counts.argmax()])
    own = int(trials.gestures[row])
    return None if most == own or 2 * counts.max() <= TAKES else labels[most]


def find_blind_angles(label: str, angles: Sequence[AngleHealth]) -> list[Finding]:
    """Return a finding that names the angles from which a gesture is mostly missed."""
    blind = [
        each
        for each in angles
        if abs(each.degrees) <= FORESEEABLE and each.missed.rate > MOST_MISSED
    ]
    if not blind:
        return []
    read = sorted({each.read_as for each in blind if each.read_as is not None})
    instead = f", and read as {' or '.join(read)}" if read else ""
    message = (
        f"{label} is mostly missed{instead} when the diver is turned by "
        f"{_list_turns([each.degrees for each in blind])}: face the camera, or add a "
        "demonstration from there"
    )
    return [Finding("blind_angle", (label,), message)]


def _list_turns(turns: Sequence[int]) -> str:
    """Return turns in words, such as ``30 or 60 degrees to the left``."""
    sides = {
        side: sorted(abs(turn) for turn in turns if (turn > 0) == (side == "left"))
        for side in ("left", "right")
    }
    if sides["left"] == sides["right"]:
        return f"{' or '.join(map(str, sides['left']))} degrees to either side"
    return " and ".join(
        f"{' or '.join(map(str, degrees))} degrees to the {side}"
        for side, degrees in sides.items()
        if degrees
    )
