"""The domain core: from a clip's poses to a recognition that can be questioned.

What is listed here is the public surface. It needs no web framework, database or display; a
robot installs it alone.
"""

from app.recognition.decision.result import Recognition
from app.recognition.errors import (
    GestureError,
    LanguageError,
    ModelError,
    OsgError,
    PoseError,
    RecognitionError,
    VideoError,
)
from app.recognition.gestures.gesture import Gesture
from app.recognition.language.language import Language
from app.recognition.poses.sequence import PoseSequence
from app.recognition.recognizer import Recognizer
from app.recognition.recording.extraction import extract_poses, record
from app.recognition.recording.recording import Recording
from app.recognition.recording.segmentation import Take, find_takes, takes_in

__all__ = [
    "Gesture",
    "GestureError",
    "Language",
    "LanguageError",
    "ModelError",
    "OsgError",
    "PoseError",
    "PoseSequence",
    "Recognition",
    "RecognitionError",
    "Recognizer",
    "Recording",
    "Take",
    "VideoError",
    "extract_poses",
    "find_takes",
    "record",
    "takes_in",
]
