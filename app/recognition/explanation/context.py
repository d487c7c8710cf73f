"""Recognition context: recogniser and take, so that a recognition can be repeated with changes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal

from app.recognition.decision.fused_vote import FusedVote
from app.recognition.decision.result import Recognition, ScoreTable, Trace
from app.recognition.errors import OsgError
from app.recognition.explanation.demonstration_faults import DemonstrationFault
from app.recognition.explanation.strokes import Piece, transcribe, transcribe_gesture
from app.recognition.explanation.transcript import Transcript, compare_transcripts
from app.recognition.features.traversals import AS_SHOWN
from app.recognition.gestures.demonstration import MIN_FRAMES, condense
from app.recognition.gestures.gesture import Gesture
from app.recognition.gestures.profile import Tuning
from app.recognition.language.language import Language
from app.recognition.poses.sequence import PoseSequence
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.repair import Repair, repair_poses
from app.recognition.preprocessing.salience import find_salient_landmarks
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
    without
        Label and number of the demonstrations that the take is itself, which do not read it.

    """

    label: str
    query: Trajectory
    without: tuple[tuple[str, int], ...] = ()

    @cached_property
    def strokes(self) -> tuple[Piece, ...]:
        """The transcript of the take."""
        return transcribe(self.query, find_salient_landmarks(self.query))

    def after_leaving_out(self, left_out: tuple[str, int]) -> KnownTake:
        """Return the take in the language that lacks one more demonstration."""
        label, number = left_out
        moved = (
            (each, at - (each == label and at > number))
            for each, at in self.without
            if (each, at) != left_out
        )
        return replace(self, without=tuple(moved))


@dataclass(frozen=True, eq=False)
class KnownTakes:
    """Known takes, and how a recogniser reads them.

    Attributes
    ----------
    recognizer
        The recogniser.
    takes
        The takes.

    """

    recognizer: Recognizer
    takes: Sequence[KnownTake]

    @cached_property
    def readings(self) -> list[str | None]:
        """The label that each take is read as; None where it is not read as one gesture."""
        found: list[str | None] = []
        readers: dict[tuple[tuple[str, int], ...], Recognizer] = {(): self.recognizer}
        for take in self.takes:
            try:
                if (reader := readers.get(take.without)) is None:
                    reader = readers[take.without] = self.recognizer.without(take.without)
                found.append(reader.recognize_trajectory(take.query).label)
            except OsgError:
                found.append(None)
        return found

    def try_change(
        self, changed: Recognizer, left_out: tuple[str, int] | None = None
    ) -> tuple[list[int], list[int]]:
        """Return the indices of the takes that a change repairs, and of those that it breaks.

        Repaired takes are read right by the changed recogniser only, broken ones by this one only.

        Parameters
        ----------
        changed
            The recogniser after the change.
        left_out
            Label and number of the demonstration that the change leaves out, if it does.

        """
        takes = self.takes
        if left_out is not None:
            takes = [take.after_leaving_out(left_out) for take in takes]
        after = KnownTakes(changed, takes).readings
        rows = list(zip(self.takes, self.readings, after, strict=True))
        repaired = [at for at, (take, was, now) in enumerate(rows) if was != take.label == now]
        broken = [at for at, (take, was, now) in enumerate(rows) if was == take.label != now]
        return repaired, broken


@dataclass(frozen=True, eq=False)
class Cut:
    """A take without one of its strokes.

    Attributes
    ----------
    where
        At which end it is.
    stroke
        What is left out.
    poses
        The rest.

    """

    where: Literal["start", "end"]
    stroke: Piece
    poses: PoseSequence


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
    closed
        Whether the take has an end: one without is never offered as a demonstration.
    recorded
        The result as it was answered, which then stands for a new one; None: none was.

    """

    recognizer: Recognizer
    poses: PoseSequence
    whole: PoseSequence
    known: tuple[KnownTake, ...] = ()
    faults: Mapping[str, Sequence[tuple[DemonstrationFault, ...]]] = field(default_factory=dict)
    closed: bool = True
    recorded: Recognition | None = None

    @classmethod
    def of_take(cls, recognizer: Recognizer, take: Take) -> RecognitionContext:
        """Return the context of recognising a take."""
        return cls(
            recognizer=recognizer, poses=take.poses, whole=take.untrimmed, closed=take.closed
        )

    @property
    def language(self) -> Language:
        """The recogniser's language."""
        return self.recognizer.language

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
    def strokes(self) -> tuple[Piece, ...]:
        """The transcript of the take, whatever it is compared with; it follows repaired paths."""
        moved = condense(self.repair.trajectory)
        return transcribe(moved, find_salient_landmarks(moved), float(self.poses.time[0]))

    @cached_property
    def cuts(self) -> tuple[Cut, ...]:
        """The take without its first and without its last stroke, which may be a salute's way.

        A way is straight.
        """
        told = [each for each in self.strokes if each.kind != "pause"]
        if len({each.hand for each in told}) != 1 or len(told) < 3:
            return ()
        start, end = float(self.poses.time[0]), float(self.poses.time[-1])
        cuts = (
            Cut("start", told[0], self.poses.between(told[1].start, end)),
            Cut("end", told[-1], self.poses.between(start, told[-2].end)),
        )
        return tuple(
            cut for cut in cuts if cut.stroke.kind == "line" and len(cut.poses) >= MIN_FRAMES
        )

    @property
    def bridged(self) -> tuple[float, ...]:
        """The seconds of the frames in which a hand of `strokes` jumped, so that it is bridged."""
        hands = {each.hand for each in self.strokes} & {*self.poses.landmarks}
        columns = [self.poses.landmarks.index(hand) for hand in sorted(hands)]
        return tuple(self.poses.time[self.repair.jumps[:, columns].any(axis=1)].tolist())

    def compare_strokes(self, label: str) -> Transcript:
        """Compare the strokes of the take with those of a gesture's nearest demonstration."""
        table, at = self.score_table, self.language.labels.index(label)
        shown = table.find_shown_demonstration(self.language.gestures, at)
        traversal = table.traversals[at] or AS_SHOWN
        return compare_transcripts(self.strokes, transcribe_gesture(shown), traversal, self.bridged)

    @cached_property
    def repair(self) -> Repair:
        """The repaired poses of the take."""
        return repair_poses(self.poses)

    @cached_property
    def known_takes(self) -> KnownTakes:
        """The known takes, as the recogniser reads them."""
        return KnownTakes(self.recognizer, self.known)

    @cached_property
    def full_recognizer(self) -> Recognizer:
        """The recogniser of profile ``full``, by whose vote causes are sought."""
        if isinstance(self.recognizer.vote, FusedVote):
            return self.recognizer
        return Recognizer(self.language, "full")

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

    def with_tuning(self, tuning: Tuning) -> RecognitionContext:
        """Return the context with another tuning."""
        return self._with_language(self.language, tuning)

    def with_gesture(self, changed: Gesture) -> RecognitionContext:
        """Return the context with another gesture for the one of the same label."""
        return self._with_language(self.language.with_changed(changed), self.recognizer.tuning)

    def _with_language(self, language: Language, tuning: Tuning) -> RecognitionContext:
        recognizer = Recognizer(language, self.recognizer.profile, tuning=tuning)
        return replace(self, recognizer=recognizer, recorded=None)
