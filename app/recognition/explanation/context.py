"""Recognition context: recogniser and take, so that a recognition can be repeated with changes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

from app.recognition.decision.result import Recognition
from app.recognition.decision.score_table import ScoreTable, Trace
from app.recognition.errors import OsgError
from app.recognition.explanation.demonstration_faults import DemonstrationFault
from app.recognition.gestures.gesture import Gesture
from app.recognition.gestures.tuning import Tuning
from app.recognition.language.language import Language
from app.recognition.poses.sequence import PoseSequence
from app.recognition.poses.trajectory import Trajectory
from app.recognition.recognizer import Recognizer
from app.recognition.recording.segmentation import Take


@dataclass(frozen=True, eq=False)
class KnownTake:
    """A take whose gesture is known: of a test set, of practice, or of a clip with a label.

    Attributes
    ----------
    label
        The gesture's.
    query
        The trajectory that the voters compare, see `Recognizer.query`.

    """

    label: str
    query: Trajectory


def read_all(recognizer: Recognizer, takes: Sequence[KnownTake]) -> list[str | None]:
    """Return the label that each take is read as; None where it is not read as one gesture."""
    found: list[str | None] = []
    for take in takes:
        try:
            found.append(recognizer.recognize_trajectory(take.query).label)
        except OsgError:
            found.append(None)
    return found


def count_effect(
    takes: Sequence[KnownTake], before: Sequence[str | None], after: Sequence[str | None]
) -> tuple[int, int]:
    """Return how many takes a change repairs and breaks: right with it only, and without only."""
    rows = list(zip(takes, before, after, strict=True))
    repaired = sum(was != take.label == now for take, was, now in rows)
    return repaired, sum(was == take.label != now for take, was, now in rows)


@dataclass(frozen=True, eq=False, kw_only=True)
class RecognitionContext:
    """Everything that a recognition depends on.

    Attributes
    ----------
    recognizer
        The recogniser, with language, profile and tuning.
    poses
        The stroke to recognise.
    whole
        The poses that the stroke was cut out of, for other cuts.
    known
        Other takes whose gesture is known, by which remedies are judged.
    faults
        By label the known faults of each of the gesture's demonstrations.
    recorded
        The result as it was answered, which then stands for a new one; None: none was.

    """

    recognizer: Recognizer
    poses: PoseSequence
    whole: PoseSequence
    known: tuple[KnownTake, ...] = ()
    faults: Mapping[str, Sequence[tuple[DemonstrationFault, ...]]] = field(default_factory=dict)
    recorded: Recognition | None = None

    @classmethod
    def of_take(cls, recognizer: Recognizer, take: Take) -> RecognitionContext:
        """Return the context of recognising a take."""
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
        """The trace of the recognition, computed once.

        Raises
        ------
        PoseError
            When no landmark that a gesture needs moves in the stroke.

        """
        return self.recognizer.examine(self.poses)

    @cached_property
    def readings(self) -> list[str | None]:
        """What each of the known takes is read as."""
        return read_all(self.recognizer, self.known)

    @property
    def trajectory(self) -> Trajectory:
        """The trajectory that the voters compare."""
        return self.trace.query

    @property
    def score_table(self) -> ScoreTable:
        """The stroke's distances to every gesture."""
        return self.trace.score_table

    @property
    def result(self) -> Recognition:
        """The recognition, as it was answered if it was."""
        return self.trace.result if self.recorded is None else self.recorded

    def with_poses(self, poses: PoseSequence) -> RecognitionContext:
        """Return the context with another stroke."""
        return replace(self, poses=poses, recorded=None)

    def _with_recognizer(self, recognizer: Recognizer) -> RecognitionContext:
        return replace(self, recognizer=recognizer, recorded=None)

    def with_tuning(self, tuning: Tuning) -> RecognitionContext:
        """Return the context with another tuning."""
        return self._with_recognizer(Recognizer(self.language, self.profile, tuning=tuning))

    def with_gesture(self, changed: Gesture) -> RecognitionContext:
        """Return the context with another gesture for the one of the same label."""
        gestures = [
            changed if gesture.label == changed.label else gesture
            for gesture in self.language.gestures
        ]
        language = replace(self.language, gestures=gestures)
        return self._with_recognizer(Recognizer(language, self.profile, tuning=self.tuning))
