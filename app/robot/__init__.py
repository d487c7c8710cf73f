"""The robot's end: frames of a camera or clip go in, events come out.

It needs no web framework and no database. A `Runtime` joins three parts that can also be used
apart: a `Source` gives frames, a `PoseEstimator` finds the landmarks in them, a `Listener` turns
landmarks into takes and recognitions.
"""

from app.robot.events import (
    Event,
    FramesDropped,
    LanguageChanged,
    LanguageRefused,
    PhraseHeard,
    SourceEnded,
    SourceLost,
    SourceOpened,
    SourceRestored,
    SourceWarned,
    StateChanged,
    TakeRecognized,
    TakeRejected,
)
from app.robot.hearing import hearing_of
from app.robot.listener import Hearing, Listener
from app.robot.opening import open_source
from app.robot.phrase_listener import PhraseListener
from app.robot.runtime import Runtime
from app.robot.source import Frame, Notice, Quiet, Source
from app.robot.spoken_language import SpokenLanguage
from app.robot.spotting_listener import SpottingListener

__all__ = [
    "Event",
    "Frame",
    "FramesDropped",
    "Hearing",
    "LanguageChanged",
    "LanguageRefused",
    "Listener",
    "Notice",
    "PhraseHeard",
    "PhraseListener",
    "Quiet",
    "Runtime",
    "Source",
    "SourceEnded",
    "SourceLost",
    "SourceOpened",
    "SourceRestored",
    "SourceWarned",
    "SpokenLanguage",
    "SpottingListener",
    "StateChanged",
    "TakeRecognized",
    "TakeRejected",
    "hearing_of",
    "open_source",
]
