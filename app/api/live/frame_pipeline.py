"""Frame pipeline: decodes the frames of a live view, finds landmarks and takes, recognises."""

from __future__ import annotations

import struct
import time as clock
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, Literal, Self

import av
import numpy as np
from pydantic import BaseModel

from app.api.workers.worker_messages import Pose, pose_in
from app.recognition import OsgError, PoseSequence, Recognition, Recognizer, Take
from app.recognition.errors import VideoError
from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.water import WaterCorrection
from app.recognition.estimation.water_sight import WaterSight
from app.recognition.poses.frame import Image
from app.recognition.recording.extraction import build_frame_sequence
from app.recognition.recording.live_segmentation import LiveTakes, Sight
from app.recognition.recording.segmentation import TakeState
from app.recognition.spotting import Spotter
from app.recognition.triggers.trigger import SALUTE, Trigger

MOST_PIXELS: Final = 2_500_000
"""Of one frame, with the margin that FFmpeg adds when it counts: 1920 x 1080 passes, and the page
sends half of it."""

RATE_SECONDS: Final = 2.0
"""Time over which frames per second are counted: long enough to be read, short enough to follow."""

TIMESTAMP: Final = struct.Struct("<d")
"""What stands before a frame's JPEG: when it was captured, in seconds of the page's own clock."""

ASK_SECONDS: Final = 1.0
"""Seconds between two looks at the language's trigger, which an edit may change."""

RecognizerSource = Callable[[], Recognizer | None]
"""Returns the recogniser to ask now; None where only landmarks and takes are wanted."""


class Seen(BaseModel):
    """What was found in a frame.

    Attributes
    ----------
    time
        The frame's timestamp, as the page gave it.
    pose
        The body; None where nobody is in the frame.
    hands
        Up to two hands of 21 landmarks each (`HAND_LANDMARKS`), as `pose`.
    salute
        In [0, 1]: how much the best hand salutes, or the language's other trigger is shown.
    held
        Whether it counts now.
    state
        Whether a salute is awaited, a take goes on, or the salute that ended it is still held.
    frames_per_second
        How many frames were looked at lately.
    seconds
        From the frame's arrival to this answer.
    skipped
        Frames since the one before that were not looked at, because newer ones had arrived.

    """

    kind: Literal["seen"] = "seen"
    time: float
    pose: Pose | None
    hands: tuple[Pose, ...]
    salute: float
    held: bool
    state: TakeState
    frames_per_second: float
    seconds: float
    skipped: int


class Recognized(BaseModel):
    """What was shown between two salutes.

    Attributes
    ----------
    start, end
        Seconds of the page's clock.
    closed
        Whether a stop salute ended it.
    language
        Name of the language that was asked; None: there was none to ask.
    label, nearest, confidence
        As in `app.recognition.Recognition`; None where nothing was recognised.
    voters, agreeing
        How many votes counted, and how many of them chose `nearest`.
    problem
        Why there is no label, where the movement itself is not the reason.

    """

    kind: Literal["recognized"] = "recognized"
    start: float
    end: float
    closed: bool
    language: str | None = None
    label: str | None = None
    nearest: str | None = None
    confidence: float | None = None
    voters: int = 0
    agreeing: int = 0
    problem: str | None = None


@dataclass(frozen=True)
class Frame:
    """A frame as it arrived.

    Attributes
    ----------
    time
        When it was captured, in seconds of the page's clock.
    jpeg
        The picture.
    arrived
        When it arrived, in seconds of `time.monotonic`.
    skipped
        Frames that had arrived since the last look and were not looked at.

    """

    time: float
    jpeg: bytes
    arrived: float
    skipped: int = 0

    @classmethod
    def parse(cls, message: bytes, skipped: int) -> Self:
        """Take apart what a page sends: `TIMESTAMP`, then a JPEG.

        Raises
        ------
        VideoError
            When it is too short, or the time is no number.

        """
        if len(message) <= TIMESTAMP.size:
            raise VideoError(f"a frame of {len(message)} bytes: send 8 bytes of time, then a JPEG")
        (time,) = TIMESTAMP.unpack_from(message)
        if not np.isfinite(time):
            raise VideoError(f"a frame's time is {time}: send seconds as a 64-bit float")
        return cls(time, message[TIMESTAMP.size :], clock.monotonic(), skipped)


class FramePipeline:
    """Watches one camera: its estimator tracks, so every connection needs its own.

    Parameters
    ----------
    estimator
        What finds the landmarks; closed by `close`.
    water
        Whether colour and contrast are corrected first.
    recognizer
        Asked for the recogniser whenever a take ends, so that an edit of the language counts.

    """

    def __init__(
        self, estimator: PoseEstimator, water: WaterCorrection, recognizer: RecognizerSource
    ) -> None:
        self._estimator = estimator
        self._sight = WaterSight(estimator, water)
        self._recognizer = recognizer
        self._takes: LiveTakes | None = None
        self._trigger = SALUTE
        self._asked = -np.inf  # when the trigger was asked for
        self._spotter: Spotter | None = None
        self._spots: Recognizer | None = None  # whose gestures the spotter finds
        self._time = -np.inf
        self._looks: deque[float] = deque()

    def look(self, frame: Frame) -> tuple[Seen | Recognized, ...]:
        """Look at the next frame, and at the take that it ends.

        A frame of another size, or from before the last one, is another camera's: what was tracked
        and every take begun are forgotten.

        Raises
        ------
        VideoError
            When the frame is no JPEG, or too large.

        """
        image = decode_frame(frame.jpeg)
        height, width = image.shape[:2]
        takes = self._takes
        if takes is None or takes.frame_size != (width, height) or frame.time <= self._time:
            self._sight.reset()
            takes, self._spotter, self._asked = None, None, -np.inf
        trigger = self._find_trigger()
        if takes is None or takes.trigger != trigger:
            takes = self._takes = LiveTakes((width, height), trigger)
        self._time = frame.time
        found = self._sight.estimate(image, frame.time)
        sight = takes.feed(frame.time, found)
        seen = Seen(
            time=frame.time,
            pose=pose_in(found.body.xy, width, height) if found.body else None,
            hands=tuple(pose_in(hand.xy, width, height) for hand in found.hands),
            salute=round(sight.salute, 3),
            held=sight.held,
            state=sight.state,
            frames_per_second=self._rate(),
            seconds=round(clock.monotonic() - frame.arrived, 4),
            skipped=frame.skipped,
        )
        moment = build_frame_sequence(found, frame.time, (width, height))
        return (seen, *(self._spot(moment) if trigger.spots else self._recognize(sight)))

    def close(self) -> None:
        """Release the models."""
        self._estimator.close()

    def _rate(self) -> float:
        """Count this look, and return how many there were in a second."""
        now = clock.monotonic()
        self._looks.append(now)
        while now - self._looks[0] > RATE_SECONDS:
            self._looks.popleft()
        lasted = now - self._looks[0]
        return round((len(self._looks) - 1) / lasted, 2) if lasted > 0 else 0.0

    def _find_trigger(self) -> Trigger:
        """Return the trigger of the language that is asked, of none the salute."""
        if clock.monotonic() - self._asked > ASK_SECONDS:
            self._asked = clock.monotonic()
            try:
                recognizer = self._recognizer()
                self._trigger = SALUTE if recognizer is None else recognizer.language.trigger
                if recognizer is not None and self._trigger.spots:
                    self._renew_spotter(recognizer)
            except OsgError:  # no such language, or no gesture to spot in it
                self._trigger, self._spotter = SALUTE, None
        return self._trigger

    def _renew_spotter(self, recognizer: Recognizer) -> None:
        if self._spotter is None or self._spots is not recognizer:
            self._spotter, self._spots = Spotter(recognizer), recognizer

    def _spot(self, moment: PoseSequence) -> tuple[Recognized, ...]:
        """Return the gestures that ended, without a trigger around them."""
        if self._spotter is None or self._spots is None:
            return ()
        return tuple(
            _view_answer(self._spots, each.recognition, each.start, each.end, closed=True)
            for each in self._spotter.feed(moment)
        )

    def _recognize(self, sight: Sight) -> tuple[Recognized, ...]:
        if sight.take is None:
            return ()
        try:
            return (answer_of(sight.take, self._recognizer()),)
        except OsgError as error:
            return (_view_take(sight.take, problem=str(error)),)


def answer_of(take: Take, recognizer: Recognizer | None) -> Recognized:
    """Recognise a take.

    Raises
    ------
    PoseError
        When the take shows nothing that could be compared.

    """
    if recognizer is None:
        return _view_take(take, problem="no language is chosen; choose one above")
    result = recognizer.recognize(take.poses)
    return _view_answer(recognizer, result, take.start, take.end, closed=take.closed)


def _view_answer(
    recognizer: Recognizer, result: Recognition, start: float, end: float, *, closed: bool
) -> Recognized:
    votes = list(result.counted.values())
    return Recognized(
        start=start,
        end=end,
        closed=closed,
        language=recognizer.language.name,
        label=result.label,
        nearest=result.nearest,
        confidence=round(result.confidence, 4),
        voters=len(votes),
        agreeing=votes.count(result.nearest),
        problem=result.fault,
    )


def _view_take(take: Take, **answer: object) -> Recognized:
    about = {"start": take.start, "end": take.end, "closed": take.closed}
    return Recognized.model_validate(about | answer)


def decode_frame(jpeg: bytes) -> Image:
    """Return a JPEG as ``(height, width, 3)`` RGB.

    Raises
    ------
    VideoError
        When it is none, or has more than `MOST_PIXELS`; found out before it takes memory.

    """
    decoder = av.CodecContext.create("mjpeg", "r")
    decoder.options = {"max_pixels": str(MOST_PIXELS)}
    try:
        frames = decoder.decode(av.Packet(jpeg))
        image = frames[0].to_ndarray(format="rgb24")
    except (av.error.FFmpegError, IndexError) as error:
        raise VideoError(
            f"a frame of {len(jpeg)} bytes is no JPEG of at most 1920 x 1080 pixels; send "
            "smaller ones"
        ) from error
    return np.ascontiguousarray(image, dtype=np.uint8)
