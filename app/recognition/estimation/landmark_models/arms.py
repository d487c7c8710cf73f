"""Hand regions from the pose: the regions of hands at the ends of the arms."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from app.recognition.estimation.landmark_models.region import Region, palm_size, up_of, upright
from app.recognition.poses.frame import SIDES, Body, Hand, Side
from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.recognition.poses.sequence import FloatArray

LEAST_VISIBILITY: Final = 0.1
"""Least visibility of a wrist whose hand is searched, as in MediaPipe Holistic."""

WRIST_SCALE: Final = 2.0
"""Side of the region over twice the distance from the wrist to the middle knuckle. MediaPipe
Holistic uses 2.7 with a re-crop model; the landmark model alone expects the hand to fill its
region, and finds twice as many at 2.0 (`benchmarks/studies/hands-and-water.md`)."""

WRIST_SHIFT: Final = 0.1
"""Shift towards the finger tips, over the same length, as in MediaPipe Holistic."""

FOREARM_VISIBILITY: Final = 0.5
"""Least visibility of a wrist for a search at the end of its forearm: the larger region needs a
more certain arm."""

FOREARM_SIDES: Final = (0.6, 0.9)
"""Sides of the regions at a forearm's end, over the body's size: a hand is 0.4 of a torso long, and
the landmark model expects it to fill half of its region or more."""

FOREARM_SHIFT: Final = 0.2
"""Shift of these regions beyond the wrist, over the body's size: half a hand."""

FOREARM_REACH: Final = 0.6
"""As `REACH`, for hands found there: 95 % of hands on the tracked body's arms are nearer."""

REACH: Final = 1.0
"""Largest distance between the pose's wrist and the hand's own, in palm sizes. Of hands on the
tracked body's arms 95 % are nearer than 0.6; those of bystanders are several palms away."""


OWN_REACH: Final = 1.5
"""As `REACH`, for a hand that belongs to the nearest of several people: the smoothed wrist of a
fast arm lags behind its hand by up to half a palm."""


HELD_SECONDS: Final = 0.06
"""Seconds between two looks at a hand that is held up: every second frame of a camera. A salute and
a hand shape are held for half a second."""

MOVING_SECONDS: Final = 0.2
"""The same for a hand that moves: its shape is seen five times a second."""

HANGING_SECONDS: Final = 0.3
"""The same for a hand that hangs: a salute is held for longer."""

SPARE_SECONDS: Final = 1.0
"""The same for a hand that moves or hangs, on a machine that is too slow: salutes are held."""

MOST_MISSES: Final = 2
"""Searches in consecutive frames for a hand that was lost, after which the pace counts again."""

UNSEEN_SECONDS: Final = 0.15
"""Least seconds between two searches from then on: each costs up to two looks."""

SLOW: Final = 1.0
"""Speed of a hand that is held, at most, in torso lengths a second."""

SETTLED_SECONDS: Final = 0.4
"""Time for which a hand has to be faster to count as moving: a salute's end is seen exactly."""

RAISED: Final = 0.25
"""Height of a raised wrist above the hips, along the body, in torso lengths."""

SAME_ARM: Final = 1.0
"""Largest movement of a wrist between two frames, in body sizes, by which it is the same arm."""

FAR: Final = 2.0
"""Largest distance between a wrong wrist of the pose and the hand, in body sizes: in dark water, of
near divers, the pose misses by up to 1.6 in three of four photographs."""

DOUBTED: Final = 0.7
"""Visibility of a wrist below which a hand without fingers may be elsewhere: of wrists in clear
water that are right nine in ten have more, in dark water most are wrong and have less."""

STEER_SECONDS: Final = 0.2
"""Time in which a wrist goes over from the pose's to its hand's, or back: no jump looks like a
stroke."""

Arm = tuple[Body, Side]
"""An arm of one of the bodies in an image."""


@dataclass(eq=False)
class ArmPace:
    """How often the hand of one arm is looked at.

    Attributes
    ----------
    side
        Which arm it is.
    wrist
        ``(2,)`` its wrist in the last frame, pixels.
    period
        Seconds between two looks.
    shift
        ``(2,)`` the wrist's movement from the frame before, pixels.
    read, forearm_searched
        Times, in seconds, of the last look at its hand, and of the last search at its forearm.
    misses
        Searches in vain since its hand was seen last.
    slow
        Time at which the wrist was slow last.
    lead, offset, belief
        Share from 0 to 1 with which the hand's wrist counts instead of the pose's, how far it was
        from it when it was seen last, ``(2,)`` pixels, and the hand's score; see `steer`.

    """

    side: Side
    wrist: FloatArray
    period: float = 0.0
    shift: FloatArray = field(default_factory=lambda: np.zeros(2))
    read: float = -np.inf
    forearm_searched: float = -np.inf
    slow: float = -np.inf
    misses: int = 0
    lead: float | None = None
    offset: FloatArray = field(default_factory=lambda: np.zeros(2))
    belief: float = 0.0

    @property
    def is_held_up(self) -> bool:
        """Whether the hand is held up, as for a salute; not known in the first frame."""
        return self.period == HELD_SECONDS

    @property
    def steered(self) -> FloatArray:
        """``(2,)`` the wrist that counts: the pose's, the hand's, or on the way between them."""
        return self.wrist + self.lead * self.offset if self.lead else self.wrist

    def has(self, hand: Hand) -> bool:
        """Return whether a hand is where the arm's hand was seen last, to a palm."""
        was = self.wrist - self.shift + self.offset
        far = float(np.linalg.norm(hand.xy[0] - was))
        return bool(self.lead) and far <= palm_size(hand.xy)

    def steer(self, hand: Hand | None, seconds: float, *, parted: bool) -> None:
        """Let the wrist go over to the hand while both are parted, and come back otherwise.

        In the first frame with the arm it is there at once.

        Parameters
        ----------
        hand
            The hand that belongs to the arm; None: not seen.
        seconds
            Time since the last frame.
        parted
            Whether the hand is away from the pose's wrist.

        """
        if hand is not None:
            self.offset, self.belief = hand.xy[0] - self.wrist, hand.score
        step = 1.0 if self.lead is None else seconds / STEER_SECONDS
        lead = self.lead or 0.0
        self.lead = lead + float(np.clip(parted - lead, -step, step))

    def is_due(self, time: float) -> bool:
        """Return whether its hand should be looked at in a frame taken at `time` seconds."""
        if 0 < self.misses <= MOST_MISSES:
            return True
        pause = max(self.period, UNSEEN_SECONDS) if self.misses else self.period
        return not 0 <= time - self.read < pause

    def move(self, body: Body, seconds: float, time: float, *, spares: bool = False) -> None:
        """Update by the body in the next frame, taken `seconds` after the last one."""
        wrist = body.xy[POSE_LANDMARKS.index(f"{self.side}_wrist")]
        self.shift, self.wrist = wrist - self.wrist, wrist
        shoulder, hip = (_both(body, joint).mean(axis=0) for joint in ("shoulder", "hip"))
        size = max(measure_body(body), 1e-9)
        if not np.linalg.norm(self.shift) >= SLOW * size * seconds:
            self.slow = time
        up = (shoulder - hip) / max(float(np.linalg.norm(shoulder - hip)), 1e-9)
        if time - self.slow > SETTLED_SECONDS:
            self.period = SPARE_SECONDS if spares else MOVING_SECONDS
        elif float((wrist - hip) @ up) > RAISED * size:
            self.period = HELD_SECONDS
        else:
            self.period = SPARE_SECONDS if spares else HANGING_SECONDS


class ArmPaces:
    """The arms in the frames of one clip, told apart by side and place.

    Attributes
    ----------
    spares
        Whether the machine is too slow for a camera: a hand that moves or hangs is then looked at
        once a second. One that is held up may salute.
    seconds
        Time between the last two frames.

    """

    def __init__(self, *, spares: bool = False) -> None:
        self.spares = spares
        self.seconds = np.inf
        self._arms: list[ArmPace] = []
        self._time = -np.inf

    def update(self, arms: Sequence[Arm], time: float) -> list[ArmPace]:
        """Return the pace of each arm in a frame taken at `time` seconds."""
        seconds = self.seconds = time - self._time
        known = self._arms if seconds > 0 else []
        self._time, self._arms = time, []
        for body, side in arms:
            wrist = body.xy[POSE_LANDMARKS.index(f"{side}_wrist")]
            near = [
                (float(np.linalg.norm(pace.wrist - wrist)), number)
                for number, pace in enumerate(known)
                if pace.side == side and pace not in self._arms
            ]
            far, number = min(near, default=(np.inf, -1))
            if far <= SAME_ARM * measure_body(body):
                pace = known[number]
                pace.move(body, seconds, time, spares=self.spares)
            else:
                pace = ArmPace(side, wrist, slow=time)
            self._arms.append(pace)
        return self._arms


def region_of_wrist(body: Body, side: Side) -> Region | None:
    """Return the region of the hand at the end of an arm, from the pose alone.

    The region is centred on the middle finger's knuckle, which lies between those of index and
    little finger, twice as near to the index. It is turned so that this knuckle is straight above
    the wrist (MediaPipe Holistic, Grishchenko and Bazarevsky 2020).

    Parameters
    ----------
    body
        The body in the image.
    side
        The arm.

    Returns
    -------
    None where the wrist is not visible, or the region is not usable.

    """
    wrist, pinky, index = (
        POSE_LANDMARKS.index(f"{side}_{part}") for part in ("wrist", "pinky", "index")
    )
    if not body.visibility[wrist] >= LEAST_VISIBILITY:
        return None
    knuckle = (2 * body.xy[index] + body.xy[pinky]) / 3
    length = 2 * float(np.linalg.norm(knuckle - body.xy[wrist]))
    rotation = upright(body.xy[wrist], knuckle)
    centre = knuckle + WRIST_SHIFT * length * up_of(rotation)
    region = Region(float(centre[0]), float(centre[1]), WRIST_SCALE * length, rotation)
    return region if region.usable else None


def regions_of_forearm(body: Body, side: Side) -> tuple[Region, ...]:
    """Return regions at the end of a forearm, for hands whose fingers the pose does not show.

    A glove hides the fingers that `region_of_wrist` needs. The direction of the forearm and the
    size of the body (the longer of torso and shoulders) also show where a hand is and how large it
    is.
    """
    elbow, wrist = (POSE_LANDMARKS.index(f"{side}_{joint}") for joint in ("elbow", "wrist"))
    if not body.visibility[wrist] >= FOREARM_VISIBILITY:
        return ()
    size = measure_body(body)
    rotation = upright(body.xy[elbow], body.xy[wrist])
    centre = body.xy[wrist] + FOREARM_SHIFT * size * up_of(rotation)
    regions = (
        Region(float(centre[0]), float(centre[1]), share * size, rotation)
        for share in FOREARM_SIDES
    )
    return tuple(region for region in regions if region.usable)


def measure_body(body: Body) -> float:
    """Return the longer of torso and shoulders in pixels; one of them is long in every view."""
    shoulders, hips = _both(body, "shoulder"), _both(body, "hip")
    torso = np.linalg.norm(shoulders.mean(axis=0) - hips.mean(axis=0))
    return float(max(torso, np.linalg.norm(shoulders[0] - shoulders[1])))


def wrist_distance(hand: Hand, body: Body, side: Side) -> float:
    """Return the distance between the hand's wrist and the arm's, in sizes of the hand's palm."""
    wrist = body.xy[POSE_LANDMARKS.index(f"{side}_wrist")]
    return float(np.linalg.norm(hand.xy[0] - wrist)) / max(palm_size(hand.xy), 1e-9)


def move_wrists(body: Body, paces: Sequence[ArmPace]) -> Body:
    """Return a body with its wrists where its hands are; see `ArmPace.steer`."""
    if not any(pace.lead for pace in paces):
        return body
    xy, visibility = body.xy.copy(), body.visibility.copy()
    for pace in paces:
        row = POSE_LANDMARKS.index(f"{pace.side}_wrist")
        xy[row] = pace.steered
        visibility[row] = max(visibility[row], (pace.lead or 0.0) * pace.belief)
    return replace(body, xy=xy, visibility=visibility)


def find_far_arm(hand: Hand, arms: Sequence[Arm]) -> int | None:
    """Return which of several arms a hand belongs to whose pose is wrong; None: none is near."""
    far = np.array(
        [
            np.linalg.norm(hand.xy[0] - body.xy[POSE_LANDMARKS.index(f"{side}_wrist")])
            / max(measure_body(body), 1e-9)
            for body, side in arms
        ]
    )
    # The comparison is False for NaN.
    near = np.flatnonzero(far <= FAR)
    return int(near[far[near].argmin()]) if len(near) else None


def is_doubtful(body: Body, side: Side) -> bool:
    """Return whether the pose itself is not sure of an arm's wrist."""
    return bool(body.visibility[POSE_LANDMARKS.index(f"{side}_wrist")] < DOUBTED)


def find_owner(hand: Hand, bodies: Sequence[Body]) -> int | None:
    """Return which of several bodies a hand belongs to; None where no wrist is within reach."""
    far = [min(_reach_of(hand, body, side) for side in SIDES) for body in bodies]
    nearest = min(range(len(far)), key=far.__getitem__, default=None)
    return nearest if nearest is not None and far[nearest] <= OWN_REACH else None


def find_stray_wrist(hands: Iterable[Hand], bodies: Sequence[Body]) -> FloatArray | None:
    """Return the wrist ``(2,)`` of the largest hand that belongs to none of the bodies."""
    stray = [hand for hand in hands if bodies and find_owner(hand, bodies) is None]
    return max(stray, key=lambda hand: hand.size).xy[0] if stray else None


def _both(body: Body, joint: str) -> FloatArray:
    """Return a joint ``(2, 2)`` on both sides of a body, pixels."""
    return body.xy[[POSE_LANDMARKS.index(f"{side}_{joint}") for side in SIDES]]


def _reach_of(hand: Hand, body: Body, side: Side) -> float:
    far = wrist_distance(hand, body, side)
    return far if np.isfinite(far) else np.inf
