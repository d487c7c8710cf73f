"""Gesture recognition: from a clip to a recognition, its explanation, and checks of a language.

The names in `__all__` are the public interface. The package needs no web framework, database or
display, so that a robot can install it alone.
"""

from app.recognition.decision.result import Recognition
from app.recognition.errors import (
    EstimatorError,
    GestureError,
    LanguageError,
    ModelError,
    OsgError,
    PoseError,
    RecognitionError,
    VideoError,
)
from app.recognition.estimation.factory import create_estimator
from app.recognition.explanation.context import RecognitionContext
from app.recognition.explanation.explanation import explain
from app.recognition.gestures.gesture import Gesture
from app.recognition.gestures.profile import Tuning
from app.recognition.health.check import check_health
from app.recognition.health.phrase_ambiguity import find_ambiguities
from app.recognition.language.language import Language
from app.recognition.phrases.parser import PhraseParser
from app.recognition.poses.sequence import PoseSequence
from app.recognition.recognizer import Recognizer
from app.recognition.recording.extraction import extract_poses, record
from app.recognition.recording.recording import Recording
from app.recognition.recording.segmentation import Take, find_takes, takes_in
from app.recognition.simulation.variation import draw_variants
from app.recognition.spotting import Spotter

__all__ = [
    "EstimatorError",
    "Gesture",
    "GestureError",
    "Language",
    "LanguageError",
    "ModelError",
    "OsgError",
    "PhraseParser",
    "PoseError",
    "PoseSequence",
    "Recognition",
    "RecognitionContext",
    "RecognitionError",
    "Recognizer",
    "Recording",
    "Spotter",
    "Take",
    "Tuning",
    "VideoError",
    "check_health",
    "create_estimator",
    "draw_variants",
    "explain",
    "extract_poses",
    "find_ambiguities",
    "find_takes",
    "record",
    "takes_in",
]
