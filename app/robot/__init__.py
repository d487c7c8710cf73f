"""The robot's end: frames of a camera or clip go in, events come out.

It needs no web framework and no database. A `Runtime` joins three parts that can also be used
apart: a `Source` gives frames, a `PoseEstimator` finds the landmarks in them, a `Listener` turns
landmarks into takes and recognitions.
"""

from app.robot.active_language import SpokenLanguage
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
from app.robot.listeners.factory import hearing_of
from app.robot.listeners.phrase_listener import PhraseListener
from app.robot.listeners.salute_listener import Hearing, Listener
from app.robot.listeners.spotting_listener import SpottingListener
from app.robot.runtime import Runtime
from app.robot.sources.registry import open_source
from app.robot.sources.source import Frame, Notice, Quiet, Source

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
