"""Spotting: gestures found in a continuous stream, without salutes around them.

A robot that waits for no trigger has to find out where a gesture begins and ends. People move in
strokes with a bell-shaped speed (Flash and Hogan 1985), so a gesture begins and ends at minima of
the hands' speed. Every stretch between two of them that may be as long as a gesture is put to the
recogniser; of those that overlap the best one is kept, and reported once the hands have paused.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np

from app.recognition.decision.rejection import estimate_confidence
from app.recognition.decision.result import Recognition
from app.recognition.errors import OsgError, PoseError
from app.recognition.features.motion import find_followed_landmarks
from app.recognition.gestures.profile import PROFILES
from app.recognition.poses.landmarks import other_side
from app.recognition.poses.sequence import PoseSequence, join_sequences
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.outliers import measure_body_unit
from app.recognition.preprocessing.salience import MIN_DISPLACEMENT, measure_displacements
from app.recognition.recognizer import Recognizer
from app.recognition.recording.trimming import GRID_STEP, Motion, Span, measure_motion, split_pieces

CONFIDENT = 0.8
"""Least confidence of a spotted gesture: below, another one of the language is about as near."""

FAMILIAR = 0.97
"""Least confidence that a stretch is this gesture rather than none, whatever else is near.
Confidence is calibrated for takes of which half mean something; of the stretches of a stream almost
none do. Somebody who points into the distance draws a *line* at 0.96."""

ASKED = ("figure", "posture", "length")
"""Views that tell a gesture from what is none. How the wrist is bent tells two signs of one arm
apart; people bend it as they like where it means nothing, so a gesture is not doubted for it."""

FASTER, SLOWER = 0.4, 2.2
"""How much shorter or longer than its demonstration a gesture may take: two people's takes differ
by half a doubling, rarely by more than one."""

LOOK_EVERY = 0.2
"""Seconds between two looks for strokes: a tenth of a gesture, a few frames of a camera."""

SLOW_EDGE = 0.2
"""Seconds at either end of a stroke in which the hand hardly moves yet, or any more."""

SETTLED = 0.25
"""Seconds after which a stroke's end is believed: its slow edge, and what smoothing looks ahead."""

PAUSE = 0.6
"""Seconds without a stroke after which a gesture is reported: a hand that turns a corner is
slower than a stroke for up to 0.4 s, and a side of a square is a good line."""

MOST_STROKES = 8
"""Strokes that a gesture may consist of, at most; a square has four, a hesitant eight six."""

MOST_WAITING = 64
"""Stretches that may wait to be recognised; the oldest are forgotten first."""

LONGEST_MEMORY = 20.0
"""Seconds kept at most, whatever the demonstrations: what takes longer is no gesture."""

RANK_PER_SECOND = 2.0
"""Logarithm of odds that one second more explained is worth."""

BEAT = 1e-6
"""Seconds that make no difference between two moments."""


@dataclass(frozen=True)
class Spotted:
    """A gesture found in a stream.

    Attributes
    ----------
    start, end
        Seconds in the stream's clock between which it was shown.
    recognition
        What the recogniser says of that stretch.

    """

    start: float
    end: float
    recognition: Recognition

    @property
    def rank(self) -> float:
        """What decides between two that overlap: the odds of being right, and how much it explains.

        A side of a square is a good line; the square is preferred since it leaves less unexplained.
        """
        sure = min(max(self.recognition.confidence, 1e-6), 1 - 1e-6)
        return float(np.log(sure / (1 - sure))) + RANK_PER_SECOND * (self.end - self.start)

    def overlaps(self, start: float, end: float) -> bool:
        """Tell whether it shares more with a stretch than a slow edge."""
        return self.start < end - SLOW_EDGE and start < self.end - SLOW_EDGE


class Spotter:
    """Listens to a stream of poses; one recogniser, bounded memory and bounded work a frame.

    Parameters
    ----------
    recognizer
        Of profile ``full``.
    confident
        Least confidence of what is reported.

    Raises
    ------
    OsgError
        When the profile is another one, whose confidence tells nothing about movements that mean
        nothing, or when no gesture of the language has a demonstration.

    """

    def __init__(self, recognizer: Recognizer, *, confident: float = CONFIDENT) -> None:
        if not PROFILES[recognizer.profile].rejects:
            raise OsgError(
                f"profile {recognizer.profile!r} names every movement, also those that mean "
                f"nothing; listen without salutes by profile full"
            )
        gestures = recognizer.language.gestures
        lasts = [each.trajectory.time[-1] for each in gestures if each.trajectory is not None]
        if not lasts:
            raise OsgError(
                f"language {recognizer.language.name!r} has only images and no demonstrations, so "
                f"nobody knows how long its gestures take: define one from a clip"
            )
        self._recognizer = recognizer
        self._confident = confident
        mirrored = [
            [other_side(name) for name in gesture.salient]
            for gesture in gestures
            if gesture.switches.mirror == "on"
        ]
        shown = [gesture.salient for gesture in gestures]
        self._landmarks = find_followed_landmarks([*shown, *mirrored])
        self._shortest = FASTER * float(min(lasts))
        self._longest = min(SLOWER * float(max(lasts)), LONGEST_MEMORY)
        self._seen: deque[PoseSequence] = deque()
        self._looked = -np.inf
        self._believed = -np.inf  # the end of the last stroke whose stretches were taken up
        self._reported = -np.inf  # the end of the last gesture reported
        self._moving = -np.inf  # when the last stroke was seen
        self._waiting: deque[Span] = deque(maxlen=MOST_WAITING)
        self._candidates: list[Spotted] = []

    def __len__(self) -> int:
        """Count the frames that are remembered."""
        return sum(len(moment) for moment in self._seen)

    def feed(self, moment: PoseSequence) -> tuple[Spotted, ...]:
        """Take the next frame, or a few.

        At most one stretch is recognised in a call.

        Parameters
        ----------
        moment
            Later than everything before, with the same landmarks.

        Returns
        -------
        The gestures that are now certain to have ended, mostly none.

        Raises
        ------
        PoseError
            When the time does not go on, or the landmarks are others.

        """
        if not len(moment):
            return ()
        now = float(moment.time[-1])
        if self._seen and moment.time[0] <= self._seen[-1].time[-1]:
            raise PoseError(
                f"a stream's time must go on: {moment.time[0]:g} s after "
                f"{self._seen[-1].time[-1]:g} s"
            )
        if self._seen and moment.landmarks != self._seen[-1].landmarks:
            raise PoseError(
                f"a stream keeps its {len(self._seen[-1].landmarks)} landmarks, got "
                f"{len(moment.landmarks)} others; begin a new Spotter for another camera"
            )
        self._seen.append(moment)
        while now - self._seen[0].time[-1] > self._longest + PAUSE + 2 * LOOK_EVERY:
            self._seen.popleft()
        if now - self._looked >= LOOK_EVERY - BEAT:
            self._looked = now
            self._look(now)
        self._recognize_one()
        return self._ended(now)

    def listen(self, poses: PoseSequence) -> tuple[Spotted, ...]:
        """Take a whole recording frame by frame, as a robot would, and end the stream."""
        found: list[Spotted] = []
        for moment in poses.time.tolist():
            found += self.feed(poses.between(moment, moment))
        return (*found, *self.finish())

    def for_language(self, recognizer: Recognizer) -> Spotter:
        """Return a spotter of another language that remembers what this one saw and told.

        Gestures of this language that are not told yet are forgotten.

        Raises
        ------
        OsgError
            As for a new one.

        """
        other = Spotter(recognizer, confident=self._confident)
        other._seen.extend(self._seen)
        other._looked, other._moving = self._looked, self._moving
        # Only what ends from now on is taken up: a gesture of the past must not come out today.
        other._believed, other._reported = self._believed, self._reported
        return other

    def finish(self) -> tuple[Spotted, ...]:
        """End the stream: return what was still awaited."""
        if self._seen:
            self._look(np.inf)
        while self._waiting:
            self._recognize_one()
        return self._ended(np.inf)

    def _look(self, now: float) -> None:
        """Cut what is remembered into strokes, and take up what ends with a new one."""
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
        """Follow the language's landmarks through what is remembered."""
        poses = join_sequences(self._seen)
        names = [name for name in self._landmarks if name in poses.landmarks]
        count = int(np.ceil(poses.duration / GRID_STEP)) + 1
        if count < 3 or not names or not poses.select(names).seen.any():
            return None
        trajectory = Trajectory.from_poses(poses)
        even = trajectory.select(names).filled().resampled_in_time(count)
        paths = np.moveaxis(even.xy / measure_body_unit(trajectory), 1, 0)
        shown = [path for path in paths if np.isfinite(path).any()]
        return measure_motion(shown, even.time + poses.time[0])

    def _recognize_one(self) -> None:
        """Put the stretch that waits longest to the recogniser."""
        while self._waiting:
            span = self._waiting.popleft()
            poses = join_sequences(self._seen).between(span.start - BEAT, span.end + BEAT)
            if span.start < self._reported - SLOW_EDGE or len(poses) < 2:
                continue
            try:
                result = self._recognizer.recognize(poses)
            except PoseError:
                return
            spotted = Spotted(span.start, span.end, result)
            if self._is_gesture(spotted):
                self._candidates.append(spotted)
            return

    def _is_gesture(self, spotted: Spotted) -> bool:
        """Tell whether a stretch is a gesture: sure, large enough, and about as long."""
        result = spotted.recognition
        if result.label is None or result.confidence < self._confident:
            return False
        gesture = self._recognizer.language.gesture(result.label)
        if gesture.trajectory is None or _familiarity(result) < FAMILIAR:
            return False
        usual = float(gesture.trajectory.time[-1])
        if not FASTER * usual <= spotted.end - spotted.start <= SLOWER * usual:
            return False
        trajectory = Trajectory.from_poses(join_sequences(self._seen))
        part = trajectory.between(
            spotted.start - self._seen[0].time[0], spotted.end - self._seen[0].time[0]
        )
        moved = measure_displacements(part)
        most = max(moved.get(name, 0.0) for name in self._landmarks)
        return most >= MIN_DISPLACEMENT * measure_body_unit(trajectory)

    def _ended(self, now: float) -> tuple[Spotted, ...]:
        """Report the best candidates that nothing better can replace any more."""
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
    """Return the strokes of a motion in order, each with its slow beginning and end."""
    pieces = split_pieces(motion)
    firsts = np.array([motion.time[piece.first] for piece in pieces])
    lasts = np.array([motion.time[piece.last] for piece in pieces])
    halves = np.concatenate([motion.time[:1], (firsts[1:] + lasts[:-1]) / 2, motion.time[-1:]])
    return [
        Span(float(max(first - SLOW_EDGE, before)), float(min(last + SLOW_EDGE, after)))
        for first, last, before, after in zip(firsts, lasts, halves, halves[1:], strict=False)
    ]


def _familiarity(result: Recognition) -> float:
    """Return the confidence that the nearest gesture was shown rather than none."""
    at = result.gestures.index(result.nearest)
    asked = np.fmax.reduce([result.novelty_by_view[view][at] for view in ASKED])
    return estimate_confidence(float(asked), float(result.scores[at]), np.inf)
