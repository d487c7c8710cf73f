"""Gesture spotting: recognises gestures in a continuous stream of poses, without salutes.

People move in strokes with a bell-shaped speed (Flash and Hogan 1985), so gestures begin and end at
minima of the hands' speed. Every stretch between two minima that is about as long as a gesture is
recognised; of overlapping stretches the best is kept, and reported once the hands pause.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np

from app.recognition.decision.outcome import estimate_confidence
from app.recognition.decision.result import Recognition
from app.recognition.errors import OsgError, PoseError
from app.recognition.features.motion import find_followed_landmarks
from app.recognition.gestures.gesture import Gesture
from app.recognition.gestures.profile import PROFILES
from app.recognition.poses.landmarks import other_side
from app.recognition.poses.sequence import PoseSequence, join_sequences
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.outliers import measure_body_unit
from app.recognition.preprocessing.salience import MIN_DISPLACEMENT, measure_displacements
from app.recognition.recognizer import Recognizer
from app.recognition.recording.recording import find_unseen
from app.recognition.recording.trimming import GRID_STEP, Motion, Span, measure_motion, split_pieces
from app.recognition.triggers.trigger import NO_TRIGGER, Trigger

CONFIDENT = 0.8
"""Least confidence of a spotted gesture; below, another gesture is about as near."""

FAMILIAR = 0.93
"""Least confidence that a stretch is this gesture rather than none.

Confidence is calibrated for takes of which half are gestures; few stretches of a stream are
(`benchmarks/studies/spotting.md`)."""

FASTER, SLOWER = 0.4, 2.2
"""Shortest and longest duration of a gesture relative to its demonstration: two people's takes
differ by half a doubling, rarely by more than one."""

LOOK_EVERY = 0.2
"""Seconds between two searches for strokes: a tenth of a gesture, a few frames of a camera."""

SLOW_EDGE = 0.2
"""Seconds at either end of a stroke in which the hand hardly moves."""

SETTLED = 0.25
"""Seconds after which a stroke's end is certain: its slow edge and the smoothing's look-ahead."""

PAUSE = 0.6
"""Seconds without a stroke after which a gesture is reported. A hand slows down at a corner for up
to 0.4 s, and one side of a square alone would be a line."""

MOST_STROKES = 8
"""Strokes that a gesture may consist of, at most; a square has four, a hesitant eight six."""

MOST_WAITING = 64
"""Longest queue of stretches to recognise; the oldest are dropped first."""

LONGEST_MEMORY = 20.0
"""Most seconds of the stream that are kept, and longest gesture."""

RANK_PER_SECOND = 2.0
"""Gain in rank, in log-odds, per second of a stretch's duration."""

LONGEST_BETWEEN = 60.0
"""Most seconds from the start trigger gesture to the end of the stop one, as for takes."""

BEAT = 1e-6
"""Tolerance in seconds when times are compared."""


@dataclass(frozen=True)
class Spotted:
    """A gesture found in a stream.

    Attributes
    ----------
    start, end
        Seconds in the stream's clock.
    recognition
        The recogniser's result for that stretch.

    """

    start: float
    end: float
    recognition: Recognition

    @property
    def rank(self) -> float:
        """Rank among overlapping gestures: log-odds of the confidence, plus a gain per second.

        The gain prefers a square to its sides, each of which is a line.
        """
        sure = min(max(self.recognition.confidence, 1e-6), 1 - 1e-6)
        return float(np.log(sure / (1 - sure))) + RANK_PER_SECOND * (self.end - self.start)

    def overlaps(self, start: float, end: float) -> bool:
        """Return whether it overlaps a stretch by more than a slow edge."""
        return self.start < end - SLOW_EDGE and start < self.end - SLOW_EDGE


class TriggerGate:
    """Lets through the spotted gestures that lie between two trigger gestures.

    Parameters
    ----------
    trigger
        The trigger, of kind ``gesture``; with any other kind all gestures pass.

    """

    def __init__(self, trigger: Trigger) -> None:
        self._trigger = trigger
        self._opened: float | None = None  # when the gesture that begins ended
        self._between: list[Spotted] = []

    def admit(self, found: tuple[Spotted, ...]) -> tuple[Spotted, ...]:
        """Process gestures as they are spotted; return those that a stop gesture confirms now."""
        if self._trigger.kind != "gesture":
            return found
        confirmed: list[Spotted] = []
        for each in found:
            label = each.recognition.label
            if self._opened is not None and each.end - self._opened > LONGEST_BETWEEN:
                self._opened = None
            if self._opened is not None and label == self._trigger.stop_label:
                confirmed += self._between
                self._opened, self._between = None, []
            elif label == self._trigger.start_label:
                self._opened, self._between = each.end, []
            elif self._opened is not None:
                self._between.append(each)
        return tuple(confirmed)


class Spotter:
    """Spots gestures in a stream of poses, with bounded memory and bounded work per frame.

    Parameters
    ----------
    recognizer
        A recogniser of profile ``full``. Where the trigger of its language is a gesture, only
        gestures between two trigger gestures are reported, once the second is seen.
    confident
        Least confidence of a reported gesture.
    triggered
        False: the language's trigger is ignored.

    Raises
    ------
    OsgError
        When the profile does not reject, so that every movement would be a gesture, or when no
        gesture of the language has a demonstration, or all of them are held hand shapes.

    """

    def __init__(
        self, recognizer: Recognizer, *, confident: float = CONFIDENT, triggered: bool = True
    ) -> None:
        if not PROFILES[recognizer.profile].rejects:
            raise OsgError(
                f"profile {recognizer.profile!r} rejects nothing, so every movement would be a "
                f"gesture; use profile full to recognise without salutes"
            )
        gestures = [each for each in recognizer.language.gestures if not each.is_held]
        if not gestures:
            raise OsgError(
                f"language {recognizer.language.name!r} has only held hand shapes, which are found "
                f"between salutes alone; add a gesture that moves, or show signs between salutes"
            )
        lasts = [last for each in gestures for last in _durations(each)]
        if not lasts:
            raise OsgError(
                f"language {recognizer.language.name!r} has only images and no demonstrations, so "
                f"the duration of its gestures is unknown; define one from a clip"
            )
        self._recognizer = recognizer
        self._confident = confident
        self._triggered = triggered
        self._gate = TriggerGate(recognizer.language.trigger if triggered else NO_TRIGGER)
        single = [each for gesture in gestures for each in gesture.single_demonstrations()]
        mirrored = [
            [other_side(name) for name in gesture.salient]
            for gesture in single
            if gesture.switches.mirror == "on"
        ]
        shown = [gesture.salient for gesture in single]
        self._landmarks = find_followed_landmarks([*shown, *mirrored])
        self._shortest = FASTER * float(min(lasts))
        self._longest = min(SLOWER * float(max(lasts)), LONGEST_MEMORY)
        self._seen: deque[PoseSequence] = deque()
        self._looked = -np.inf
        self._believed = -np.inf  # the end of the last stroke whose stretches were queued
        self._reported = -np.inf  # the end of the last gesture reported
        self._moving = -np.inf  # when the last stroke was seen
        self._waiting: deque[Span] = deque(maxlen=MOST_WAITING)
        self._candidates: list[Spotted] = []

    def __len__(self) -> int:
        """Return the number of frames kept."""
        return sum(len(moment) for moment in self._seen)

    def feed(self, moment: PoseSequence) -> tuple[Spotted, ...]:
        """Process the next frame, or a few.

        At most one stretch is recognised in a call.

        Parameters
        ----------
        moment
            Later than everything before, with the same landmarks.

        Returns
        -------
        The gestures that ended and cannot be replaced any more; mostly none.

        Raises
        ------
        PoseError
            When the time does not increase, or the landmarks change.

        """
        if not len(moment):
            return ()
        now = float(moment.time[-1])
        if self._seen and moment.time[0] <= self._seen[-1].time[-1]:
            raise PoseError(
                f"a stream's time must increase: got {moment.time[0]:g} s after "
                f"{self._seen[-1].time[-1]:g} s"
            )
        if self._seen and moment.landmarks != self._seen[-1].landmarks:
            raise PoseError(
                f"a stream must keep its {len(self._seen[-1].landmarks)} landmarks, got "
                f"{len(moment.landmarks)} others; create a new Spotter for another camera"
            )
        self._seen.append(moment)
        while now - self._seen[0].time[-1] > self._longest + PAUSE + 2 * LOOK_EVERY:
            self._seen.popleft()
        if now - self._looked >= LOOK_EVERY - BEAT:
            self._looked = now
            self._look(now)
        self._recognize_one()
        return self._gate.admit(self._take_final(now))

    def listen(self, poses: PoseSequence) -> tuple[Spotted, ...]:
        """Process a whole pose sequence frame by frame, as a robot does, and end the stream."""
        found: list[Spotted] = []
        for moment in poses.time.tolist():
            found += self.feed(poses.between(moment, moment))
        return (*found, *self.finish())

    def for_stream(self) -> Spotter:
        """Return a spotter of the same gestures for another stream, whose time begins anew."""
        return Spotter(self._recognizer, confident=self._confident, triggered=self._triggered)

    def for_language(self, recognizer: Recognizer) -> Spotter:
        """Return a spotter of another language that continues this stream.

        It keeps the frames and the time of the last report; pending gestures of this language
        are dropped.

        Raises
        ------
        OsgError
            As for a new one.

        """
        other = Spotter(recognizer, confident=self._confident, triggered=self._triggered)
        other._seen.extend(self._seen)
        other._looked, other._moving = self._looked, self._moving
        # Only stretches that end from now on are queued: old movements are not reported again.
        other._believed, other._reported = self._believed, self._reported
        return other

    def finish(self) -> tuple[Spotted, ...]:
        """End the stream and return the gestures still pending."""
        if self._seen:
            self._look(np.inf)
        while self._waiting:
            self._recognize_one()
        return self._gate.admit(self._take_final(np.inf))

    def _look(self, now: float) -> None:
        """Find strokes in the kept frames, and queue the stretches that end with a new one."""
        motion = self._motion()
        if motion is None:
            return
        strokes = strokes_in(motion)
        if strokes:
            self._moving = strokes[-1].end
        for index, last in enumerate(strokes):
            if last.end <= self._believed + SETTLED or last.end > now - SETTLED:
                continue
            self._believed = last.end
            for first in strokes[max(0, index + 1 - MOST_STROKES) : index + 1]:
                is_free = first.start >= self._reported - SLOW_EDGE
                if is_free and self._shortest <= last.end - first.start <= self._longest:
                    self._waiting.append(Span(first.start, last.end))

    def _motion(self) -> Motion | None:
        """Measure the motion of the language's landmarks in the kept frames."""
        poses = join_sequences(self._seen)
        names = [name for name in self._landmarks if name in poses.landmarks]
        count = int(np.ceil(poses.duration / GRID_STEP)) + 1
        if count < 3 or not names or not poses.select(names).seen.any():
            return None
        trajectory = Trajectory.from_poses(poses)
        even = trajectory.select(names).fill_gaps().resample_in_time(count)
        paths = np.moveaxis(even.xy / measure_body_unit(trajectory), 1, 0)
        shown = [path for path in paths if np.isfinite(path).any()]
        return measure_motion(shown, even.time + poses.time[0])

    def _recognize_one(self) -> None:
        """Recognise the stretch that has waited longest."""
        while self._waiting:
            span = self._waiting.popleft()
            poses = join_sequences(self._seen).between(span.start - BEAT, span.end + BEAT)
            if span.start < self._reported - SLOW_EDGE or len(poses) < 2:
                continue
            try:
                unseen = find_unseen(poses.time.tolist(), span.start, span.end)
                result = self._recognizer.recognize(poses, unseen)
            except PoseError:
                return
            spotted = Spotted(span.start, span.end, result)
            if self._is_gesture(spotted):
                self._candidates.append(spotted)
            return

    def _is_gesture(self, spotted: Spotted) -> bool:
        """Return whether a stretch is a gesture by its confidence, extent and duration."""
        result = spotted.recognition
        if result.label is None or result.confidence < self._confident:
            return False
        gesture = self._recognizer.language.gesture(result.label)
        usual = _durations(gesture)
        if not usual or _familiarity(result) < FAMILIAR:
            return False
        if not FASTER * min(usual) <= spotted.end - spotted.start <= SLOWER * max(usual):
            return False
        trajectory = Trajectory.from_poses(join_sequences(self._seen))
        part = trajectory.between(
            spotted.start - self._seen[0].time[0], spotted.end - self._seen[0].time[0]
        )
        moved = measure_displacements(part)
        most = max(moved.get(name, 0.0) for name in self._landmarks)
        return most >= MIN_DISPLACEMENT * measure_body_unit(trajectory)

    def _take_final(self, now: float) -> tuple[Spotted, ...]:
        """Return the best candidates that no later one can replace."""
        found: list[Spotted] = []
        while self._candidates:
            best = max(self._candidates, key=lambda each: each.rank)
            resting = now - max(self._moving, best.end) > PAUSE
            late = now - best.end > self._longest / SLOWER
            if (self._waiting and not late) or not (resting or late):
                break
            found.append(best)
            self._reported = max(self._reported, best.end)
            self._candidates = [
                each for each in self._candidates if not each.overlaps(best.start, best.end)
            ]
        return tuple(found)


def strokes_in(motion: Motion) -> list[Span]:
    """Return the strokes of a motion in order, including their slow edges."""
    pieces = split_pieces(motion)
    firsts = np.array([motion.time[piece.first] for piece in pieces])
    lasts = np.array([motion.time[piece.last] for piece in pieces])
    halves = np.concatenate([motion.time[:1], (firsts[1:] + lasts[:-1]) / 2, motion.time[-1:]])
    return [
        Span(float(max(first - SLOW_EDGE, before)), float(min(last + SLOW_EDGE, after)))
        for first, last, before, after in zip(firsts, lasts, halves, halves[1:], strict=False)
    ]


def _durations(gesture: Gesture) -> list[float]:
    """Return the seconds of a gesture's demonstrations; none of imported images."""
    shown = (each.trajectory for each in gesture.single_demonstrations())
    return [float(each.time[-1]) for each in shown if each is not None]


def _familiarity(result: Recognition) -> float:
    """Return the confidence that the nearest gesture was shown rather than none."""
    at = result.gestures.index(result.nearest)
    return estimate_confidence(float(result.novelty[at]), float(result.scores[at]), np.inf)
