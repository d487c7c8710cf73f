"""The thread in which a node looks at the frames of its topic."""

from __future__ import annotations

import threading
from contextlib import closing
from typing import Protocol

from app.recognition.errors import OsgError
from app.recognition.estimation import FrameLandmarks, PoseEstimator
from app.recognition.estimation.water import WaterCorrection
from app.robot import Event, Frame, PhraseListener, Runtime, SpokenLanguage
from osg_ros.topics.topic_source import TopicSource

LONGEST_FRAME = 10.0
"""Seconds that the last frame may take when the thread is stopped; a slow robot needs one."""


class Watching(Protocol):
    """Who is told what a worker sees; called in the worker's thread."""

    def look(self, source: TopicSource, frame: Frame, found: FrameLandmarks) -> None:
        """Take a frame and its landmarks."""
        ...

    def hear(self, source: TopicSource, event: Event, language: SpokenLanguage) -> None:
        """Take what happened, and the language that is listened for."""
        ...

    def complain(self, what: str) -> None:
        """Take a problem, in one line."""
        ...


class GestureWorker:
    """Runs `app.robot.Runtime` in a thread until it is stopped.

    Parameters
    ----------
    source
        Closed at the end.
    estimator
        Used by nobody else meanwhile.
    listener
        Hears the gestures.
    water
        Correction of the frames.
    watching
        Who is told.

    """

    def __init__(
        self,
        source: TopicSource,
        estimator: PoseEstimator,
        listener: PhraseListener,
        water: WaterCorrection,
        watching: Watching,
    ) -> None:
        self._source = source
        self._watching = watching
        self._next: SpokenLanguage | None = None
        self._listener = listener
        self._runtime = Runtime(
            source,
            estimator,
            self._listener,
            water=water,
            changes=self._new_language,
            observer=lambda frame, found: watching.look(source, frame, found),
        )
        self._thread = threading.Thread(target=self._run, name="gestures", daemon=True)
        self._thread.start()

    def speak(self, language: SpokenLanguage) -> None:
        """Listen for another language from the next frame on."""
        self._next = language

    def stop(self) -> None:
        """End after the frame that is looked at now."""
        self._runtime.stop()
        self._source.close()
        self._thread.join(LONGEST_FRAME)

    def _run(self) -> None:
        try:
            with closing(self._source):
                for event in self._runtime:
                    self._watching.hear(self._source, event, self._listener.language)
        except OsgError as error:
            self._watching.complain(str(error))

    def _new_language(self) -> SpokenLanguage | None:
        language, self._next = self._next, None
        return language
