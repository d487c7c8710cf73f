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

from app.recognition import OsgError, PoseSequence, Recognition, Recognizer, Take
from app.recognition.errors import VideoError
from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.water import WaterCorrection, WaterSight
from app.recognition.poses.frame import Image, Pose, pose_in
from app.recognition.recording.extraction import build_frame_sequence
from app.recognition.recording.live_segmentation import LiveTakes, PeopleInStream, Sight
from app.recognition.recording.segmentation import TakeState
from app.recognition.spotting import Spotter
from app.recognition.triggers.trigger import SALUTE, Trigger

MOST_PIXELS: Final = 2_500_000
"""Most pixels of one frame, with the margin that FFmpeg adds to its count: 1920 x 1080 is accepted,
and `grab` of the page's `camera/video-source.js` sends at most 960 a side."""

RATE_SECONDS: Final = 2.0
"""Seconds over which the frame rate is averaged: long enough to read, short enough to be
current."""

TIMESTAMP: Final = struct.Struct("<d")
"""Header of a frame's JPEG: the time of capture, in seconds of the page's own clock."""

TRIGGER_SECONDS: Final = 1.0
"""Seconds between two checks of the language's trigger, which an edit may change."""

RecognizerSource = Callable[[], Recognizer | None]
"""Returns the recogniser to use now; None if only landmarks and takes are wanted."""


class Seen(BaseModel):
    """What was found in a frame.

    Attributes
    ----------
    time
        The frame's timestamp, as the page gave it.
    pose
        The body; None if the frame shows nobody.
    hands
        Up to two hands of 21 landmarks each (`HAND_LANDMARKS`), as `pose`.
    salute
        Score in [0, 1] of the best hand's salute, or of the language's other trigger.
    held
        Whether the trigger counts as held now.
    state
        Whether a salute is awaited, a take goes on, or the salute that ended it is still held.
    frames_per_second
        Recent rate of processed frames.
    seconds
        From the frame's arrival to this answer.
    skipped
        Number of frames skipped since the previous one because newer ones had arrived.

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
        Name of the language that was used; None if there was none.
    label, pair, nearest, confidence
        As in `app.recognition.Recognition`; None if nothing was recognised.
    voters, agreeing
        Number of votes that counted, and of those for `nearest`.
    problem
        Reason for a missing label, if it is not the movement itself.

    """

    kind: Literal["recognized"] = "recognized"
    start: float
    end: float
    closed: bool
    language: str | None = None
    label: str | None = None
    pair: tuple[str, str] | None = None
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
        Time of capture, in seconds of the page's clock.
    jpeg
        The picture.
    arrived
        Time of arrival, in seconds of `time.monotonic`.
    skipped
        Number of frames that arrived since the last processed one and were skipped.

    """

    time: float
    jpeg: bytes
    arrived: float
    skipped: int = 0

    @classmethod
    def parse(cls, message: bytes, skipped: int) -> Self:
        """Parse a message of the page: `TIMESTAMP`, then a JPEG.

        Raises
        ------
        VideoError
            When the message is too short, or the time is no number.

        """
        if len(message) <= TIMESTAMP.size:
            raise VideoError(f"a frame of {len(message)} bytes: send 8 bytes of time, then a JPEG")
        (time,) = TIMESTAMP.unpack_from(message)
        if not np.isfinite(time):
            raise VideoError(f"a frame's time is {time}: send seconds as a 64-bit float")
        return cls(time, message[TIMESTAMP.size :], clock.monotonic(), skipped)


class FramePipeline:
    """Processes the frames of one camera; its estimator tracks, so every connection needs its own.

    Parameters
    ----------
    estimator
        Finds the landmarks; closed by `close`.
    water
        Whether colour and contrast are corrected first.
    recognizer
        Called for the recogniser whenever a take ends, so that an edit of the language takes
        effect.

    """

    def __init__(
        self, estimator: PoseEstimator, water: WaterCorrection, recognizer: RecognizerSource
    ) -> None:
        self._estimator = estimator
        self._sight = WaterSight(estimator, water)
        self._people = PeopleInStream()
        self._recognizer = recognizer
        self._takes: LiveTakes | None = None
        self._trigger = SALUTE
        self._asked = -np.inf  # time of the last check of the trigger
        # Whose gestures are spotted, and what finds them.
        self._spotting: tuple[Recognizer, Spotter] | None = None
        self._time = -np.inf
        self._looks: deque[float] = deque()

    def look(self, frame: Frame) -> tuple[Seen | Recognized, ...]:
        """Process the next frame, and the take that it ends.

        A frame of another size, or from before the last one, comes from another camera: tracking
        and an open take are reset.

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
            self._people.reset()
            takes, self._spotting, self._asked = None, None, -np.inf
        trigger = self._find_trigger()
        if takes is None or takes.trigger != trigger:
            takes = self._takes = LiveTakes((width, height), trigger)
        self._time = frame.time
        self._people.by_salute = trigger.kind == "salute"
        followed = self._people.follow(frame.time, self._sight.estimate(image, frame.time))
        if followed.restarts:
            takes = self._takes = LiveTakes((width, height), trigger)
        for time, found in followed.frames:
            sight = takes.feed(time, found)
        seen = Seen(
            time=frame.time,
            pose=pose_in(found.body.xy, width, height) if found.body else None,
            hands=tuple(pose_in(hand.xy, width, height) for hand in found.hands),
            salute=round(sight.score, 3),
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
        """Count this frame, and return the number of frames processed per second."""
        now = clock.monotonic()
        self._looks.append(now)
        while now - self._looks[0] > RATE_SECONDS:
            self._looks.popleft()
        lasted = now - self._looks[0]
        return round((len(self._looks) - 1) / lasted, 2) if lasted > 0 else 0.0

    def _find_trigger(self) -> Trigger:
        """Return the trigger of the language in use; without a language, the salute."""
        if clock.monotonic() - self._asked > TRIGGER_SECONDS:
            self._asked = clock.monotonic()
            try:
                recognizer = self._recognizer()
                self._trigger = SALUTE if recognizer is None else recognizer.language.trigger
                known = None if self._spotting is None else self._spotting[0]
                if recognizer is not None and self._trigger.spots and recognizer is not known:
                    self._spotting = recognizer, Spotter(recognizer)
            except OsgError:  # no such language, or no gesture to spot in it
                self._trigger, self._spotting = SALUTE, None
        return self._trigger

    def _spot(self, moment: PoseSequence) -> tuple[Recognized, ...]:
        """Return the gestures that ended, without a trigger around them."""
        if self._spotting is None:
            return ()
        recognizer, spotter = self._spotting
        return tuple(
            _view_answer(recognizer, each.recognition, each.start, each.end, closed=True)
            for each in spotter.feed(moment)
        )

    def _recognize(self, sight: Sight) -> tuple[Recognized, ...]:
        if sight.take is None:
            return ()
        try:
            return (answer_of(sight.take, self._recognizer()),)
        except OsgError as error:
            return (_view_take(sight.take, str(error)),)


def answer_of(take: Take, recognizer: Recognizer | None) -> Recognized:
    """Recognise a take.

    Raises
    ------
    PoseError
        When the take shows nothing that could be compared.

    """
    if recognizer is None:
        return _view_take(take, "no language is chosen; choose one above")
    result = recognizer.recognize_take(take)
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
        pair=result.pair,
        nearest=result.nearest,
        confidence=round(result.confidence, 4),
        voters=len(votes),
        agreeing=votes.count(result.nearest),
        problem=result.fault,
    )


def _view_take(take: Take, problem: str) -> Recognized:
    return Recognized(start=take.start, end=take.end, closed=take.closed, problem=problem)


def decode_frame(jpeg: bytes) -> Image:
    """Return a JPEG as ``(height, width, 3)`` RGB.

    Raises
    ------
    VideoError
        When it is no JPEG, or has more than `MOST_PIXELS`; checked before memory is allocated.

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
