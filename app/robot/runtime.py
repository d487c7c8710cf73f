"""Robot runtime: processes frames into events until the recording ends or it is stopped."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Final

from app.recognition.errors import OsgError
from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.factory import list_landmarks
from app.recognition.estimation.water import Sparing, WaterCorrection, WaterSight
from app.recognition.language.requirements import require_landmarks, require_trigger
from app.recognition.poses.frame import FrameLandmarks
from app.recognition.recording.extraction import build_frame_sequence
from app.recognition.recording.live_segmentation import PeopleInStream
from app.recognition.recording.salute import best_salute
from app.robot import events
from app.robot.active_language import ActiveLanguage
from app.robot.listeners.trigger_listener import LandmarkListener
from app.robot.sources.source import Frame, NoFrame, Notice, Source

REPORT_SECONDS: Final = 10.0
"""Seconds between two events about dropped frames; keeps a log of several days readable."""

HEARTBEAT_SECONDS: Final = 5.0
"""Seconds between two heartbeats; a supervisor (`docs/robots/service.md`) waits for six of them."""

RATE_SECONDS: Final = 5.0
"""Seconds over which the rate of processed frames is measured: a gesture with its salutes."""

LEAST_RATE: Final = 4.0
"""Processed frames a second below which gestures are missed; see `docs/robots/on-the-boat.md`."""

SPARE_BELOW: Final = 10.0
"""Processed frames a second below which a machine that drops frames does less for each. Below
`LEAST_RATE` that would help nobody: salutes are missed (`benchmarks/studies/speed.md`)."""

SPARE_UNTIL: Final = 20.0
"""The same above which it does everything again: twice as many, for doing less raises the rate."""

THE_ESTIMATOR: Final = "the pose estimator"
"""Subject of the message about a missing landmark."""

LanguageChanges = Callable[[], ActiveLanguage | OsgError | None]
"""Returns without waiting: a new language, the error of an unusable one, or None for no change."""

Observer = Callable[[Frame, FrameLandmarks], None]
"""``observer(frame, found)``: called with a processed frame and the landmarks found in it."""


def keep_language() -> None:
    """Report no change, so that the language stays the same until the end."""


class Runtime:
    """Iterator of events: processes the frames of a source one after the other.

    Iterate over it once, in the thread that should do the work::

        with closing(open_source("dive.mp4")) as source, closing(create_estimator()) as estimator:
            for event in Runtime(source, estimator, create_listener(language)):
                ...

    It prints nothing and keeps no frames; the listener keeps the landmarks it needs. When a source
    is lost, an open take is rejected and the estimator's tracking is reset.

    Parameters
    ----------
    source
        Source of the frames; the caller closes it.
    estimator
        Finds the landmarks; reset before the first frame, closed by the caller.
    listener
        Recognises gestures in the landmarks.
    water
        Correction of colour and contrast before estimation, as in `app.recognition.record`.
    changes
        Called before every frame for a new language.
    observer
        Called with every frame and its landmarks, before the listener gets them.

    Raises
    ------
    LandmarkError
        When the estimator cannot find a landmark that the first language needs. A later language
        with this fault is refused.

    """

    def __init__(
        self,
        source: Source,
        estimator: PoseEstimator,
        listener: LandmarkListener,
        *,
        water: WaterCorrection = "auto",
        changes: LanguageChanges = keep_language,
        observer: Observer | None = None,
    ) -> None:
        self._require(listener.language, estimator)
        self._source = source
        self._estimator = estimator
        self._listener = listener
        self._sight = WaterSight(estimator, water)
        self._people = PeopleInStream()
        self._changes = changes
        self._observer = observer
        self._stopped = False
        self._drops = DropCounter()
        self._rate = RateWatch()
        self._time = 0.0
        self._beaten = 0.0
        self._lost = False
        self._spares = False

    def stop(self) -> None:
        """Stop after the current frame; any thread and any signal handler may call this."""
        self._stopped = True

    def __iter__(self) -> Iterator[events.Event]:
        """Process the frames and yield events, in order.

        Raises
        ------
        OsgError
            When a recording is unreadable, or a frame is not an image.

        """
        yield self._build_source_opened()
        yield build_language_changed(self._time, self._listener.language)
        self._sight.reset()
        self._people.reset()
        for given in self._source:
            self._time = given.time
            yield from self._update_language()
            if isinstance(given, Frame):
                yield from self._process_frame(given)
            else:
                yield from self._handle_notice(given)
            yield from self._beat()
            if self._stopped:
                break
        yield from self._listener.finish()
        yield from self._rate.finish()
        yield events.SourceEnded(self._time, self._drops.frames, self._drops.dropped, self._stopped)

    def _build_source_opened(self) -> events.SourceOpened:
        source = self._source
        return events.SourceOpened(0.0, source.name, source.live, source.frame_size, source.began)

    def _process_frame(self, frame: Frame) -> Iterator[events.Event]:
        found = self._sight.estimate(frame.image, frame.time)
        if self._observer is not None:
            self._observer(frame, found)
        self._people.by_salute = self._listener.language.trigger.kind == "salute"
        followed = self._people.follow(frame.time, found)
        if followed.change:
            yield events.SourceWarned(frame.time, followed.change)
        if followed.restarts:
            yield from self._listener.abandon(frame.time, followed.change)
        height, width = frame.image.shape[:2]
        for time, person in followed.frames:
            moment = build_frame_sequence(
                person, time, (width, height), list_landmarks(self._estimator)
            )
            yield from self._listener.feed(moment, best_salute(person.hands))
        if not self._drops.frames:
            yield events.RecognitionReady(frame.time)
        yield from self._drops.count(frame)
        yield from self._rate.count(frame.time)
        yield from self._spare()

    def _spare(self) -> Iterator[events.SourceWarned]:
        """Let the estimator do less for each frame of a camera that this machine cannot follow."""
        rate = self._rate.frames_per_second
        if rate is None or not self._source.live or not isinstance(self._estimator, Sparing):
            return
        if LEAST_RATE <= rate < SPARE_BELOW and not self._spares and self._drops.dropped:
            self._spares = True
            reason = (
                f"this machine processes {rate:.1f} frames a second: hands that move or hang are "
                "looked at once a second"
            )
        elif self._spares and not LEAST_RATE <= rate <= SPARE_UNTIL:
            self._spares = False
            reason = f"this machine processes {rate:.1f} frames a second: all is looked at again"
        else:
            return
        self._estimator.spare(spares=self._spares)
        yield events.SourceWarned(self._time, reason)

    def _handle_notice(self, notice: Notice) -> Iterator[events.Event]:
        match notice:
            case events.SourceLost(time, reason):
                self._lost = True
                self._rate.restart()
                yield notice
                yield from self._listener.abandon(time, f"the source was lost: {reason}")
            case events.SourceRestored():
                self._lost = False
                self._sight.reset()
                self._people.reset()
                yield notice
            case events.SourceWarned():
                yield notice
            case NoFrame():
                pass

    def _beat(self) -> Iterator[events.Heartbeat]:
        """Yield a heartbeat of a live source when it is due, also while it is lost."""
        if self._source.live and self._time - self._beaten >= HEARTBEAT_SECONDS:
            self._beaten = self._time
            yield events.Heartbeat(self._time, self._drops.frames, self._drops.dropped, self._lost)

    def _update_language(self) -> Iterator[events.Event]:
        """Activate a new language, if there is one; it also recognises an open take."""
        change = self._changes()
        if isinstance(change, ActiveLanguage):
            try:
                self._require(change, self._estimator)
                self._listener.set_language(change)
            except OsgError as error:
                change = error
            else:
                yield build_language_changed(self._time, change)
        if isinstance(change, OsgError):
            kept = self._listener.language
            yield events.LanguageRefused(self._time, str(change), kept.sha256, kept.revision)

    @staticmethod
    def _require(active: ActiveLanguage, estimator: PoseEstimator) -> None:
        """Refuse a language that needs landmarks beyond those of the estimator."""
        language, landmarks = active.recognizer.language, list_landmarks(estimator)
        require_landmarks(language, landmarks, THE_ESTIMATOR)
        require_trigger(language, landmarks, THE_ESTIMATOR)


class DropCounter:
    """Counter of processed and dropped frames.

    Attributes
    ----------
    frames, dropped
        Processed and dropped frames since the beginning.

    """

    def __init__(self) -> None:
        self.frames = 0
        self.dropped = 0
        self._since = 0.0
        self._reported = (0, 0)

    def count(self, frame: Frame) -> Iterator[events.FramesDropped]:
        """Count a frame; yield an event when frames were dropped in the last interval."""
        self.frames += 1
        self.dropped += frame.dropped
        frames, dropped = self.frames - self._reported[0], self.dropped - self._reported[1]
        seconds = frame.time - self._since
        if seconds < REPORT_SECONDS:
            return
        self._since, self._reported = frame.time, (self.frames, self.dropped)
        if dropped:
            yield events.FramesDropped(frame.time, seconds, dropped, frames)


class RateWatch:
    """Watch on the rate of processed frames.

    The first frame does not count, because the models are loaded while it is processed.

    Attributes
    ----------
    frames_per_second
        The rate in the last `RATE_SECONDS`; None before.

    """

    def __init__(self) -> None:
        self.frames_per_second: float | None = None
        self._is_first = True
        self._began: float | None = None
        self._last = 0.0
        self._frames = 0
        self._sufficient = True
        self._judged = False

    def count(self, time: float) -> Iterator[events.FrameRateChanged]:
        """Count a frame; yield an event when the rate has become too low, or enough again."""
        if self._is_first or self._began is None:
            self._began = None if self._is_first else time
            self._is_first = False
            return
        self._frames += 1
        self._last = time
        if time - self._began >= RATE_SECONDS:
            yield from self._judge(time)
            self._began, self._frames = time, 0

    def restart(self) -> None:
        """Measure anew, after a gap that has another cause."""
        self._began, self._frames = None, 0

    def finish(self) -> Iterator[events.FrameRateChanged]:
        """Judge a source that was too short for a measurement, if it lasted a second."""
        if not self._judged and self._began is not None and self._last - self._began >= 1:
            yield from self._judge(self._last)

    def _judge(self, time: float) -> Iterator[events.FrameRateChanged]:
        assert self._began is not None
        self._judged = True
        rate = self.frames_per_second = round(self._frames / (time - self._began), 1)
        if (rate >= LEAST_RATE) != self._sufficient:
            self._sufficient = not self._sufficient
            yield events.FrameRateChanged(time, rate, self._sufficient)


def build_language_changed(time: float, language: ActiveLanguage) -> events.LanguageChanged:
    """Build the event of a language that is active from now on."""
    recognizer = language.recognizer
    return events.LanguageChanged(
        time=time,
        name=language.name,
        sha256=language.sha256,
        revision=language.revision,
        gestures=recognizer.language.labels,
        profile=recognizer.profile,
        tuning=recognizer.tuning.words,
        undecided_twins=recognizer.undecided_twins,
    )
