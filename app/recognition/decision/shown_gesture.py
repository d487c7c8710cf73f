"""Shown gestures: a demonstration in its traversals, described for all motion voters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.recognition.features.motion import (
    SHARES,
    SIZE,
    Movement,
    build_movement,
    find_hands,
    uses_both_sides,
)
from app.recognition.features.traversals import Traversal, list_traversals
from app.recognition.gestures.gesture import Gesture
from app.recognition.gestures.switches import Switch
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.voters.registry import MOTION_VOTERS


@dataclass(frozen=True, eq=False)
class DescribedGesture:
    """The traversals of one gesture, and their descriptors by voter's name."""

    traversals: tuple[Traversal, ...]
    descriptors: dict[str, FloatArray]


@dataclass(frozen=True)
class ShownGesture:
    """The parts of a gesture that its traversals depend on.

    Attributes
    ----------
    trajectory, salient
        The gesture's.
    direction, mirror
        Its switches.

    """

    trajectory: Trajectory | None
    salient: tuple[str, ...]
    direction: Switch
    mirror: Switch

    @classmethod
    def of(cls, gesture: Gesture) -> ShownGesture:
        """Return the shown gesture of a gesture."""
        switches = gesture.switches
        return cls(gesture.trajectory, gesture.salient, switches.direction, switches.mirror)

    def describe(self, landmarks: tuple[str, ...], *, every: bool) -> DescribedGesture:
        """Describe all traversals of the demonstration if `every`, else the demonstrated one only.

        Cached for each set of landmarks that a language uses.
        """
        trajectory = self.trajectory
        assert trajectory is not None
        both_ways, either_way = self.direction != "on", self.direction == "off"
        either_side = self.mirror == "auto" and uses_both_sides(self.salient)
        hands = find_hands(self.salient)

        def compute() -> DescribedGesture:
            shown = build_movement(trajectory, landmarks)
            found = list_traversals(
                shown,
                hands=hands,
                both_ways=both_ways,
                either_way=either_way,
                either_side=either_side,
            )
            found = found if every else found[:1]
            return DescribedGesture(found, describe_traversals(shown, found, landmarks))

        return trajectory.compute_once(
            ("traversals", landmarks, hands, both_ways, either_way, either_side, every), compute
        )


def describe_traversals(
    shown: Movement, traversals: Sequence[Traversal], landmarks: Sequence[str]
) -> dict[str, FloatArray]:
    """Return the descriptors of R traversals of a movement, ``(R, ...)`` by voter's name."""
    movements = [each.of(shown, landmarks) for each in traversals]
    described = {
        voter.name: np.array([voter.describe(each) for each in movements])
        for voter in MOTION_VOTERS
    }
    return described | {
        SHARES: np.array([each.shares for each in movements]),
        SIZE: np.array([each.size for each in movements]),
    }
