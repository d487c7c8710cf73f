"""Gesture worker: thread that processes the frames of a node's topic."""

from __future__ import annotations

import threading
import time
import traceback
from collections import deque
from collections.abc import Iterable, Mapping
from contextlib import closing
from typing import Protocol

from app.recognition.errors import OsgError
from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.water import WaterCorrection
from app.recognition.poses.frame import FrameLandmarks
from app.robot import ActiveLanguage, Event, Frame, PhraseListener, Runtime
from osg_ros.topics.topic_source import TopicSource

MOST_FAILURES = 3
"""Failures within `FAILURE_SECONDS` after which the recogniser is not started again."""

FAILURE_SECONDS = 60.0
"""Seconds after which a failure no longer counts; an error in every picture is found sooner."""

STUCK_SECONDS = 120.0
"""Seconds without progress after which the thread counts as hanging. The first picture takes
longest: some providers compile the models for up to a minute."""

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

    After a failure the recogniser is restarted with an empty memory. Repeated failures, or a hang,
    are a fault (`find_fault`) on which the process should end.

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
        self._estimator = estimator
        self._water = water
        self._handler = handler
        self._next: ActiveLanguage | None = None
        self._listener = listener
        self._stopping = False
        self._failures: deque[float] = deque(maxlen=MOST_FAILURES)
        self._failed = 0
        self._fault = ""
        self._beat: float | None = None
        self._runtime = self._create_runtime()
        self._thread = threading.Thread(target=self._run, name="gestures", daemon=True)
        self._thread.start()

    def set_language(self, language: ActiveLanguage) -> None:
        """Recognise another language from the next frame on."""
        self._next = language

    def facts(self) -> Mapping[str, str]:
        """Return the state of the recogniser, for diagnostics."""
        state = self.find_fault() or "working"
        return {"recogniser": state, "recogniser failures": str(self._failed)}

    def find_fault(self) -> str:
        """Return why the recogniser has stopped; empty while it works."""
        if self._fault or self._stopping:
            return self._fault
        if not self._thread.is_alive():
            return "the recogniser's thread has ended"
        silent = 0.0 if self._beat is None else time.monotonic() - self._beat
        return f"the recogniser hangs for {silent:.0f} s" if silent > STUCK_SECONDS else ""

    def stop(self) -> None:
        """Stop after the current frame."""
        self._stopping = True
        self._runtime.stop()
        self._source.close()
        self._thread.join(LONGEST_FRAME)

    def _create_runtime(self) -> Runtime:
        return Runtime(
            self._source,
            self._estimator,
            self._listener,
            water=self._water,
            changes=self._take_language,
            observer=lambda frame, found: self._handler.handle_frame(self._source, frame, found),
        )

    def _run(self) -> None:
        with closing(self._source):
            while not self._stopping and not self._fault:
                try:
                    self._handle_events(self._runtime)
                    return
                except Exception as error:
                    self._note_failure(error)

    def _handle_events(self, events: Iterable[Event]) -> None:
        for event in events:
            self._handler.handle_event(self._source, event, self._listener.language)

    def _note_failure(self, error: Exception) -> None:
        """Report a failure, and restart with an empty memory unless it is the last one."""
        now = time.monotonic()
        self._failed += 1
        self._failures.append(now)
        what = f"the recogniser failed ({type(error).__name__}: {error})"
        if not isinstance(error, OsgError):
            what += "\n" + "".join(traceback.format_exception(error))
        recent = [each for each in self._failures if now - each <= FAILURE_SECONDS]
        if len(recent) == MOST_FAILURES:
            self._fault = what.partition("\n")[0]
            self._handler.report_problem(f"{what}; it is not started again")
            return
        self._handler.report_problem(f"{what}; it starts again")
        try:
            self._handle_events(self._listener.abandon(now, "the recogniser failed"))
        except Exception as second:
            self._fault = f"the recogniser cannot be started again ({second})"
            return
        self._runtime = self._create_runtime()

    def _take_language(self) -> ActiveLanguage | None:
        self._beat = time.monotonic()
        language, self._next = self._next, None
        return language
