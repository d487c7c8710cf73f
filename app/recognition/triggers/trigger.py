"""Trigger of a language: what a diver holds before and after a gesture.

One kind is an `ArmPose`: positions of elbows and wrists, and a score of how close a body is to
them. Places are relative to the middle of the shoulders and the length of the torso in the same
frame, so that a stream gives the scores that its recording gives.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np

from app.recognition.errors import TriggerError
from app.recognition.poses.landmarks import HIPS, SHOULDERS
from app.recognition.poses.sequence import SHOULDER_WIDTHS_PER_TORSO, FloatArray, PoseSequence

ARM_JOINTS: Final = ("left_elbow", "left_wrist", "right_elbow", "right_wrist")
"""Landmarks whose places are an arm pose."""

TOLERANCE = 0.3
"""Torso lengths, 15 cm, by which a joint of a raised arm may be off at a score of 0.5. Of other
bodies and other views a held joint is off by up to 0.3 (`benchmarks/studies/triggers.md`)."""

IDLE_TOLERANCE = 0.6
"""The same of an arm that hangs in the demonstration: nobody holds it on purpose, and in water it
floats; but a raised one is another pose."""

HANGING = 0.7
"""Torso lengths below the shoulders from which on a wrist hangs: about at the hips, also where the
arm floats a little beside the body."""

MOST_HANGING = 0.5
"""Largest share of a take in which both arms hang; a take with more is a rest. Between two gestures
arms are lowered and raised again: a language with a V read 31 of 59 such gaps, of rendered divers,
as its V. Arms hung in 64 % and more of a gap, and in 36 % at most of a gesture."""

POSE_SECONDS = 0.6
"""Seconds that an arm pose must be held. Arms pass through a place as wide as the tolerance in less
than half a second (Flash and Hogan 1985), and divers hold a sign on purpose for longer."""

LEAVE_SCORE = 0.4
"""Score down to which a pose continues: a fifth beyond the tolerance, so that sway does not end it
but a lowered arm does."""

HANGING_ARMS = ((0.58, 0.42), (0.66, 0.9), (-0.58, 0.42), (-0.66, 0.9))
"""Places of `ARM_JOINTS` of arms that hang, of a diver who faces the camera."""

MOST_ORDINARY = 0.3
"""Largest score of hanging arms: below `LEAVE_SCORE`, so that arms that go down end the pose."""

STILL_SECONDS = 0.5
"""Seconds of a demonstration that must be still."""

STILL = 0.12
"""Torso lengths from its median place within which a joint is still nine tenths of the time: sway
and the pose model's jitter are below, a wave or a scull is above."""

LOOK_EVERY = 0.1
"""Seconds between two spans of a demonstration that are compared."""

LEAST_SEEN = 0.8
"""Share of a still span's frames that show both arms."""

DIGITS = 3
"""Decimals kept of a place: half a millimetre."""

AT_HEAD, ABOVE_HEAD, SIDEWARDS = -0.1, -0.7, 0.4
"""Torso lengths from the middle of the shoulders, for words: a wrist above them, above the head,
and beside the body."""

Place = tuple[float, float]


@dataclass(frozen=True)
class ArmPose:
    """A pose of the arms, as one held demonstration shows it.

    Attributes
    ----------
    places
        x and y of each of `ARM_JOINTS`, in torso lengths from the middle of the shoulders, x to
        the image's right, y down.

    Raises
    ------
    TriggerError
        When a place is missing, or both arms hang, which divers do all the time.

    """

    places: tuple[Place, Place, Place, Place]

    def __post_init__(self) -> None:
        """Validate the places."""
        numbers = [number for place in self.places for number in place]
        if len(self.places) != len(ARM_JOINTS) or not all(map(math.isfinite, numbers)):
            raise TriggerError(f"an arm pose needs x and y of {', '.join(ARM_JOINTS)}")
        if self._is_ordinary:
            raise TriggerError(
                "both arms hang or nearly so, as they do most of the time, so that the pose would "
                "be seen everywhere: raise at least one hand, such as onto the head"
            )

    @classmethod
    def from_poses(cls, poses: PoseSequence) -> ArmPose:
        """Return the pose that is held in a demonstration.

        It is the median over the span of `STILL_SECONDS` in which the arms are most still, spans
        with both arms hanging left out.

        Raises
        ------
        TriggerError
            When the arms are not seen, never still for so long, or hang whenever they are still.

        """
        if poses.duration < STILL_SECONDS:
            raise TriggerError(
                f"a pose must be held for {STILL_SECONDS:g} s, and this lasts "
                f"{poses.duration:.2f} s: mark a longer range"
            )
        places, time = locate_arms(poses), poses.time
        best: tuple[float, ArmPose | None] = (math.inf, None)
        hung = seen = False
        for start in np.arange(time[0], time[-1] - STILL_SECONDS + 1e-9, LOOK_EVERY).tolist():
            inside = places[(time >= start - 1e-9) & (time <= start + STILL_SECONDS + 1e-9)]
            known = inside[np.isfinite(inside).all(axis=(1, 2))]
            if len(known) < 2 or len(known) < LEAST_SEEN * len(inside):
                continue
            seen = True
            middle = np.median(known, axis=0)
            off = np.sort(np.linalg.norm(known - middle, axis=2), axis=0)
            unrest = float(off[int(0.9 * (len(off) - 1))].max())
            if unrest >= min(STILL, best[0]):
                continue
            try:
                joints = dict(zip(ARM_JOINTS, middle.tolist(), strict=True))
                best = (unrest, cls.of_joints(joints))
            except TriggerError:
                hung = True
        if best[1] is None:
            raise TriggerError(_explain_no_pose(poses, seen=seen, hung=hung))
        return best[1]

    @classmethod
    def of_joints(cls, joints: Mapping[str, Place | list[float]]) -> ArmPose:
        """Return the pose of places given by the joints' names, rounded to `DIGITS`."""
        first, second, third, fourth = (
            (round(float(joints[name][0]), DIGITS), round(float(joints[name][1]), DIGITS))
            for name in ARM_JOINTS
        )
        return cls((first, second, third, fourth))

    @property
    def joints(self) -> dict[str, Place]:
        """The places by the joints' names."""
        return dict(zip(ARM_JOINTS, self.places, strict=True))

    @property
    def words(self) -> str:
        """The pose in words, such as "left hand at the head"."""
        hands = [
            f"{side} hand {_describe_hand(self.joints[f'{side}_wrist'], outward)}"
            for side, outward, raised in zip(("left", "right"), (1, -1), self._raised, strict=True)
            if raised
        ]
        return " and ".join(hands)

    def score(self, places: FloatArray) -> FloatArray:
        """Return how closely bodies hold the pose.

        Parameters
        ----------
        places
            ``(T, 4, 2)``, as of `locate_arms`.

        Returns
        -------
        ``(T,)`` in [0, 1], falling with the distance of the joint that is farthest off: 1 in the
        pose, 0.5 at its tolerance, 0 at twice that or where a joint is not seen.

        """
        off = places - np.array(self.places)
        # Plain arithmetic, which rounds alike for one frame and for many.
        distance = np.sqrt(off[..., 0] * off[..., 0] + off[..., 1] * off[..., 1])
        share: FloatArray = (distance / self._tolerances).max(axis=1)
        return np.where(np.isfinite(share), np.maximum(1 - share / 2, 0.0), 0.0)

    def resembles(self, other: ArmPose) -> float:
        """Return the score of another pose's places."""
        return float(self.score(np.array([other.places]))[0])

    @property
    def _raised(self) -> tuple[bool, bool]:
        return _raised(self.places)

    @property
    def _is_ordinary(self) -> bool:
        hanging = float(self.score(np.array([HANGING_ARMS]))[0])
        return not any(self._raised) or hanging > MOST_ORDINARY

    @property
    def _tolerances(self) -> FloatArray:
        left, right = (TOLERANCE if up else IDLE_TOLERANCE for up in self._raised)
        return np.array([left, left, right, right])


def locate_arms(poses: PoseSequence) -> FloatArray:
    """Return where the joints of the arms are in each frame.

    Returns
    -------
    ``(T, 4, 2)`` in torso lengths from the middle of the shoulders; NaN where a joint or the
    torso is not seen. Where the hips are not seen, the width of the shoulders stands in.

    """
    return locate_joints(poses.landmarks, poses.xy)


def mostly_hang(landmarks: tuple[str, ...], xy: FloatArray) -> bool:
    """Return whether both arms hang in more than `MOST_HANGING` of the frames.

    Parameters
    ----------
    landmarks, xy
        As for `locate_joints`. Arms that are not seen do not hang.

    """
    below = locate_joints(landmarks, xy)[:, 1::2, 1]
    return float((below > HANGING).all(axis=1).mean()) > MOST_HANGING


def locate_joints(landmarks: tuple[str, ...], xy: FloatArray) -> FloatArray:
    """Return the same of ``(T, K, 2)`` places of named landmarks in any unit."""
    if not {*ARM_JOINTS, *SHOULDERS} <= set(landmarks):
        return np.full((len(xy), len(ARM_JOINTS), 2), np.nan)
    left, right = (xy[:, landmarks.index(name)] for name in SHOULDERS)
    middle = (left + right) / 2
    unit = SHOULDER_WIDTHS_PER_TORSO * _measure(left - right)
    if set(HIPS) <= set(landmarks):
        one, other = (xy[:, landmarks.index(name)] for name in HIPS)
        torso = _measure((one + other) / 2 - middle)
        unit = np.where(np.isfinite(torso), torso, unit)
    unit = np.where(unit > 0, unit, np.nan)
    joints = xy[:, [landmarks.index(name) for name in ARM_JOINTS]]
    return np.asarray((joints - middle[:, None]) / unit[:, None, None], dtype=np.float64)


def _measure(vectors: FloatArray) -> FloatArray:
    return np.asarray(
        np.sqrt(vectors[:, 0] * vectors[:, 0] + vectors[:, 1] * vectors[:, 1]), dtype=np.float64
    )


def _raised(places: Sequence[Sequence[float]]) -> tuple[bool, bool]:
    _, left, _, right = places
    return left[1] < HANGING, right[1] < HANGING


def _explain_no_pose(poses: PoseSequence, *, seen: bool, hung: bool) -> str:
    if hung:
        return (
            "the arms hang whenever they are still, as they do most of the time: hold a pose with "
            f"at least one hand above the hips for {STILL_SECONDS:g} s, such as on the head"
        )
    if seen:
        return (
            f"the arms are never still for {STILL_SECONDS:g} s in {poses.duration:.1f} s: hold the "
            "pose longer, or mark the range in which it is held"
        )
    return (
        f"both arms are never seen for {STILL_SECONDS:g} s in {poses.duration:.1f} s: film the "
        "diver from the front with elbows and wrists in the picture, or mark another range"
    )


def _describe_hand(wrist: Place, outward: int) -> str:
    x, y = wrist[0] * outward, wrist[1]
    if y < ABOVE_HEAD:
        return "above the head"
    if y < AT_HEAD:
        return "at the head" if abs(x) < SIDEWARDS else "raised beside the head"
    if x > 2 * SIDEWARDS:
        return "stretched aside"
    return "across the body" if x < 0 else "before the body"


TriggerKind = Literal["salute", "pose", "gesture", "none"]

MOST_ALIKE = 0.1
"""Largest score of the stop pose as the start pose: the two then differ by more than the tolerance
for another body."""


@dataclass(frozen=True)
class Trigger:
    """What begins and ends a take.

    Attributes
    ----------
    kind
        ``salute``: a Vulcan salute. ``pose``: a held pose of the arms. ``gesture``: a gesture of
        the language; gestures spotted between two of them count (`app.recognition.spotting`).
        ``none``: nothing; gestures are spotted anywhere.
    start
        Of kind ``pose``, the pose that begins a take.
    stop
        The pose that ends it; None: `start` ends it too.
    start_label, stop_label
        Of kind ``gesture``, the labels of the gestures that begin and end; empty for other kinds.
        An empty `stop_label` becomes `start_label`.

    Raises
    ------
    TriggerError
        When a pose or label is missing or superfluous, or start and stop are too much alike.

    """

    kind: TriggerKind = "salute"
    start: ArmPose | None = None
    stop: ArmPose | None = None
    start_label: str = ""
    stop_label: str = ""

    def __post_init__(self) -> None:
        """Validate the poses and labels."""
        if bool(self.start_label) != (self.kind == "gesture"):
            raise TriggerError(
                f"a trigger of kind {self.kind!r} "
                + ("needs a gesture" if self.kind == "gesture" else "has no gestures")
            )
        if self.stop_label and not self.start_label:
            raise TriggerError(f"a trigger of kind {self.kind!r} has no gestures")
        object.__setattr__(self, "stop_label", self.stop_label or self.start_label)
        if (self.start is not None) != (self.kind == "pose") or (self.stop and not self.start):
            raise TriggerError(
                f"a trigger of kind {self.kind!r} "
                + ("needs a start pose" if self.kind == "pose" else "has no poses")
            )
        if self.start and self.stop:
            alike = max(self.start.resembles(self.stop), self.stop.resembles(self.start))
            if alike > MOST_ALIKE:
                raise TriggerError(
                    f"the poses for start and stop are too much alike (score {alike:.2f}, at most "
                    f"{MOST_ALIKE:g}): hold clearly different ones, or leave the stop pose out"
                )

    @property
    def words(self) -> str:
        """The trigger in words, for people."""
        if self.kind == "none":
            return "without a trigger, gestures anywhere"
        if self.kind == "gesture":
            return f"between the gestures {self.start_label!r} and {self.stop_label!r}"
        if self.start is None:
            return "between two salutes"
        if self.stop is None:
            return f"between two poses of the arms ({self.start.words})"
        return f"between two poses of the arms ({self.start.words}; {self.stop.words})"

    @property
    def labels(self) -> frozenset[str]:
        """Labels of the gestures that begin and end; none of other kinds."""
        return frozenset({self.start_label, self.stop_label} - {""})

    @property
    def spots(self) -> bool:
        """Whether gestures are spotted in continuous motion, as no held trigger brackets them."""
        return self.kind in ("gesture", "none")

    def renamed(self, before: str, after: str) -> Trigger:
        """Return the trigger in which a gesture has another label."""
        start, stop = (
            after if label == before else label for label in (self.start_label, self.stop_label)
        )
        return replace(self, start_label=start, stop_label=stop)

    @property
    def noun(self) -> str:
        """What a diver shows before and after a gesture: "salute" without another trigger."""
        return {"pose": "pose of the arms", "gesture": "gesture"}.get(self.kind, "salute")

    @property
    def landmarks(self) -> tuple[str, ...]:
        """The body's landmarks by which it is seen."""
        return (*SHOULDERS, *ARM_JOINTS) if self.kind == "pose" else ()

    def score(self, poses: PoseSequence, salute: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the scores of every frame for what begins a take and for what ends it.

        Parameters
        ----------
        poses
            T frames of a recording, or one of a stream.
        salute
            ``(T,)``: score of the best salute.

        Returns
        -------
        Two arrays ``(T,)`` in [0, 1], the same one twice where start and stop are the same. Of two
        poses, only the one that is held more has a score.

        """
        if self.kind == "salute":
            return salute, salute
        if self.start is None:
            nothing = np.zeros(len(poses))
            return nothing, nothing
        places = locate_arms(poses)
        start = self.start.score(places)
        if self.stop is None:
            return start, start
        stop = self.stop.score(places)
        return np.where(start >= stop, start, 0.0), np.where(stop > start, stop, 0.0)


SALUTE: Final = Trigger()
NO_TRIGGER: Final = Trigger("none")
