"""Variation: random variants of demonstrations, as further takes by the same or another person.

`draw_variants` varies movements. As in Cabrera and Wachs (2017), the points of the figure are moved
at random and what lies between them follows smoothly; but the spreads are measured on pairs of
takes of one gesture (`SPREADS`), and a smooth random field moves all points. By the voters'
distances the variants are as close to people's takes as those of other models, or closer
(`benchmarks/studies/variants.md`).

1. **Habit**: size, slant, stretch and shear of each arm's movement about its own mean position.
2. **Waver**: a displacement along the path, a sum of cosines with random coefficients.
3. **Sway**: a slow drift of each landmark, also of those at rest. A hand's landmarks drift with
   their wrist, and about it no farther than a wrist bends.
4. **Tempo**: another duration.

All landmarks of an arm share habit and waver, each in proportion to its own motion, so that an
elbow follows its wrist. A hand turns with its forearm. No bone of an arm becomes longer than
possible (`limb_length`).

`vary_hands` varies held hands. A hand is turned in the image, seen from another side, and its
fingers are bent and spread a little otherwise. With these spreads (`HAND_SPREADS`) variants are
about as far from a demonstration as takes of divers' signs are: of the same view for the
demonstrator, of another view for another person (`benchmarks/studies/hand-shapes.md`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Final, Literal

import numpy as np
import numpy.typing as npt

from app.recognition.errors import OsgError
from app.recognition.features.motion import SIDES, parse_body_part
from app.recognition.features.trajectory_image import FINGER_BONES
from app.recognition.poses.frame import HandShape, normalize_hands
from app.recognition.poses.sequence import FloatArray, fill_all_gaps
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.limb_length import limit_limbs


@dataclass(frozen=True, kw_only=True)
class HandSpread:
    """Standard deviations of the differences between two takes of a held shape.

    Attributes
    ----------
    roll
        Degrees in the image.
    turn
        Degrees about an axis in the image, as if the hand were flat.
    bend
        Degrees by which each bone of a finger changes its direction.
    error
        Error of each landmark, in sizes of the hand.

    """

    roll: float
    turn: float
    bend: float
    error: float


HAND_SPREADS: Final = MappingProxyType(
    {
        "same": HandSpread(roll=6.0, turn=12.0, bend=4.0, error=0.02),
        "another": HandSpread(roll=10.0, turn=32.0, bend=13.0, error=0.04),
    }
)
"""By performer of the variant: the demonstrator, or another person."""


def vary_hands(
    hands: Sequence[HandShape], count: int, spread: HandSpread, *, seed: int = 0
) -> list[tuple[HandShape, ...]]:
    """Draw variants of held hands; a larger count begins with the same ones."""
    random = np.random.default_rng(seed)
    return [tuple(_vary(hand, spread, random) for hand in hands) for _ in range(count)]


def _vary(hand: HandShape, spread: HandSpread, random: np.random.Generator) -> HandShape:
    bent = _bend(hand.xy, np.radians(spread.bend) * random.standard_normal(len(FINGER_BONES)))
    axis = random.uniform(0, np.pi)
    narrowed = np.cos(np.radians(spread.turn) * random.standard_normal())
    along = np.array([np.cos(axis), np.sin(axis)])
    seen = bent + (narrowed - 1) * np.outer(bent @ along, along)
    seen = seen + spread.error * random.standard_normal(seen.shape)
    made = HandShape(hand.side, normalize_hands(seen[None])[0])
    return made.turn(spread.roll * random.standard_normal())


def _bend(xy: FloatArray, angles: FloatArray) -> FloatArray:
    """Turn every bone about its inner end, together with what lies beyond it."""
    bent = xy.copy()
    turned = 0.0
    for (start, end), angle in zip(FINGER_BONES, angles.tolist(), strict=True):
        turned = angle if start == 0 else turned + angle
        # The palm is one piece: a finger bends from its knuckle on.
        by = 0.0 if start == 0 else turned
        x, y = xy[end] - xy[start]
        cosine, sine = np.cos(by), np.sin(by)
        bent[end] = bent[start] + (cosine * x - sine * y, sine * x + cosine * y)
    return bent


Person = Literal["same", "another"]


@dataclass(frozen=True, kw_only=True)
class Spread:
    """Standard deviations of the differences between two takes of a gesture.

    Attributes
    ----------
    tempo
        Doublings of the duration.
    size
        Doublings of the size.
    slant
        Rotation in radians.
    stretch
        Doublings of width, with as many halvings of height.
    shear
        Sideways shift per height.
    waver
        Displacement along the path, x or y, in sizes of the landmark's movement (root of its mean
        squared distance from its mean position).
    care
        Natural logarithm of the factor on a take's waver, as people are more or less careful.
    sway
        Coefficient of each cosine of a landmark's own drift, in sizes of the whole movement.
    """

    tempo: float
    size: float
    slant: float
    stretch: float
    shear: float
    waver: float
    care: float
    sway: float


SPREADS: Final[Mapping[Person, Spread]] = MappingProxyType(
    {
        "same": Spread(
            tempo=0.17,
            size=0.19,
            slant=0.065,
            stretch=0.115,
            shear=0.06,
            waver=0.14,
            care=0.4,
            sway=0.02,
        ),
        "another": Spread(
            tempo=0.58,
            size=0.35,
            slant=0.11,
            stretch=0.195,
            shear=0.105,
            waver=0.20,
            care=0.4,
            sway=0.033,
        ),
    }
)
"""By performer of the variant: the demonstrator, or another person.

Tempo, size and habit are measured on pairs of takes by affine fits; waver, sway and care are fitted
to the voters' distances and rejections between takes (`benchmarks/studies/variants.md`,
Constants)."""

WAVES = 12
"""Cosines along the path: at the twelfth, real takes differ by 1.5 to 2.5 % of the size, and less
beyond."""

SLOW_WAVES = 6.0
"""Number of the cosine from which the strength falls off as the inverse of the number; lower ones
are equally strong."""

DRIFTS = 2
"""Cosines of a landmark's own drift, the first of them a constant offset: the body sways about once
in a gesture."""

MOST_SWAYED = 10.0
"""Largest size of a movement, in lengths of the bone, in proportion to which a hand drifts about
its wrist: both arms at their widest. Without a bound, large movements would bend wrists far."""

POINTING = 0.3
"""Visible length of a forearm, as a share of its longest, at which its hand turns by about half of
the turn in the image: a small shift turns the image of a foreshortened forearm far."""

HAND_PARTS = frozenset({"hand", "hand_tip", "index", "pinky", "thumb"})
"""Landmarks that a wrist carries, by the part of the body without its side."""

ARM_PARTS = HAND_PARTS | {"elbow", "wrist"}
"""Landmarks that an arm moves together."""

TRUNK_AND_LEGS = frozenset({"torso", "shoulder", "hip", "knee", "ankle", "heel", "foot_index"})
"""Landmarks that gestures do not use: they only sway."""


def draw_variants(
    trajectory: Trajectory, count: int, *, seed: int = 0, person: Person = "same"
) -> tuple[Trajectory, ...]:
    """Draw random variants of a demonstration.

    They differ from the demonstration as much as another take does, and from each other by more
    than takes do.

    Parameters
    ----------
    trajectory
        The demonstration. Landmarks that are not seen (NaN) are not seen in its variants either.
    count
        How many; a larger count begins with the same variants.
    seed
        Of the random generator; the same seed gives the same variants.
    person
        Who performs: the demonstrator, or another person.

    Returns
    -------
    `count` trajectories with the demonstration's landmarks, unit and number of moments, from
    second 0 on. What does not move varies in tempo alone; a single moment does not vary. For a held
    hand shape, or two in sequence, only the hands vary; for a movement, its
    moving hands vary as well.

    Raises
    ------
    OsgError
        When `count` is negative.

    """
    if trajectory.hands:
        first = len(trajectory.hands)
        every = (*trajectory.hands, *trajectory.then_hands)
        varied = vary_hands(every, max(count, 0), HAND_SPREADS[person], seed=seed)
        return tuple(
            replace(trajectory, hands=hands[:first], then_hands=hands[first:]) for hands in varied
        )
    made = vary(trajectory, count, SPREADS[person], seed=seed)
    if not trajectory.moving_hands:
        return made
    shapes = vary_hands(trajectory.moving_hands, count, HAND_SPREADS[person], seed=seed)
    return tuple(
        replace(take, moving_hands=hands) for take, hands in zip(made, shapes, strict=True)
    )


def take_turns(performances: Sequence[Sequence[Trajectory]]) -> tuple[Trajectory, ...]:
    """Return as many takes as the shortest performance has, from each performance in turn."""
    count = min(map(len, performances))
    return tuple(performances[take % len(performances)][take] for take in range(count))


def vary(
    trajectory: Trajectory, count: int, spread: Spread, *, seed: int = 0
) -> tuple[Trajectory, ...]:
    """Draw variants with a given spread; parameters and errors as for `draw_variants`."""
    if count < 0:
        raise OsgError(f"cannot draw {count} variants: give 0 or more")
    if len(trajectory) < 2:
        return (trajectory,) * count
    xy = np.nan_to_num(fill_all_gaps(trajectory.xy, trajectory.time))
    centre = xy.mean(axis=0)
    draws = _Draws(np.random.default_rng(seed), count, len(trajectory.landmarks))
    paths = _displace(xy, trajectory.landmarks, draws, spread)
    if trajectory.unit == "extent":
        paths *= (_extent(xy) / np.maximum(_extent(paths), 1e-12))[:, None, None, None]
    paths = limit_limbs(centre + paths, trajectory)
    paths[:, ~np.isfinite(trajectory.xy).all(axis=2)] = np.nan
    lengthened = np.exp2(spread.tempo * draws["tempo"])
    elapsed = trajectory.time - trajectory.time[:1]
    return tuple(
        replace(trajectory, xy=path, time=elapsed * factor)
        for path, factor in zip(paths, lengthened, strict=True)
    )


class _Draws:
    """Random numbers of all variants, one row each, so that a larger count begins alike."""

    def __init__(self, generator: np.random.Generator, count: int, landmarks: int) -> None:
        shapes = {
            "tempo": (),
            "care": (),
            "size": (),
            "habit": (landmarks, 3),
            "waver": (landmarks, WAVES, 2),
            "sway": (landmarks, DRIFTS, 2),
        }
        sizes = [int(np.prod(shape)) for shape in shapes.values()]
        numbers = generator.standard_normal((count, sum(sizes)))
        parts = np.split(numbers, np.cumsum(sizes)[:-1], axis=1)
        self._of = {
            name: part.reshape(count, *shape)
            for (name, shape), part in zip(shapes.items(), parts, strict=True)
        }

    def __getitem__(self, name: str) -> FloatArray:
        """Return the standard normal numbers of one name, ``(count, ...)``."""
        return self._of[name]


def _displace(
    xy: FloatArray, landmarks: Sequence[str], draws: _Draws, spread: Spread
) -> FloatArray:
    """Vary paths ``(T, K, 2)``: ``(count, T, K, 2)``, relative to their mean positions in `xy`."""
    moved = xy - xy.mean(axis=0)
    leaders = _find_leaders(landmarks)
    gesturing = np.array([_may_gesture(name) for name in landmarks])
    own_size = np.sqrt((moved**2).sum(axis=2).mean(axis=0)) * gesturing
    habits = _draw_habits(draws, spread)[:, leaders]
    habits[:, ~gesturing] = np.eye(2)
    formed = np.moveaxis(np.moveaxis(moved, 0, 1) @ np.swapaxes(habits, -1, -2), 2, 1)
    way = _measure_way(moved)
    waves = np.arange(1, WAVES + 1)
    strength = 1 / np.sqrt(1 + (waves / SLOW_WAVES) ** 2)
    strength *= spread.waver / np.sqrt((strength**2).sum())
    care = np.exp(spread.care * draws["care"])[:, None, None, None]
    waver = care * _sum_cosines(way, waves, strength, draws["waver"][:, leaders])
    whole_size = np.sqrt((own_size**2).sum())
    drift = _sum_cosines(way, np.arange(DRIFTS), np.ones(DRIFTS), draws["sway"])
    wrists = _find_wrists(landmarks)
    bones = np.sqrt(((xy - xy[:, wrists]) ** 2).sum(axis=2)).mean(axis=0)
    sway = spread.sway * whole_size * drift[:, :, wrists]
    swayed = np.sqrt(2) * np.minimum(whole_size, MOST_SWAYED * bones)  # two landmarks drift
    varied = _turn_hands(xy, formed + own_size[:, None] * waver + sway, landmarks, wrists)
    return np.asarray(varied + spread.sway * swayed[:, None] * drift)


def _turn_hands(
    xy: FloatArray, varied: FloatArray, landmarks: Sequence[str], wrists: npt.NDArray[np.intp]
) -> FloatArray:
    """Turn hands with their forearms; a hand whose forearm is not seen is unchanged.

    Parameters
    ----------
    xy
        ``(T, K, 2)``: the demonstration without gaps; 0 for landmarks that are never seen.
    varied
        ``(count, T, K, 2)``: variants, relative to the mean positions in `xy`.
    landmarks, wrists
        The K names, and `_find_wrists` of them.

    """
    parts = [parse_body_part(name) for name in landmarks]
    seen = np.asarray(xy.any(axis=(0, 2)))
    centre = xy.mean(axis=0)
    carried = varied.copy()
    for wrist in np.unique(wrists[wrists != np.arange(len(landmarks))]):
        elbow_part = parts[wrist].removesuffix("wrist") + "elbow"
        elbow = parts.index(elbow_part) if elbow_part in parts else wrist
        if elbow == wrist or not (seen[wrist] and seen[elbow]):
            continue
        shown = _complex(xy[:, wrist] - xy[:, elbow])
        turned = _complex(
            varied[:, :, wrist] - varied[:, :, elbow] + (centre[wrist] - centre[elbow])
        )
        turn = turned * shown.conj() + (POINTING * np.abs(shown).max()) ** 2
        turn /= np.maximum(np.abs(turn), 1e-12)
        shift = varied[:, :, wrist] - (xy[:, wrist] - centre[wrist])
        for index in np.flatnonzero((wrists == wrist) & (np.arange(len(landmarks)) != wrist)):
            rotated = _complex(xy[:, index] - xy[:, wrist]) * (turn - 1)
            carried[:, :, index] = xy[:, index] - centre[index] + shift
            carried[:, :, index, 0] += rotated.real
            carried[:, :, index, 1] += rotated.imag
    return carried


def _complex(vectors: FloatArray) -> npt.NDArray[np.complex128]:
    """Return ``(..., 2)`` as complex numbers, which a unit complex factor rotates."""
    return np.asarray(vectors[..., 0] + 1j * vectors[..., 1])


def _sum_cosines(
    way: FloatArray, numbers: npt.NDArray[np.intp], strength: FloatArray, draws: FloatArray
) -> FloatArray:
    """Sum cosines along the path, ``(count, T, K, 2)``, with random coefficients.

    Parameters
    ----------
    way
        ``(T,)`` share of the path.
    numbers, strength
        ``(W,)`` half waves along the path, and the standard deviations of their coefficients.
    draws
        ``(count, K, W, 2)`` standard normal numbers.

    """
    count, landmarks, waves, _ = draws.shape
    cosines = np.cos(np.pi * numbers * way[:, None]) * strength
    flat = np.moveaxis(draws, 2, 1).reshape(count, waves, 2 * landmarks)
    return np.asarray((cosines @ flat).reshape(count, len(way), landmarks, 2))


def _draw_habits(draws: _Draws, spread: Spread) -> FloatArray:
    """Return ``(count, K, 2, 2)`` matrices that scale, rotate, stretch and shear."""
    habit = draws["habit"]
    slant = spread.slant * habit[..., 0]
    stretch = np.exp2(spread.stretch * habit[..., 1])
    shear = spread.shear * habit[..., 2]
    turn = np.stack([np.cos(slant), -np.sin(slant), np.sin(slant), np.cos(slant)], axis=-1)
    bent = np.stack([stretch, shear, np.zeros_like(shear), 1 / stretch], axis=-1)
    square = (*slant.shape, 2, 2)
    scale = np.exp2(spread.size * draws["size"])[:, None, None, None]
    return np.asarray(scale * (turn.reshape(square) @ bent.reshape(square)))


def _find_leaders(landmarks: Sequence[str]) -> npt.NDArray[np.intp]:
    """Return ``(K,)``: the index of the landmark whose draws each one shares, its arm's first."""
    first: dict[str, int] = {}
    return np.array(
        [first.setdefault(_name_limb(name), index) for index, name in enumerate(landmarks)],
        dtype=np.intp,
    )


def _find_wrists(landmarks: Sequence[str]) -> npt.NDArray[np.intp]:
    """Return ``(K,)``: the index of the wrist that carries each of a hand's landmarks.

    A landmark that is no part of a hand, or whose wrist is missing, has its own index.
    """
    parts = [parse_body_part(name) for name in landmarks]
    index = {part: number for number, part in enumerate(parts)}
    carriers = []
    for number, part in enumerate(parts):
        bare = _without_side(part)
        wrist = part.removesuffix(bare) + "wrist"
        carriers.append(index.get(wrist, number) if bare in HAND_PARTS else number)
    return np.array(carriers, dtype=np.intp)


def _may_gesture(landmark: str) -> bool:
    """Return whether a landmark may carry a gesture."""
    return _without_side(parse_body_part(landmark)) not in TRUNK_AND_LEGS


def _name_limb(landmark: str) -> str:
    """Return the name of the arm that a landmark belongs to, or the landmark's own name."""
    part = parse_body_part(landmark)
    bare = _without_side(part)
    return part.removesuffix(bare) + "arm" if bare in ARM_PARTS else landmark


def _without_side(part: str) -> str:
    """Return the name of a body part without its side."""
    return next((part.removeprefix(side) for side in SIDES if part.startswith(side)), part)


def _measure_way(xy: FloatArray) -> FloatArray:
    """Return ``(T,)``: the share of the landmarks' joint path up to each moment."""
    steps = np.sqrt((np.diff(xy, axis=0) ** 2).sum(axis=(1, 2)))
    travelled = np.concatenate([[0.0], np.cumsum(steps)])
    return np.asarray(travelled / max(travelled[-1], 1e-12))


def _extent(xy: FloatArray) -> FloatArray:
    """Return ``(...,)``: the longest diagonal of a landmark's box in ``(..., T, K, 2)``."""
    return np.asarray(np.linalg.norm(np.ptp(xy, axis=-3), axis=-1).max(axis=-1))
