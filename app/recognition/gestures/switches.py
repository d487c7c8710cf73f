"""Switches: what about a gesture counts, where the author knows better than the recogniser."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from app.recognition.errors import GestureError

Switch = Literal["auto", "on", "off"]


@dataclass(frozen=True, kw_only=True)
class Switches:
    """What about one gesture counts, in profile ``full``.

    Attributes
    ----------
    direction
        Whether the way it is drawn counts. ``auto``: where another gesture of the language is
        the same figure turned round.
    tempo
        Whether its duration counts. ``auto``: where another gesture of the language is the same
        movement, clearly slower or quicker.
    mirror
        ``on``: its mirror image, with the other hand, is the same gesture. ``auto``, ``off``: it
        is not; what one hand means, the other does not mean unless the author says so. ``off``
        also insists on the sides of a two-handed gesture, which are otherwise read as exchanged
        where nothing else in the language is meant by it.

    Raises
    ------
    GestureError
        When a value is another word.

    """

    direction: Switch = "auto"
    tempo: Switch = "auto"
    mirror: Switch = "auto"

    def __post_init__(self) -> None:
        """Check the words."""
        for name, value in vars(self).items():
            if value not in get_args(Switch):
                raise GestureError(f"{name} must be auto, on or off, got {value!r}")


AUTOMATIC = Switches()


@dataclass(frozen=True, kw_only=True)
class Sensitivity:
    """What about a gesture counts in its language, the automatic switches decided.

    Attributes
    ----------
    direction
        Whether it is read only the way round it was shown.
    tempo
        Whether its duration counts.
    sides
        Whether its left and right are never read as exchanged.

    """

    direction: bool
    tempo: bool
    sides: bool
