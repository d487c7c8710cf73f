"""Answers that a diver can see: five, each a number of blinks or nods, without ROS or MAVLink.

Nobody reads a display under water. The answers differ by the number of pulses, which a diver counts
at any distance, and not by their duration. A pulse lasts long enough to be seen by a camera of 15
frames a second, and there are fewer than 3 flashes a second (WCAG 2.2, criterion 2.3.1).
"""

from __future__ import annotations

from enum import Enum

PULSE_SECONDS = 0.5
"""Seconds from one blink to the next, half of it on: 2 flashes a second, each of 3.75 frames at 15
frames a second."""


class Answer(str, Enum):
    """Answer to the diver."""

    listening = "listening"
    """A gesture, or the next one of a message, is awaited."""
    repeat = "repeat"
    """Understood: the same gesture or message again confirms it."""
    one_of_two = "one_of_two"
    """One of two gestures: showing the one that was meant decides and confirms."""
    done = "done"
    """Done, or cancelled."""
    refused = "refused"
    """Not understood, refused or failed."""

    @property
    def words(self) -> str:
        """What the answer tells the diver, in few words."""
        return {
            Answer.listening: "listening",
            Answer.repeat: "show it again",
            Answer.one_of_two: "which of two?",
            Answer.done: "done",
            Answer.refused: "not understood, not done",
        }[self]


PULSES = {answer: number for number, answer in enumerate(Answer, start=1)}
"""Number of blinks or nods of each answer; two pulses ask for the second showing."""


def find_phrase_answer(kind: str, label: str | None, pair: tuple[str, str] | None) -> Answer | None:
    """Return what the diver should see after a phrase event; see ``osg_interfaces/Phrase``.

    A message without a `label` is cancelled by no gesture: the robot has lost it.
    """
    if kind == "repeat" and pair is not None:
        return Answer.one_of_two
    if kind == "outside" and label is None:
        return None
    if kind == "cancelled" and label is not None:
        return Answer.done
    return Answer.listening if kind == "continues" else Answer.refused
