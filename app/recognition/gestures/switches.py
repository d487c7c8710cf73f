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
        is not. ``off`` also refuses two-handed gestures with exchanged sides, which ``auto``
        accepts where no other gesture of the language is meant by that.
    hand_shape
        Whether the shape of the moving hand counts. ``auto``: if another gesture of the language
        is the same movement with a clearly different hand shape. Of a held hand shape it always
        does.

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
    """What counts of a gesture in its language, with `auto` resolved.

    Attributes
    ----------
    direction
        Whether only the demonstrated direction is accepted.
    tempo
        Whether its duration counts.
    sides
        Whether exchanged left and right are refused.
    hand_shape
        Whether the shape of the moving hand counts.

    """

    direction: bool
    tempo: bool
    sides: bool
    hand_shape: bool
