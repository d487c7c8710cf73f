"""Replies to the diver and their patterns: five numbers of blinks or nods, without ROS or MAVLink.

Nobody reads a display under water. The patterns differ by the number of pulses, which a diver
counts at any distance, and not by their duration. A pulse lasts long enough to be seen by a camera
of 15 frames a second, and there are fewer than 3 flashes a second (WCAG 2.2, criterion 2.3.1).
"""

from __future__ import annotations

from enum import Enum

PULSE_SECONDS = 0.5
"""Seconds from one blink to the next, half of it on: 2 flashes a second, each of 3.75 frames at 15
frames a second."""


class Reply(str, Enum):
    """Reply to the diver; its value is the key in tables and events.

    Attributes
    ----------
    words
        What it tells the diver, in few words.
    pulses
        Its pattern: the number of blinks or nods, unless a table sets another one.

    """

    words: str
    pulses: int

    def __new__(cls, key: str, words: str, pulses: int) -> Reply:
        """Create a reply from its key, words and pulses."""
        reply = str.__new__(cls, key)
        reply._value_, reply.words, reply.pulses = key, words, pulses
        return reply

    listening = ("listening", "listening", 1)
    """A gesture, or the next one of a message, is awaited."""
    repeat = ("repeat", "show it again", 2)
    """Understood: the same gesture or message again confirms it, so two pulses ask for it."""
    one_of_two = ("one_of_two", "which of two?", 3)
    """One of two gestures: showing the one that was meant decides and confirms."""
    done = ("done", "done", 4)
    """Done, or cancelled."""
    refused = ("refused", "not understood, not done", 5)
    """Not understood, refused or failed."""


def find_phrase_reply(kind: str, label: str | None, pair: tuple[str, str] | None) -> Reply | None:
    """Return what the diver should see after a phrase event; see ``osg_interfaces/Phrase``.

    A message without a `label` is cancelled by no gesture: the robot has lost it.
    """
    if kind == "repeat" and pair is not None:
        return Reply.one_of_two
    if kind == "outside" and label is None:
        return None
    if kind == "cancelled" and label is not None:
        return Reply.done
    return Reply.listening if kind == "continues" else Reply.refused
