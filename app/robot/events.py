"""What a robot's runtime tells: one frozen record per thing that happened, in the order it did.

Every `time` is in seconds of the source's clock: of the frame after which it was known.
"""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import Any

from app.recognition import Recognition
from app.recognition.phrases.parser import PhraseEvent
from app.recognition.recording.segmentation import TakeState


@dataclass(frozen=True)
class SourceOpened:
    """Frames are about to be looked at.

    Attributes
    ----------
    time
        0.
    source
        Its name, without passwords.
    live
        Whether frames may be dropped.
    frame_size
        Width and height in pixels.
    began
        When the source's clock was 0, in UTC; None for a recording, whose past nobody knows.

    """

    time: float
    source: str
    live: bool
    frame_size: tuple[int, int]
    began: datetime | None


@dataclass(frozen=True)
class SourceWarned:
    """Something is wrong with the source that does not stop it, such as a damaged clip.

    Attributes
    ----------
    time
        Seconds.
    reason
        One sentence for a person.

    """

    time: float
    reason: str


@dataclass(frozen=True)
class SourceLost:
    """A camera gives no frames any more; it is being opened again and again.

    Attributes
    ----------
    time
        Seconds.
    reason
        One sentence for a person.

    """

    time: float
    reason: str


@dataclass(frozen=True)
class SourceRestored:
    """A lost camera gives frames again.

    Attributes
    ----------
    time
        Seconds.
    missing
        Seconds without a frame.
    attempts
        How often opening was tried.

    """

    time: float
    missing: float
    attempts: int


@dataclass(frozen=True)
class SourceEnded:
    """No more frames are looked at: a recording is over, or the runtime was stopped.

    Attributes
    ----------
    time
        Seconds.
    frames
        Frames looked at.
    dropped
        Frames left out because newer ones had come.
    stopped
        Whether somebody stopped it before the source was over.

    """

    time: float
    frames: int
    dropped: int
    stopped: bool


@dataclass(frozen=True)
class FramesDropped:
    """The camera is faster than this machine; told at most every `REPORT_SECONDS`.

    Attributes
    ----------
    time
        Seconds.
    seconds
        Since when is counted.
    dropped, frames
        Frames left out and frames looked at in this time.

    """

    time: float
    seconds: float
    dropped: int
    frames: int


@dataclass(frozen=True)
class StateChanged:
    """Another state of the salutes.

    Attributes
    ----------
    time
        Seconds.
    state
        ``idle``: waits for a salute, or without salutes for a gesture; ``recording``: a salute
        began a take; ``done``: the salute that ended it is still held.

    """

    time: float
    state: TakeState


@dataclass(frozen=True)
class LanguageChanged:
    """From now on takes are recognised by this language.

    Attributes
    ----------
    time
        Seconds.
    name
        The language's name.
    sha256, revision
        Its id and revision, see `SpokenLanguage`.
    gestures
        Its labels.
    profile
        The voters that recognise it.
    tuning
        How that deviates from the profile, in words that follow "recognised".

    """

    time: float
    name: str
    sha256: str
    revision: int
    gestures: tuple[str, ...]
    profile: str
    tuning: str


@dataclass(frozen=True)
class LanguageRefused:
    """A new language file cannot be used; the language before it is kept.

    Attributes
    ----------
    time
        Seconds.
    reason
        One sentence for a person.
    sha256, revision
        Of the language that is kept.

    """

    time: float
    reason: str
    sha256: str
    revision: int


@dataclass(frozen=True, kw_only=True, eq=False)
class TakeRecognized:
    """A gesture was shown.

    Attributes
    ----------
    time
        Seconds: when it was known.
    start, end
        Seconds between which it was shown, as ``osg-studio recognize`` tells them.
    closed
        Always true: a stop salute ended it, or it was spotted without salutes.
    label
        The gesture.
    confidence
        In [0, 1], see `Recognition`.
    margin
        How much nearer it is than every other gesture, see `Recognition.margin`.
    command
        What the language's author wants the robot to do; words or an object, None: nothing said.
    sha256, revision
        The language that it was recognised by.
    recognition
        All that the recogniser answered.

    """

    time: float
    start: float
    end: float
    closed: bool
    label: str
    confidence: float
    margin: float
    command: str | dict[str, Any] | None
    sha256: str
    revision: int
    recognition: Recognition

    @property
    def nearest(self) -> str:
        """The label again: what is recognised is nearest."""
        return self.recognition.nearest


@dataclass(frozen=True, kw_only=True, eq=False)
class TakeRejected:
    """Something was shown that the robot must not act on.

    Attributes
    ----------
    time
        Seconds: when it was known.
    start, end
        Seconds of the take.
    closed
        Whether a stop salute ended it.
    reason
        One sentence for a person.
    nearest, confidence, margin
        The gesture that comes nearest, as in `TakeRecognized`; None where none was looked for.
    sha256, revision
        The language that was asked.
    recognition
        All that the recogniser answered; None where it was not asked or could not answer.

    """

    time: float
    start: float
    end: float
    closed: bool
    reason: str
    sha256: str
    revision: int
    recognition: Recognition | None = None

    @property
    def nearest(self) -> str | None:
        """The gesture that comes nearest."""
        return self.recognition.nearest if self.recognition else None

    @property
    def confidence(self) -> float | None:
        """In [0, 1], of `nearest`."""
        return self.recognition.confidence if self.recognition else None

    @property
    def margin(self) -> float | None:
        """How much nearer `nearest` is than every other gesture."""
        return self.recognition.margin if self.recognition else None


@dataclass(frozen=True)
class PhraseHeard:
    """What came of a gesture, or of a pause, in a language with phrases.

    Attributes
    ----------
    time
        Seconds: when it was known.
    phrase
        What the grammar makes of it; has a mission where the robot should do something.
    confidence
        In [0, 1]: of the message's gesture that is least sure; 0 where none was recognised.
    sha256, revision
        The language.

    """

    time: float
    phrase: PhraseEvent
    confidence: float
    sha256: str
    revision: int


Event = (
    SourceOpened
    | SourceWarned
    | SourceLost
    | SourceRestored
    | SourceEnded
    | FramesDropped
    | StateChanged
    | LanguageChanged
    | LanguageRefused
    | TakeRecognized
    | TakeRejected
    | PhraseHeard
)
