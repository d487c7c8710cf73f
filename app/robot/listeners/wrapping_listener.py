"""Wrapping listener: the base of listeners that work through another one."""

from __future__ import annotations

from app.recognition.recording.segmentation import TakeState
from app.robot.active_language import ActiveLanguage
from app.robot.listeners.salute_listener import LandmarkListener
from app.robot.listeners.stream_order import StreamOrder


class WrappingListener:
    """Listener whose language, state and order are those of the wrapped listener.

    Parameters
    ----------
    listener
        The wrapped listener.

    """

    def __init__(self, listener: LandmarkListener) -> None:
        self._listener = listener

    @property
    def language(self) -> ActiveLanguage:
        """The active language."""
        return self._listener.language

    @property
    def state(self) -> TakeState:
        """State of the triggers."""
        return self._listener.state

    @property
    def order(self) -> StreamOrder:
        """What is known of the order of the frames."""
        return self._listener.order
