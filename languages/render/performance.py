"""Performance of one take, frame by frame: rest, salute, gesture, salute, rest."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from languages.render.body import Array
from languages.render.gestures import Drawing
from languages.render.motion import along_curve, minimum_jerk, tremor, wander
from languages.render.posture import HAND_SHAPES, ArmTarget, BodyMotion
from languages.render.signs import Sign

UP = np.array([0.0, 0.0, 1.0])
DOWN = np.array([0.1, -0.2, -1.0])
TO_CAMERA = np.array([0.05, -1.0, 0.0])
TO_FACE = np.array([0.4, 1.0, 0.0])
TO_THIGH = np.array([1.0, -0.3, 0.0])

REST = ArmTarget(np.array([-0.15, -0.09, -0.46]), DOWN, TO_THIGH, HAND_SHAPES["relaxed"])
"""The arm hangs beside the body."""
SALUTE = ArmTarget(np.array([-0.19, -0.28, 0.10]), UP, TO_CAMERA, HAND_SHAPES["salute"])
"""Beside the face, palm to the camera, clear of the head and of the body."""
SALUTE_ASIDE = replace(SALUTE, wrist=np.array([-0.34, -0.24, -0.04]))
"""Out to the side, at the height of the shoulder."""
SALUTE_BEFORE_THE_CHEST = replace(SALUTE, wrist=np.array([-0.02, -0.36, -0.16]))
"""In front of the breastbone."""
ON_THE_HEAD = ArmTarget(
    np.array([0.13, -0.05, 0.36]), np.array([0.9, 0.0, 0.25]), DOWN, HAND_SHAPES["flat"]
)
"""The hand lies on the head, the elbow points outwards."""
ON_THE_BELLY = ArmTarget(
    np.array([0.14, -0.24, -0.25]), np.array([0.95, 0.0, 0.2]), TO_FACE, HAND_SHAPES["flat"]
)
"""The forearm lies across the belly, palm to the body."""

OPENINGS = {
    "salute": (SALUTE, REST),
    "salute aside": (SALUTE_ASIDE, REST),
    "salute before the chest": (SALUTE_BEFORE_THE_CHEST, REST),
    "head": (REST, ON_THE_HEAD),
    "belly": (REST, ON_THE_BELLY),
}
"""Right and left arm before and after the gesture, by name."""


@dataclass(frozen=True)
class Manner:
    """How a diver performs a take; what differs between two takes of one gesture.

    Parameters
    ----------
    tempo
        Multiplies all speeds.
    size
        Multiplies the gesture's size.
    aspect
        Width over height, relative to the gesture as designed.
    tilt
        Degrees by which the gesture is turned in its plane.
    wobble
        Unsteadiness of the drawn curve, as a share of its half size.
    hand
        Shape of the drawing hand, a name in `HAND_SHAPES`.
    lean
        Degrees by which the fingers of the drawing hand lean towards the image's left.
    drift
        Metres the body drifts to either side.
    hold
        Seconds each salute is held.
    pause
        Seconds the hand rests where a stroke begins and ends; people do before and after writing.
    opening, closing
        What is held before and after the gesture, names in `OPENINGS`.

    """

    tempo: float = 1.0
    size: float = 1.0
    aspect: float = 1.0
    tilt: float = 0.0
    wobble: float = 0.02
    hand: str = "flat"
    lean: float = 0.0
    drift: float = 0.015
    hold: float = 0.9
    pause: float = 0.2
    opening: str = "salute"
    closing: str = "salute"


@dataclass(frozen=True)
class Phase:
    """A named stretch of a performance, in seconds from the clip's beginning."""

    name: str
    start: float
    end: float


@dataclass
class Timeline:
    """Arms and phases of a performance while it is being composed, at a fixed frame rate."""

    rate: float
    right: list[ArmTarget] = field(default_factory=list)
    left: list[ArmTarget] = field(default_factory=list)
    phases: list[Phase] = field(default_factory=list)

    def frames(self, seconds: float) -> int:
        """Count the frames of a duration, at least two."""
        return max(2, round(seconds * self.rate))

    def add(self, name: str, right: list[ArmTarget], left: list[ArmTarget]) -> None:
        """Append a phase; both arms have one target per frame."""
        start = len(self.right) / self.rate
        self.right += right
        self.left += left
        self.phases.append(Phase(name, start, len(self.right) / self.rate))

    def hold(self, name: str, seconds: float) -> None:
        """Keep both arms where they are."""
        count = self.frames(seconds)
        self.add(name, [self.right[-1]] * count, [self.left[-1]] * count)

    def move(self, name: str, seconds: float, right: ArmTarget, left: ArmTarget) -> None:
        """Bring both arms to new targets with minimum jerk."""
        # The first frame of the list would repeat the last one of the phase before.
        shares = minimum_jerk(np.linspace(0, 1, self.frames(seconds) + 1)[1:])
        self.add(
            name,
            [self.right[-1].towards(right, float(share)) for share in shares],
            [self.left[-1].towards(left, float(share)) for share in shares],
        )


@dataclass(frozen=True)
class Performance:
    """What the diver does in every frame of a clip.

    Parameters
    ----------
    rate
        Frames per second.
    phases
        In order and without gaps: rest, raise, salute, transit, pause, stroke, pause, transit,
        salute, lower, rest.
    right, left, body
        One entry per frame.

    """

    rate: float
    phases: tuple[Phase, ...]
    right: tuple[ArmTarget, ...]
    left: tuple[ArmTarget, ...]
    body: tuple[BodyMotion, ...]

    def __len__(self) -> int:
        """Count the frames."""
        return len(self.right)


CORNER = 0.1
"""Seconds at a corner, where one minimum-jerk movement ends and the next begins."""


def perform(drawing: Drawing, manner: Manner, rate: float, seed: int) -> Performance:
    """Compose a take of one gesture.

    Parameters
    ----------
    drawing
        The gesture.
    manner
        How it is performed.
    rate
        Frames per second.
    seed
        Of everything that is left to chance; the same seed gives the same take.

    """
    random = np.random.default_rng(seed)
    strokes = _trace(drawing, manner, random)
    first, last = _target(strokes[0][0], drawing, manner), _target(strokes[-1][-1], drawing, manner)
    timeline = Timeline(rate)
    still = [REST] * timeline.frames(0.4)
    timeline.add("rest", still, still)
    opening, closing = OPENINGS[manner.opening], OPENINGS[manner.closing]
    timeline.move("raise", 0.75 / manner.tempo, *opening)
    timeline.hold("salute", manner.hold)
    left = _left_of(first, drawing)
    timeline.move("transit", _transit_time(opening[0], first, manner), first, left)
    if manner.pause:
        timeline.hold("pause", manner.pause)
    _draw(timeline, strokes, drawing, manner)
    if manner.pause:
        timeline.hold("pause", manner.pause)
    timeline.move("transit", _transit_time(closing[0], last, manner), *closing)
    timeline.hold("salute", manner.hold)
    timeline.move("lower", 0.75 / manner.tempo, REST, REST)
    timeline.hold("rest", 0.3)
    return _animate(timeline, manner, random)


def perform_sign(sign: Sign, manner: Manner, rate: float, seed: int) -> Performance:
    """Compose a take of a divers' sign; parameters are those of `perform`.

    Of the manner tempo, lean of the fingers, drift and hold are used.
    """
    timeline = Timeline(rate)
    still = [REST] * timeline.frames(0.4)
    timeline.add("rest", still, still)
    timeline.move("raise", 0.75 / manner.tempo, SALUTE, REST)
    timeline.hold("salute", manner.hold)
    first = sign.postures[0]
    right, left = _lean(first.right, manner), first.left or REST
    timeline.move("transit", _transit_time(SALUTE, right, manner), right, left)
    if first.hold:
        timeline.hold("stroke", first.hold / manner.tempo)
    for posture in sign.postures[1:]:
        right, left = _lean(posture.right, manner), posture.left or REST
        timeline.move("stroke", posture.seconds / manner.tempo, right, left)
        if posture.hold:
            timeline.hold("stroke", posture.hold / manner.tempo)
    timeline.move("transit", _transit_time(SALUTE, right, manner), SALUTE, REST)
    timeline.hold("salute", manner.hold)
    timeline.move("lower", 0.75 / manner.tempo, REST, REST)
    timeline.hold("rest", 0.3)
    return _animate(timeline, manner, np.random.default_rng(seed))


def move_about(manner: Manner, rate: float, seed: int) -> Performance:
    """Compose what divers do between gestures: see to the mask, wave, point; nothing is meant.

    Parameters are those of `perform`.
    """
    at_mask = ArmTarget(
        np.array([0.07, -0.19, 0.17]), np.array([0.6, -0.1, 0.8]), TO_FACE, HAND_SHAPES["relaxed"]
    )
    wave_out = ArmTarget(
        np.array([-0.28, -0.26, 0.10]), np.array([-0.3, -0.1, 1]), TO_CAMERA, HAND_SHAPES["open"]
    )
    wave_in = replace(wave_out, wrist=np.array([-0.16, -0.27, 0.11]), pointing=0.9 * UP)
    aside = ArmTarget(
        np.array([-0.40, -0.22, 0.02]),
        np.array([-1, -0.3, 0.1]),
        TO_CAMERA,
        HAND_SHAPES["pointing"],
    )
    timeline = Timeline(rate)
    still = [REST] * timeline.frames(0.4)
    timeline.add("rest", still, still)
    for name, seconds, target in (
        ("mask", 0.8, at_mask),
        ("wave", 0.7, wave_out),
        *(("wave", 0.4, place) for place in (wave_in, wave_out, wave_in, wave_out)),
        ("point", 0.7, aside),
        ("lower", 0.8, REST),
    ):
        timeline.move(name, seconds / manner.tempo, target, REST)
        timeline.hold(name, 0.6 if name in ("mask", "point") else 0.08)
    timeline.hold("rest", 0.4)
    return _animate(timeline, manner, np.random.default_rng(seed))


def stand_by(
    manner: Manner, rate: float, seed: int, seconds: float, salutes: float | None = None
) -> Performance:
    """Compose what a buddy does: nothing, or one salute from `salutes` seconds on.

    Other parameters are those of `perform`.
    """
    timeline = Timeline(rate)
    still = [REST] * timeline.frames(seconds if salutes is None else salutes)
    timeline.add("rest", still, still)
    if salutes is not None:
        timeline.move("raise", 0.75 / manner.tempo, SALUTE, REST)
        timeline.hold("salute", manner.hold)
        timeline.move("lower", 0.75 / manner.tempo, REST, REST)
        timeline.hold("rest", seconds)
    return _animate(timeline, manner, np.random.default_rng(seed))


def _animate(timeline: Timeline, manner: Manner, random: np.random.Generator) -> Performance:
    """Add what nobody does on purpose: tremor of the hands, drift and sway of the body."""
    time = np.arange(len(timeline.right)) / timeline.rate
    shake = [tremor(random, time, 0.004) for _ in range(2)]
    slow = np.array([0.07, 0.16, 0.31])
    shift = wander(random, time, slow, manner.drift * np.array([1.0, 0.5, 0.2]))
    turn = wander(random, time, slow, np.radians([1.8, 1.0, 0.4]))
    kick = 2 * np.pi * 0.45 * time + random.uniform(0, 2 * np.pi)
    arms = [
        tuple(
            replace(target, wrist=target.wrist + move) for target, move in zip(*pair, strict=True)
        )
        for pair in zip((timeline.right, timeline.left), shake, strict=True)
    ]
    body = tuple(
        BodyMotion(
            shift[k], float(turn[k, 0]), float(turn[k, 1]), float(kick[k]), float(turn[k, 2])
        )
        for k in range(len(time))
    )
    return Performance(timeline.rate, tuple(timeline.phases), arms[0], arms[1], body)


def _trace(drawing: Drawing, manner: Manner, random: np.random.Generator) -> list[Array]:
    """Give the strokes as this take draws them, ``(N, 2)`` in half sizes."""
    angle = np.radians(manner.tilt)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    stretch = np.sqrt(manner.aspect) ** np.array([1.0, -1.0])
    lengths = [len(stroke) for stroke in drawing.strokes]
    whole = np.concatenate(drawing.strokes)
    # Two waves along the whole way, so that corners stay joined and no end is favoured.
    way = np.linspace(0, 1, len(whole))
    wave = wander(random, way, np.array([1.0, 2.0]), manner.wobble * np.array([1.0, 0.5]))
    bent = (whole * stretch) @ turn.T + wave[:, :2]
    return np.split(bent, np.cumsum(lengths)[:-1])


def _draw(timeline: Timeline, strokes: list[Array], drawing: Drawing, manner: Manner) -> None:
    right: list[ArmTarget] = []
    for number, stroke in enumerate(strokes):
        if number:
            right += [right[-1]] * timeline.frames(CORNER)
        length = np.linalg.norm(np.diff(stroke, axis=0), axis=1).sum() * drawing.half_size
        seconds = length * manner.size / (drawing.speed * manner.tempo) + 0.2
        for point in along_curve(stroke * drawing.half_size, timeline.frames(seconds)):
            right.append(_target(point / drawing.half_size, drawing, manner))
    left = [_left_of(target, drawing) for target in right]
    timeline.add("stroke", right, left)


FURTHEST = 0.53
"""Metres from the shoulder that a wrist comes at most; an elbow is not locked while drawing."""


def _target(point: Array, drawing: Drawing, manner: Manner) -> ArmTarget:
    """Give the right arm's target for a point of the drawing.

    Where the frontal plane is out of reach the hand comes nearer to the body, as on a sphere
    about the shoulder.
    """
    x, z = np.array(drawing.centre) + point * drawing.half_size * manner.size
    depth = min(drawing.depth, float(np.sqrt(max(FURTHEST**2 - x**2 - z**2, 0.05**2))))
    if drawing.both_hands:
        # The hand prolongs the arm in the frontal plane.
        pointing = np.array([x, -0.3 * depth, z])
    else:
        lean = np.radians(manner.lean)
        pointing = np.array([-np.sin(lean), -0.15, np.cos(lean)])
    return ArmTarget(np.array([x, -depth, z]), pointing, TO_CAMERA, HAND_SHAPES[manner.hand])


def _lean(arm: ArmTarget, manner: Manner) -> ArmTarget:
    """Lean a hand in the frontal plane."""
    angle = np.radians(manner.lean)
    turn = np.array(
        [[np.cos(angle), 0, -np.sin(angle)], [0, 1, 0], [np.sin(angle), 0, np.cos(angle)]]
    )
    return replace(arm, pointing=turn @ arm.pointing, palm=turn @ arm.palm)


def _left_of(right: ArmTarget, drawing: Drawing) -> ArmTarget:
    return right if drawing.both_hands else REST


def _transit_time(salute: ArmTarget, place: ArmTarget, manner: Manner) -> float:
    """Seconds from the salute to a stroke's end: Fitts-like, a base plus a share of the way."""
    way = float(np.linalg.norm(place.wrist - salute.wrist))
    return (0.35 + 0.6 * way) / manner.tempo
