"""Robot runtime: turns frames of a camera or clip into events.

It needs no web framework and no database. A `Runtime` joins three parts that also work alone: a
`Source` yields frames, a `PoseEstimator` finds the landmarks in them, and a `Listener` turns
landmarks into takes and recognitions.
"""

from app.robot.active_language import ActiveLanguage
from app.robot.events import (
    AnswerGiven,
    Event,
    FrameRateChanged,
    FramesDropped,
    Heartbeat,
    LanguageChanged,
    LanguageRefused,
    OutputFailed,
    PhraseHeard,
    RecognitionReady,
    SourceEnded,
    SourceLost,
    SourceOpened,
    SourceRestored,
    SourceWarned,
    StateChanged,
    TakeRecognized,
    TakeRejected,
    VehicleReported,
)
from app.robot.listeners.language_listener import PhraseListener, SpottingListener, create_listener
from app.robot.listeners.trigger_listener import LandmarkListener, TriggerListener
from app.robot.runtime import Runtime
from app.robot.sources.registry import open_source
from app.robot.sources.source import Frame, NoFrame, Notice, Source

__all__ = [
    "ActiveLanguage",
    "AnswerGiven",
    "Event",
    "Frame",
    "FrameRateChanged",
    "FramesDropped",
    "Heartbeat",
    "LandmarkListener",
    "LanguageChanged",
    "LanguageRefused",
    "NoFrame",
    "Notice",
    "OutputFailed",
    "PhraseHeard",
    "PhraseListener",
    "RecognitionReady",
    "Runtime",
    "Source",
    "SourceEnded",
    "SourceLost",
    "SourceOpened",
    "SourceRestored",
    "SourceWarned",
    "SpottingListener",
    "StateChanged",
    "TakeRecognized",
    "TakeRejected",
    "TriggerListener",
    "VehicleReported",
    "create_listener",
    "open_source",
]
