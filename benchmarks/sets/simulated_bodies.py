"""Carried sets: figures that whole bodies draw, simulated from the paths of hands.

Every person has a body, a place and a size of drawing, a way to hold the elbow, and a tempo. The
right arm hangs, is raised, draws, and is lowered, as in UTD-MHAD's drawn figures and swipes. The
hand's path is simulated (`carried_figures`) or recorded (3DMadLabSD).
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from app.recognition import PoseSequence
from app.recognition.poses.sequence import FloatArray
from benchmarks.sets.drawn_sets import (
    Figure,
    clockwise,
    counter_clockwise,
    to_the_left,
    to_the_right,
)
from benchmarks.sets.recorded_sets import DOMAINS, FRAME, RATE, RecordedSet, recorded_sets
from benchmarks.sets.whole_body_sets import FOCAL

CARRIED_DOMAINS = {f"carried_{domain}": domain for domain in DOMAINS}
"""Sets of recorded paths, by name."""

CARRIED = ("carried_figures", *CARRIED_DOMAINS)
"""Names of all sets."""

PEOPLE, TAKES = 8, 4
"""People and takes of the simulated paths, as many as in UTD-MHAD."""

EXTENT = 0.4
"""Larger side of a usual figure in metres."""

NOISE = 0.006
"""Standard deviation in metres of the error of a joint in a frame."""

PARTS = ("shoulder", "elbow", "wrist", "hip")
JOINTS = tuple(f"{side}_{part}" for part in PARTS for side in ("left", "right"))


@dataclass(frozen=True)
class Person:
    """A simulated person; x to the viewer's right, y up, z away from the camera, in metres.

    Attributes
    ----------
    size
        All lengths of the body as a share of the usual.
    place
        ``(3,)``: the figures' centre, relative to the right shoulder.
    scale
        Factor of the hand's path.
    swivel
        Radians by which the elbow is held out from hanging down.
    raising
        Seconds to raise and to lower the arm.
    beside, before
        Distance from the camera's axis, and from the camera.
    lean
        Share of the hand's displacement that the shoulders follow.

    """

    size: float
    place: FloatArray
    scale: float
    swivel: float
    raising: float
    beside: float
    before: float
    lean: float

    @classmethod
    def draw(cls, random: np.random.Generator) -> Person:
        """Draw a person."""
        return cls(
            size=float(np.exp(random.normal(0, 0.07))),
            place=random.normal((0.05, 0.02, -0.38), (0.1, 0.1, 0.05)),
            scale=float(np.exp(random.normal(0, 0.25))),
            swivel=float(random.normal(0.5, 0.35)),
            raising=float(random.uniform(0.35, 0.8)),
            beside=float(random.normal(0, 0.15)),
            before=float(random.uniform(2.2, 3.0)),
            lean=float(random.uniform(0.0, 0.12)),
        )


def _draw_cross(share: FloatArray, _random: np.random.Generator) -> FloatArray:
    return _follow(share, [(-0.5, -0.5), (0.5, 0.5), (0.5, -0.5), (-0.5, 0.5)])


def _draw_triangle(share: FloatArray, _random: np.random.Generator) -> FloatArray:
    return _follow(share, [(0.0, -0.5), (-0.5, 0.45), (0.5, 0.45), (0.0, -0.5)])


def _follow(share: FloatArray, corners: list[tuple[float, float]]) -> FloatArray:
    """Return ``(T, 2)`` points at shares of the way along straight lines."""
    points = np.array(corners)
    length = np.r_[0, np.cumsum(np.hypot(*np.diff(points, axis=0).T))]
    at = share * length[-1]
    return np.stack([np.interp(at, length, points[:, axis]) for axis in range(2)], axis=1)


FIGURES: dict[str, tuple[Figure, float]] = {
    "swipe_left": (to_the_left, 0.6),
    "swipe_right": (to_the_right, 0.6),
    "cross": (_draw_cross, 1.3),
    "circle_clockwise": (clockwise, 1.3),
    "circle_counter_clockwise": (counter_clockwise, 1.3),
    "triangle": (_draw_triangle, 1.3),
}
"""The simulated figures, and the seconds that each usually takes."""


def carried_sets(
    folder: Path, names: Collection[str] = CARRIED, seed: int = 0
) -> Iterator[RecordedSet]:
    """Simulate the named sets; `folder` holds ``madlab3d.npz``."""
    if "carried_figures" in names:
        yield simulate_figures(np.random.default_rng(seed))
    domains = [domain for name, domain in CARRIED_DOMAINS.items() if name in names]
    for recorded in recorded_sets(folder, domains) if domains else ():
        yield carry_recorded(recorded, np.random.default_rng(seed))


def simulate_figures(random: np.random.Generator) -> RecordedSet:
    """Simulate people who draw the `FIGURES`, each with a slant, a stretch and a tempo."""
    recordings, labels, people = [], [], []
    for number in range(PEOPLE):
        person = Person.draw(random)
        slant, stretch = random.normal(0, 0.15), np.exp(random.normal(0, 0.15))
        turn = np.array([[np.cos(slant), -np.sin(slant)], [np.sin(slant), np.cos(slant)]])
        habit = turn @ np.diag([stretch, 1 / stretch]) * EXTENT
        tempo = random.uniform(0.7, 1.6)
        for label, (figure, usual) in FIGURES.items():
            for _ in range(TAKES):
                seconds = tempo * random.uniform(0.85, 1.15) * usual
                share = np.linspace(0, 1, int(seconds * RATE))
                eased = (share**2 * (3 - 2 * share) + share) / 2
                path = (figure(eased, random) + _waver(eased, random)) @ habit.T
                recordings.append(carry(path * (1, -1), person, random))
                labels.append(label)
                people.append(f"person {number}")
    return RecordedSet("carried_figures", recordings, np.array(labels), np.array(people))


def _waver(share: FloatArray, random: np.random.Generator) -> FloatArray:
    """Draw a slow error of the hand, ``(T, 2)``, in sizes of the figure."""
    waves = [
        random.normal(0, 0.03 / k, 2) * np.cos(np.pi * k * share[:, None] + random.uniform(0, 6))
        for k in range(1, 5)
    ]
    return np.asarray(np.sum(waves, axis=0))


def carry_recorded(recorded: RecordedSet, random: np.random.Generator) -> RecordedSet:
    """Give every person of a set of hands a body."""
    people = {str(name): Person.draw(random) for name in np.unique(recorded.people)}
    usual = float(np.median([np.ptp(poses.xy, axis=0).max() for poses in recorded.recordings]))
    scale = np.array([1, -1]) * EXTENT / usual
    recordings = [
        carry((poses.xy[:, 0] - np.array(FRAME) / 2) * scale, people[str(person)], random)
        for poses, person in zip(recorded.recordings, recorded.people, strict=True)
    ]
    return RecordedSet(f"carried_{recorded.name}", recordings, recorded.labels, recorded.people)


def carry(path: FloatArray, person: Person, random: np.random.Generator) -> PoseSequence:
    """Let a person raise the arm, draw, and lower it.

    Parameters
    ----------
    path
        ``(T, 2)`` metres at `RATE`, y up, about the middle of the person's place of drawing.
    person
        Who draws.
    random
        Of the take.

    """
    middle = person.place + random.normal(0, 0.02, 3)
    away = 0.1 * random.normal() * path[:, :1]
    drawn = np.concatenate([path * person.scale, away], axis=1) + middle
    hanging = np.array([-0.06, -0.56, -0.04]) * person.size
    raising, lowering = person.raising * random.uniform(0.8, 1.2, 2)
    before, after = random.uniform(0.2, 0.9, 2)
    wrist = np.concatenate(
        [
            _reach(hanging, hanging, before),
            _reach(hanging, drawn[0], raising),
            drawn,
            _reach(drawn[-1], hanging, lowering),
            _reach(hanging, hanging, after),
        ]
    )
    return _film(_smooth(wrist), hanging, person, random)


def _reach(start: FloatArray, end: FloatArray, seconds: float) -> FloatArray:
    """Return ``(T, 3)`` places from `start` to just before `end`."""
    share = np.linspace(0, 1, max(int(seconds * RATE), 2), endpoint=False)[:, None]
    return np.asarray(start + (end - start) * share**2 * (3 - 2 * share))


def _smooth(path: FloatArray) -> FloatArray:
    """Round the corners between one movement and the next."""
    kernel = np.exp(-0.5 * (np.arange(-4, 5) / 1.5) ** 2)
    padded = np.pad(path, ((4, 4), (0, 0)), mode="edge")
    columns = [np.convolve(column, kernel / kernel.sum(), "valid") for column in padded.T]
    return np.stack(columns, axis=1)


def _film(
    wrist: FloatArray, hanging: FloatArray, person: Person, random: np.random.Generator
) -> PoseSequence:
    """Return the body as the camera sees it; `wrist`: ``(T, 3)`` from the right shoulder."""
    size, count = person.size, len(wrist)
    sway = np.cumsum(random.normal(0, 0.0015, (count, 3)), axis=0)
    shoulders = sway + person.lean * (wrist - hanging) * (1, 0.2, 1)
    left, right = (shoulders + np.array([side * 0.18, 0.25, 0]) * size for side in (1, -1))
    upper, lower = 0.29 * size, 0.26 * size
    reach = np.linalg.norm(wrist, axis=1, keepdims=True)
    arm = wrist * np.minimum(1, 0.985 * (upper + lower) / np.maximum(reach, 1e-6))
    elbow = _place_elbow(arm, upper, lower, person.swivel + random.normal(0, 0.1))
    world = np.stack(
        [
            left,
            right,
            left + np.array([0.04, -0.29, 0]) * size,
            right + elbow,
            left + np.array([0.06, -0.55, -0.03]) * size,
            right + arm,
            *(sway + np.array([side * 0.1, -0.25, 0]) * size for side in (1, -1)),
        ],
        axis=1,
    )
    seen = world + random.normal(0, NOISE, world.shape) + (person.beside, 0.1, person.before)
    return PoseSequence(
        landmarks=JOINTS,
        xy=seen[..., :2] * (1, -1) / seen[..., 2:] * FOCAL + np.array(FRAME) / 2,
        time=np.arange(count) / RATE,
        frame_size=FRAME,
    )


def _place_elbow(arm: FloatArray, upper: float, lower: float, swivel: float) -> FloatArray:
    """Return ``(T, 3)`` elbows from the shoulder, on the circle that the arm's lengths allow."""
    reach = np.linalg.norm(arm, axis=1, keepdims=True)
    along = arm / reach
    share = (upper**2 - lower**2 + reach**2) / (2 * reach)
    radius = np.sqrt(np.maximum(upper**2 - share**2, 0))
    down = np.array([-np.sin(swivel), -np.cos(swivel), 0.2])
    aside = down - (along @ down)[:, None] * along
    aside /= np.maximum(np.linalg.norm(aside, axis=1, keepdims=True), 1e-6)
    return np.asarray(share * along + radius * aside)
