"""Gesture worker: thread that processes the frames of a node's topic."""

from __future__ import annotations

import threading
from contextlib import closing
from typing import Protocol

from app.recognition.errors import OsgError
from app.recognition.estimation import FrameLandmarks, PoseEstimator
from app.recognition.estimation.water import WaterCorrection
from app.robot import ActiveLanguage, Event, Frame, PhraseListener, Runtime
from osg_ros.topics.topic_source import TopicSource

LONGEST_FRAME = 10.0
"""Seconds to wait for the last frame when the thread is stopped; a slow robot needs one second."""


class FrameHandler(Protocol):
    """Protocol of a handler of frames and events, called in the worker's thread."""

    def handle_frame(self, source: TopicSource, frame: Frame, found: FrameLandmarks) -> None:
        """Handle a frame and its landmarks."""
        ...

    def handle_event(self, source: TopicSource, event: Event, language: ActiveLanguage) -> None:
        """Handle an event of the active language."""
        ...

    def report_problem(self, what: str) -> None:
        """Handle a problem, described in one line."""
        ...


class GestureWorker:
    """Thread that runs `app.robot.Runtime` until it is stopped.

    Parameters
    ----------
    source
        Source of the frames; closed at the end.
    estimator
        Pose estimator for this worker alone.
    listener
        Recognises the gestures.
    water
        Correction of the frames.
    handler
        Handles frames, events and problems.

    """

    def __init__(
        self,
        source: TopicSource,
        estimator: PoseEstimator,
        listener: PhraseListener,
        water: WaterCorrection,
        handler: FrameHandler,
    ) -> None:
        self._source = source
        self._handler = handler
        self._next: ActiveLanguage | None = None
        self._listener = listener
        self._runtime = Runtime(
            source,
            estimator,
            self._listener,
            water=water,
            changes=self._take_language,
            observer=lambda frame, found: handler.handle_frame(source, frame, found),
        )
        self._thread = threading.Thread(target=self._run, name="gestures", daemon=True)
        self._thread.start()

    def set_language(self, language: ActiveLanguage) -> None:
        """Recognise another language from the next frame on."""
        self._next = language

    def stop(self) -> None:
        """Stop after the current frame."""
        self._runtime.stop()
        self._source.close()
        self._thread.join(LONGEST_FRAME)

    def _run(self) -> None:
        try:
            with closing(self._source):
                for event in self._runtime:
                    self._handler.handle_event(self._source, event, self._listener.language)
        except OsgError as error:
            self._handler.report_problem(str(error))

    def _take_language(self) -> ActiveLanguage | None:
        language, self._next = self._next, None
        return language
