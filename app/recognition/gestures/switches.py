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
        is the same movement with a clearly different hand shape. A held hand shape always counts.

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
