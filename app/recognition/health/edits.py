"""Gesture edits: changes of a gesture that may separate it from another one.

Each is applied to the demonstration, so that its effect can be computed before the gesture is shown
again.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from app.recognition.features.motion import SIDES, find_hands, parse_body_part
from app.recognition.gestures.gesture import Gesture
from app.recognition.poses.landmarks import other_side
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory

LARGER = 1.5
"""Factor of size: clearly larger, and within an arm's reach for gestures of less than a metre."""

SLOWER = 2.0
"""Factor of duration: the least whole number above the limit of the tempo voter (1.75)."""

Applied = Callable[[Gesture], Gesture | None]


@dataclass(frozen=True)
class GestureEdit:
    """A change of one gesture that its author can make.

    Attributes
    ----------
    kind
        Identifier for programs.
    label
        Of the gesture.
    text
        What to do, as an imperative.
    apply
        Returns the changed gesture; None where the edit does not apply.
    both
        Changes a switch of the other gesture as well, where both are needed.

    """

    kind: str
    label: str
    text: str
    apply: Applied
    both: Applied | None = None


def list_edits(gesture: Gesture, *, stroke: tuple[float, float] | None = None) -> list[GestureEdit]:
    """Return the edits to try with a gesture.

    Parameters
    ----------
    gesture
        With a demonstration.
    stroke
        Seconds in which it differs from the one it is confused with, if known.

    """
    label = gesture.label
    listed = [
        GestureEdit(
            "other_hand", label, f"show {label} with the other hand, as in a mirror", swap_hands
        ),
        GestureEdit("both_hands", label, f"show {label} with both hands, mirrored", use_both_hands),
        GestureEdit("wider", label, f"show {label} {LARGER:g} times as wide", widen),
        GestureEdit("taller", label, f"show {label} {LARGER:g} times as tall", heighten),
        GestureEdit(
            "slower",
            label,
            f"show {label} at half the speed, and let the tempo of both count",
            lambda each: set_switch(slow_down(each), tempo=True),
            both=lambda each: set_switch(each, tempo=True),
        ),
        GestureEdit(
            "reversed",
            label,
            f"show {label} from its end to its start, and let the direction of both count",
            lambda each: set_switch(reverse(each), direction=True),
            both=lambda each: set_switch(each, direction=True),
        ),
    ]
    if stroke is not None:
        start, end = stroke
        listed.append(
            GestureEdit(
                "longer_stroke",
                label,
                f"make what {label} does from {start:.1f} to {end:.1f} s {LARGER:g} times as large",
                lambda each: lengthen_stroke(each, start, end),
            )
        )
    return listed


def list_switch_edits(first: Gesture, second: Gesture) -> list[GestureEdit]:
    """Return the switches that may separate two gestures without changing their movements."""
    both = f"{first.label} and {second.label}"
    edits = [
        GestureEdit(
            "direction",
            first.label,
            f"let the direction of {both} count",
            lambda each: set_switch(each, direction=True),
            both=lambda each: set_switch(each, direction=True),
        ),
        GestureEdit(
            "tempo",
            first.label,
            f"let the tempo of {both} count",
            lambda each: set_switch(each, tempo=True),
            both=lambda each: set_switch(each, tempo=True),
        ),
    ]
    if all(map(let_hand_shape_count, (first, second))):
        edits.append(
            GestureEdit(
                "hand_shape",
                first.label,
                f"let the hand shape of {both} count",
                let_hand_shape_count,
                both=let_hand_shape_count,
            )
        )
    return edits


def let_hand_shape_count(gesture: Gesture) -> Gesture | None:
    """Return a gesture whose hand shape counts; None where no demonstration shows one."""
    if not any(each.moving_hands for each in gesture.trajectories):
        return None
    return replace(gesture, switches=replace(gesture.switches, hand_shape="on"))


def swap_hands(gesture: Gesture) -> Gesture | None:
    """Return the mirror image of a one-handed gesture; None for others."""
    one_hand = find_hands(gesture.salient) == 1
    if not one_hand or tuple(map(other_side, gesture.salient)) == gesture.salient:
        return None
    return gesture.mirror()


def use_both_hands(gesture: Gesture) -> Gesture | None:
    """Return a one-handed gesture shown with both arms, mirrored; None for others."""
    shown = gesture.trajectory
    others = tuple(other_side(name) for name in gesture.salient)
    if shown is None or swap_hands(gesture) is None or not set(others) <= set(shown.landmarks):
        return None
    side = next(side for side in SIDES if parse_body_part(others[0]).startswith(side))
    mirrored = shown.mirror()
    xy = shown.xy.copy()
    for index, name in enumerate(shown.landmarks):
        if parse_body_part(name).startswith(side) and name in mirrored.landmarks:
            xy[:, index] = mirrored.xy[:, mirrored.landmarks.index(name)]
    return replace(
        gesture, salient=(*gesture.salient, *others), trajectory=replace(shown, xy=xy)
    ).redraw()


def widen(gesture: Gesture) -> Gesture | None:
    """Return the gesture stretched horizontally."""
    return _change_demonstration(gesture, lambda shown: _stretch(shown, (LARGER, 1.0)))


def heighten(gesture: Gesture) -> Gesture | None:
    """Return the gesture stretched vertically."""
    return _change_demonstration(gesture, lambda shown: _stretch(shown, (1.0, LARGER)))


def slow_down(gesture: Gesture) -> Gesture | None:
    """Return the gesture with twice the duration."""
    return _change_demonstration(gesture, lambda shown: replace(shown, time=SLOWER * shown.time))


def reverse(gesture: Gesture) -> Gesture | None:
    """Return the gesture in the opposite direction, from its end to its start."""
    return _change_demonstration(
        gesture,
        lambda shown: replace(shown, xy=shown.xy[::-1], time=shown.time[-1] - shown.time[::-1]),
    )


def lengthen_stroke(gesture: Gesture, start: float, end: float) -> Gesture | None:
    """Return the gesture with the stroke between two moments enlarged, seconds."""

    def changed(shown: Trajectory) -> Trajectory:
        steps = np.diff(shown.xy, axis=0)
        middle = (shown.time[1:] + shown.time[:-1]) / 2
        inside = (middle >= start) & (middle <= end)
        more = np.where(inside[:, None, None], (LARGER - 1) * np.nan_to_num(steps), 0.0)
        added = np.concatenate([np.zeros_like(shown.xy[:1]), np.cumsum(more, axis=0)])
        return replace(shown, xy=shown.xy + added * _moving(shown))

    return _change_demonstration(gesture, changed)


def set_switch(
    gesture: Gesture | None, *, direction: bool = False, tempo: bool = False
) -> Gesture | None:
    """Return a gesture whose direction or tempo counts; None for None."""
    if gesture is None:
        return None
    switches = gesture.switches
    wanted = replace(
        switches,
        direction="on" if direction else switches.direction,
        tempo="on" if tempo else switches.tempo,
    )
    return replace(gesture, switches=wanted)


def _change_demonstration(
    gesture: Gesture, change: Callable[[Trajectory], Trajectory]
) -> Gesture | None:
    """Apply a change to the demonstration and redraw it; None without a demonstration."""
    if gesture.trajectory is None or not gesture.salient:
        return None
    return replace(gesture, trajectory=change(gesture.trajectory)).redraw()


def _stretch(shown: Trajectory, factors: tuple[float, float]) -> Trajectory:
    """Stretch the arms' landmarks about their mean positions; the trunk is unchanged."""
    with np.errstate(invalid="ignore"):
        seen = np.isfinite(shown.xy).any(axis=(0, 2))
    centre = np.zeros(shown.xy.shape[1:])
    centre[seen] = np.nanmean(shown.xy[:, seen], axis=0)
    added = (shown.xy - centre) * (np.array(factors) - 1.0)
    return replace(shown, xy=shown.xy + added * _moving(shown))


def _moving(shown: Trajectory) -> FloatArray:
    """Return ``(K, 1)``: 1 for landmarks that can move with an arm, 0 for those of the trunk."""
    still = ("shoulder", "hip")
    return np.array([[0.0 if name.endswith(still) else 1.0] for name in shown.landmarks])
