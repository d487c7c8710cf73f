"""Switches: whether direction, tempo, mirror image and hand shape count, as the author chooses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from app.recognition.errors import GestureError

Switch = Literal["auto", "on", "off"]


@dataclass(frozen=True, kw_only=True)
class Switches:
    """The switches of one gesture, used by profile ``full``.

    Attributes
    ----------
    direction
        Whether the direction counts. ``auto``: if another gesture of the language is the same
        figure in the opposite direction.
    tempo
        Whether its duration counts. ``auto``: if another gesture of the language is the same
        movement, clearly slower or quicker.
    mirror
        ``on``: its mirror image, with the other hand, is the same gesture. ``auto``, ``off``: it
        is not. ``off`` also rejects takes of two-handed gestures with exchanged sides, which
        ``auto`` accepts unless they mean another gesture of the language.
    hand_shape
        Whether the shape of the moving hand counts. ``auto``: if another gesture of the language
        is the same movement, and several demonstrations of each show one clearly different hand
        shape. A held hand shape always counts.

    Raises
    ------
    GestureError
        When a value is another word.

    """

    direction: Switch = "auto"
    tempo: Switch = "auto"
    mirror: Switch = "auto"
    hand_shape: Switch = "auto"

    def __post_init__(self) -> None:
        """Validate the values."""
        for name, value in vars(self).items():
            if value not in get_args(Switch):
                raise GestureError(f"{name} must be auto, on or off, got {value!r}")


AUTOMATIC = Switches()


@dataclass(frozen=True, kw_only=True)
class Sensitivity:
    """The properties of a gesture that count in its language, with `auto` resolved.

    Attributes
    ----------
    direction
        Whether only the demonstrated direction is accepted.
    tempo
        Whether its duration counts.
    sides
        Whether takes with left and right exchanged are rejected.
    hand_shape
        Whether the shape of the moving hand counts.

    """

    direction: bool
    tempo: bool
    sides: bool
    hand_shape: bool


def describe_effects(
    switches: Switches, counting: Sensitivity | None, *, hands: int, held: bool
) -> dict[str, str]:
    """Describe what each switch comes to in a language, in words.

    Parameters
    ----------
    switches
        The gesture's.
    counting
        What counts in the language; None: only a drawing is known.
    hands
        How many parts of the body move independently (`find_hands`).
    held
        Whether the gesture is a held hand shape.

    """
    names = [*vars(switches)]
    if held:
        words = dict.fromkeys(names, "a held hand shape does not move")
        words["hand_shape"] = "a held hand shape always counts"
        words["mirror"] = _describe_held_mirror(switches)
        return words
    if counting is None:
        return dict.fromkeys(names, "only the drawing is known, which looks the same either way")
    return {
        "direction": _describe_direction(switches, counting, hands),
        "tempo": _describe_tempo(switches, counting),
        "mirror": _describe_mirror(switches, counting),
        "hand_shape": _describe_hand_shape(switches, counting),
    }


def _describe_direction(switches: Switches, counting: Sensitivity, hands: int) -> str:
    if hands != 1:
        return "the direction counts: of two hands, opening is the reverse of closing"
    if not counting.direction:
        return "the reverse direction counts as the same gesture"
    if switches.direction == "on":
        return "the reverse direction is not the gesture"
    return "the direction counts: another gesture is the same figure in reverse"


def _describe_tempo(switches: Switches, counting: Sensitivity) -> str:
    if not counting.tempo:
        return "the gesture may take any time"
    if switches.tempo == "on":
        return "the duration counts"
    return "the duration counts: another gesture is the same movement, clearly slower or quicker"


def _describe_mirror(switches: Switches, counting: Sensitivity) -> str:
    if switches.mirror == "on":
        return "the mirror image, with the other hand, counts as the same gesture"
    if not counting.sides:
        return "the mirror image is not the gesture, but left and right may be exchanged"
    return "the mirror image, with the other hand, is not the gesture"


def _describe_held_mirror(switches: Switches) -> str:
    if switches.mirror == "off":
        return "the mirror image, with the other hand, is not the gesture"
    also = "the mirror image, with the other hand, counts as the same gesture"
    return also if switches.mirror == "on" else f"{also}, unless it is another one"


def _describe_hand_shape(switches: Switches, counting: Sensitivity) -> str:
    if counting.hand_shape:
        if switches.hand_shape == "on":
            return "the hand must be seen and have this shape while it moves"
        return "the hand shape counts: several takes show it, and another one for the same movement"
    if switches.hand_shape == "on":
        return "no hand is seen in the demonstration that keeps a shape: it cannot count"
    return "the hand may have any shape"
