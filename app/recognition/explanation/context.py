"""A context: all that a recognition depends on, so that it can be repeated with a change."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

from app.recognition.decision.result import Recognition
from app.recognition.decision.score_table import ScoreTable
from app.recognition.decision.trace import Trace
from app.recognition.gestures.gesture import Gesture
from app.recognition.gestures.tuning import Tuning
from app.recognition.language.language import Language
from app.recognition.poses.sequence import PoseSequence
from app.recognition.poses.trajectory import Trajectory
from app.recognition.recognizer import Recognizer
from app.recognition.recording.segmentation import Take


@dataclass(frozen=True, eq=False, kw_only=True)
class RecognitionContext:
    """A recogniser and a stroke.

    Attributes
    ----------
    recognizer
        For a language, with a profile and a tuning.
    poses
        The stroke that is recognised.
    whole
        What the stroke was cut out of, so that it may be cut otherwise.

    """

    recognizer: Recognizer
    poses: PoseSequence
    whole: PoseSequence

    @classmethod
    def of_take(cls, recognizer: Recognizer, take: Take) -> RecognitionContext:
        """Return the context in which a take is recognised."""
        return cls(recognizer=recognizer, poses=take.poses, whole=take.untrimmed)

    @property
    def language(self) -> Language:
        """The recogniser's language."""
        return self.recognizer.language

    @property
    def profile(self) -> str:
        """The recogniser's profile."""
        return self.recognizer.profile

    @property
    def tuning(self) -> Tuning:
        """The recogniser's tuning."""
        return self.recognizer.tuning

    @cached_property
    def trace(self) -> Trace:
        """What is seen, compared and decided.

        Raises
        ------
        PoseError
            When the stroke shows nothing that a gesture needs.

        """
        return self.recognizer.examine(self.poses)

    @property
    def trajectory(self) -> Trajectory:
        """The stroke as the voters see it."""
        return self.trace.query

    @property
    def score_table(self) -> ScoreTable:
        """The stroke beside every gesture."""
        return self.trace.score_table

    @property
    def result(self) -> Recognition:
        """What is recognised."""
        return self.trace.result

    def with_tuning(self, tuning: Tuning) -> RecognitionContext:
        """Tune the recogniser otherwise."""
        return replace(self, recognizer=Recognizer(self.language, self.profile, tuning=tuning))

    def with_profile(self, profile: str) -> RecognitionContext:
        """Use other voters; weights, which are for voters of a profile, are dropped."""
        tuning = replace(self.tuning, weights={})
        return replace(self, recognizer=Recognizer(self.language, profile, tuning=tuning))

    def with_gesture(self, changed: Gesture) -> RecognitionContext:
        """Put a gesture in the place of the one with its label."""
        gestures = [
            changed if gesture.label == changed.label else gesture
            for gesture in self.language.gestures
        ]
        language = replace(self.language, gestures=gestures)
        recognizer = Recognizer(language, self.profile, tuning=self.tuning)
        return replace(self, recognizer=recognizer)
