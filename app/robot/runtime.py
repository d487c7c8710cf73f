"""The robot's loop: frames in, events out, until the recording is over or somebody stops it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Final

from app.recognition.errors import OsgError
from app.recognition.estimation import list_landmarks
from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.water import WaterCorrection, correct_colours
from app.recognition.language.requirements import require_landmarks
from app.recognition.poses.frame import FrameLandmarks
from app.recognition.recording.extraction import build_frame_sequence
from app.recognition.recording.salute import best_salute
from app.robot.active_language import SpokenLanguage
from app.robot.events import (
    Event,
    FramesDropped,
    LanguageChanged,
    LanguageRefused,
    SourceEnded,
    SourceLost,
    SourceOpened,
    SourceRestored,
    SourceWarned,
)
from app.robot.listeners.salute_listener import Hearing
from app.robot.sources.source import Frame, Notice, Quiet, Source

REPORT_SECONDS: Final = 10.0
"""Between two reports of dropped frames: a slow machine drops some all the time, and a log of days
must stay readable."""

THE_ESTIMATOR: Final = "the pose estimator"
"""What lacks a landmark, in messages."""

LanguageChanges = Callable[[], SpokenLanguage | OsgError | None]
"""Tells, without waiting, which language is to be spoken from now on, why a new one cannot be, or
None: nothing new."""

Observer = Callable[[Frame, FrameLandmarks], None]
"""``observer(frame, found)``: a frame that was looked at, and what was found in it."""


def nothing_new() -> None:
    """Speak the same language until the end."""


class Runtime:
    """Looks at the frames of a source one after the other and tells what happens.

    Iterate over it once, in the thread that shall do the work::

        with closing(open_source("dive.mp4")) as source, closing(create_estimator()) as estimator:
            for event in Runtime(source, estimator, Listener(SpokenLanguage.load("pool.json"))):
                ...

    Nothing is printed, and nothing is kept beyond what the listener remembers. A source that is
    lost ends whatever was begun: neither a take nor what the estimator tracked goes on across it.

    Parameters
    ----------
    source
        Where frames come from; closed by whoever opened it.
    estimator
        What finds the landmarks; reset first, closed by whoever made it.
    listener
        What hears gestures in them.
    water
        Whether colour and contrast are set right first, as in `app.recognition.record`.
    changes
        Asked before every frame for another language.
    observer
        Called with every frame and its landmarks, before the listener hears them.

    Raises
    ------
    LandmarkError
        When the estimator cannot find a landmark that the language needs; a later language that
        needs one is refused.

    """

    def __init__(
        self,
        source: Source,
        estimator: PoseEstimator,
        listener: Hearing,
        *,
        water: WaterCorrection = "auto",
        changes: LanguageChanges = nothing_new,
        observer: Observer | None = None,
    ) -> None:
        require_landmarks(
            listener.language.recognizer.language, list_landmarks(estimator), THE_ESTIMATOR
        )
        self._source = source
        self._estimator = estimator
        self._listener = listener
        self._water = water
        self._changes = changes
        self._observer = observer
        self._stopped = False
        self._drops = DropCount()
        self._time = 0.0

    def stop(self) -> None:
        """End after the frame that is looked at now; may be called anywhere, also by a signal."""
        self._stopped = True

    def __iter__(self) -> Iterator[Event]:
        """Look at frames and give what happens, in order.

        Raises
        ------
        OsgError
            When a recording turns out to be unreadable, or an image is none.

        """
        yield self._opened()
        yield language_changed(self._time, self._listener.language)
        self._estimator.reset()
        for given in self._source:
            self._time = given.time
            yield from self._new_language()
            yield from self._look(given) if isinstance(given, Frame) else self._heed(given)
            if self._stopped:
                break
        yield from self._listener.finish()
        yield SourceEnded(self._time, self._drops.frames, self._drops.dropped, self._stopped)

    def _opened(self) -> SourceOpened:
        source = self._source
        return SourceOpened(0.0, source.name, source.live, source.frame_size, source.began)

    def _look(self, frame: Frame) -> Iterator[Event]:
        found = self._estimator.estimate(correct_colours(frame.image, self._water), frame.time)
        if self._observer is not None:
            self._observer(frame, found)
        height, width = frame.image.shape[:2]
        moment = build_frame_sequence(
            found, frame.time, (width, height), list_landmarks(self._estimator)
        )
        yield from self._listener.feed(moment, best_salute(found.hands))
        yield from self._drops.count(frame)

    def _heed(self, notice: Notice) -> Iterator[Event]:
        match notice:
            case SourceLost(time, reason):
                yield notice
                yield from self._listener.abandon(time, f"the source was lost: {reason}")
            case SourceRestored():
                self._estimator.reset()
                yield notice
            case SourceWarned():
                yield notice
            case Quiet():
                pass

    def _new_language(self) -> Iterator[Event]:
        """Speak another language where there is one; a take that goes on is recognised by it."""
        change = self._changes()
        if isinstance(change, SpokenLanguage):
            try:
                language = change.recognizer.language
                require_landmarks(language, list_landmarks(self._estimator), THE_ESTIMATOR)
                self._listener.speak(change)
            except OsgError as error:
                change = error
            else:
                yield language_changed(self._time, change)
        if isinstance(change, OsgError):
            kept = self._listener.language
            yield LanguageRefused(self._time, str(change), kept.sha256, kept.revision)


class DropCount:
    """Counts frames looked at and left out.

    Attributes
    ----------
    frames, dropped
        Since the beginning.

    """

    def __init__(self) -> None:
        self.frames = 0
        self.dropped = 0
        self._since = 0.0
        self._told = (0, 0)

    def count(self, frame: Frame) -> Iterator[FramesDropped]:
        """Count a frame, and tell now and then how many were left out."""
        self.frames += 1
        self.dropped += frame.dropped
        frames, dropped = self.frames - self._told[0], self.dropped - self._told[1]
        seconds = frame.time - self._since
        if seconds < REPORT_SECONDS:
            return
        self._since, self._told = frame.time, (self.frames, self.dropped)
        if dropped:
            yield FramesDropped(frame.time, seconds, dropped, frames)


def language_changed(time: float, language: SpokenLanguage) -> LanguageChanged:
    """Tell which language is spoken from now on."""
    recognizer = language.recognizer
    return LanguageChanged(
        time=time,
        name=language.name,
        sha256=language.sha256,
        revision=language.revision,
        gestures=recognizer.language.labels,
        profile=recognizer.profile,
        tuning=recognizer.tuning.words,
    )
