"""Alterations that may set a gesture apart from another one: shown otherwise, or read otherwise.

Each is applied to the demonstration itself, as a person would show it anew, so that its effect can
be computed before anybody does.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from app.recognition.features.motion import SIDES, hands_in, part_of
from app.recognition.gestures.gesture import Gesture
from app.recognition.poses.landmarks import other_side
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory

LARGER = 1.5
"""Factor of size: half as large again is seen at once, and within an arm's reach for any gesture
that spans less than a metre."""

SLOWER = 2.0
"""Factor of duration: the least whole number that the tempo voter tells apart for sure (1.75)."""

Applied = Callable[[Gesture], Gesture | None]


@dataclass(frozen=True)
class Alteration:
    """What a person may do about one gesture.

    Attributes
    ----------
    kind
        One word or two, for programs.
    label
        Of the gesture.
    text
        What to do, as an imperative.
    apply
        Makes the changed gesture; None where the change does not apply.
    both
        Makes a switch of the other gesture count as well, where it takes two.

    """

    kind: str
    label: str
    text: str
    apply: Applied
    both: Applied | None = None


def alterations_of(
    gesture: Gesture, *, stroke: tuple[float, float] | None = None
) -> list[Alteration]:
    """List what may be tried with a gesture.

    Parameters
    ----------
    gesture
        With a demonstration.
    stroke
        Seconds in which it differs from the one it is confused with, where that is known.

    """
    label = gesture.label
    listed = [
        Alteration(
            "other_hand", label, f"show {label} with the other hand, as in a mirror", other_hand
        ),
        Alteration("both_hands", label, f"show {label} with both hands, mirrored", both_hands),
        Alteration("wider", label, f"show {label} {LARGER:g} times as wide", wider),
        Alteration("taller", label, f"show {label} {LARGER:g} times as tall", taller),
        Alteration(
            "slower",
            label,
            f"show {label} at half the speed, and let the tempo of both count",
            lambda each: with_switch(slower(each), tempo=True),
            both=lambda each: with_switch(each, tempo=True),
        ),
        Alteration(
            "reversed",
            label,
            f"show {label} from its end to its start, and let the direction of both count",
            lambda each: with_switch(backwards(each), direction=True),
            both=lambda each: with_switch(each, direction=True),
        ),
    ]
    if stroke is not None:
        start, end = stroke
        listed.append(
            Alteration(
                "longer_stroke",
                label,
                f"make what {label} does from {start:.1f} to {end:.1f} s {LARGER:g} times as large",
                lambda each: longer_stroke(each, start, end),
            )
        )
    return listed


def switch_alterations(first: Gesture, second: Gesture) -> list[Alteration]:
    """List the switches that may set two gestures apart as they are."""
    both = f"{first.label} and {second.label}"
    return [
        Alteration(
            "direction",
            first.label,
            f"let the direction of {both} count",
            lambda each: with_switch(each, direction=True),
            both=lambda each: with_switch(each, direction=True),
        ),
        Alteration(
            "tempo",
            first.label,
            f"let the tempo of {both} count",
            lambda each: with_switch(each, tempo=True),
            both=lambda each: with_switch(each, tempo=True),
        ),
    ]


def other_hand(gesture: Gesture) -> Gesture | None:
    """Mirror a gesture of one hand; None for one that uses both, or none."""
    one_hand = hands_in(gesture.salient) == 1
    if not one_hand or tuple(map(other_side, gesture.salient)) == gesture.salient:
        return None
    return gesture.mirrored()


def both_hands(gesture: Gesture) -> Gesture | None:
    """Let the idle arm do the mirror image of the other one at the same time."""
    shown = gesture.trajectory
    others = tuple(other_side(name) for name in gesture.salient)
    if shown is None or other_hand(gesture) is None or not set(others) <= set(shown.landmarks):
        return None
    side = next(side for side in SIDES if part_of(others[0]).startswith(side))
    mirrored = shown.mirrored()
    xy = shown.xy.copy()
    for index, name in enumerate(shown.landmarks):
        if part_of(name).startswith(side) and name in mirrored.landmarks:
            xy[:, index] = mirrored.xy[:, mirrored.landmarks.index(name)]
    return replace(
        gesture, salient=(*gesture.salient, *others), trajectory=replace(shown, xy=xy)
    ).redrawn()


def wider(gesture: Gesture) -> Gesture | None:
    """Stretch what moves horizontally."""
    return _reshown(gesture, lambda shown: _stretched(shown, (LARGER, 1.0)))


def taller(gesture: Gesture) -> Gesture | None:
    """Stretch what moves vertically."""
    return _reshown(gesture, lambda shown: _stretched(shown, (1.0, LARGER)))


def slower(gesture: Gesture) -> Gesture | None:
    """Let it take twice as long."""
    return _reshown(gesture, lambda shown: replace(shown, time=SLOWER * shown.time))


def backwards(gesture: Gesture) -> Gesture | None:
    """Show it from its end to its start."""
    return _reshown(
        gesture,
        lambda shown: replace(shown, xy=shown.xy[::-1], time=shown.time[-1] - shown.time[::-1]),
    )


def longer_stroke(gesture: Gesture, start: float, end: float) -> Gesture | None:
    """Enlarge what happens between two moments, in seconds of the demonstration."""

    def changed(shown: Trajectory) -> Trajectory:
        steps = np.diff(shown.xy, axis=0)
        middle = (shown.time[1:] + shown.time[:-1]) / 2
        inside = (middle >= start) & (middle <= end)
        more = np.where(inside[:, None, None], (LARGER - 1) * np.nan_to_num(steps), 0.0)
        added = np.concatenate([np.zeros_like(shown.xy[:1]), np.cumsum(more, axis=0)])
        return replace(shown, xy=shown.xy + added * _moving(shown))

    return _reshown(gesture, changed)


def with_switch(
    gesture: Gesture | None, *, direction: bool = False, tempo: bool = False
) -> Gesture | None:
    """Let the direction or the tempo count; None where there is no gesture."""
    if gesture is None:
        return None
    switches = gesture.switches
    wanted = replace(
        switches,
        direction="on" if direction else switches.direction,
        tempo="on" if tempo else switches.tempo,
    )
    return replace(gesture, switches=wanted)


def _reshown(gesture: Gesture, change: Callable[[Trajectory], Trajectory]) -> Gesture | None:
    """Apply a change to the demonstration, and draw it anew; None without a demonstration."""
    if gesture.trajectory is None or not gesture.salient:
        return None
    return replace(gesture, trajectory=change(gesture.trajectory)).redrawn()


def _stretched(shown: Trajectory, factors: tuple[float, float]) -> Trajectory:
    """Stretch every arm's landmarks about their mean places; the trunk stays."""
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
