"""Variation: plausible other takes of one demonstration.

A gesture is shown once; how it would have looked another time, or from another person, is drawn at
random. As in Cabrera and Wachs (2017), the places that make up the figure are moved with a spread
and the movement between them is made anew, smoothly. Their spreads were set by hand for each
gesture; ours are measured on pairs of takes of the same gesture (`SPREADS`), and the places are
not chosen but all moved together, by a smooth random field along the way:

1. **Habit**: size, slant, stretch and shear of each arm's movement about its own mean place.
2. **Waver**: a displacement along the way, a sum of cosines with random coefficients, of which the
   slow ones are the strongest.
3. **Tempo and pace**: another duration, and another distribution of it over the way.
4. **Sway**: a slow drift of each landmark by itself, which also moves what rests.

All landmarks of an arm share their habit and their waver, each in proportion to its own motion, so
that an elbow follows its wrist. No bone becomes longer than a bone can look.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Final, Literal

import numpy as np
import numpy.typing as npt

from app.recognition.errors import RecognitionError
from app.recognition.limb_reach import within_reach
from app.recognition.movement import SIDES, part_of
from app.recognition.poses import FloatArray
from app.recognition.trajectory import Trajectory

Person = Literal["same", "another"]


@dataclass(frozen=True, kw_only=True)
class Spread:
    """Standard deviations of what differs between two takes of a gesture.

    Attributes
    ----------
    tempo
        Doublings of the duration.
    pace
        Natural logarithm of the local tempo, per cosine along the way.
    size
        Doublings of the size.
    slant
        Radians by which the movement is turned.
    stretch
        Doublings of width over height, half of it in each.
    shear
        Sideways shift per height.
    waver
        Root mean square of the displacement along the way, in sizes of the movement (root of its
        mean squared distance from its mean place).
    care
        Natural logarithm of a take's waver: people are more careful at some times than at others.
    sway
        Root mean square of each landmark's own drift, in sizes of the whole movement.

    """

    tempo: float
    pace: float
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
            tempo=0.22,
            pace=0.1,
            size=0.19,
            slant=0.05,
            stretch=0.09,
            shear=0.045,
            waver=0.095,
            care=0.48,
            sway=0.01,
        ),
        "another": Spread(
            tempo=0.54,
            pace=0.15,
            size=0.35,
            slant=0.085,
            stretch=0.15,
            shear=0.08,
            waver=0.14,
            care=0.48,
            sway=0.02,
        ),
    }
)
"""By whom the other take is: the person who demonstrated, or somebody else.

Measured on pairs of takes of one class: air-drawn digits, letters and commands for both, two-handed
figures and aircraft marshalling, where people are not told apart, for the second
(`docs/results.md`, Variants against people)."""

WAVES = 12
"""Cosines along the way. The displacement between real takes falls off from the fifth on; beyond
the twelfth it is a tenth of a half per cent of the movement's size."""

SLOW_WAVES = 5.0
"""Cosine from which the displacement between real takes falls off, as the inverse of its number."""

PACES = 6
"""Cosines of the pace: people slow down at corners, of which few gestures have more."""

DRIFTS = 2
"""Cosines of a landmark's own drift: the body sways about once in a gesture."""

ARM_PARTS = frozenset({"elbow", "wrist", "hand", "hand_tip", "index", "pinky", "thumb"})
"""Landmarks that an arm moves together, by the part of the body without its side."""

TRUNK_AND_LEGS = frozenset({"shoulder", "hip", "knee", "ankle", "heel", "foot_index"})
"""Landmarks that carry no gesture: they only sway."""


def variants(
    trajectory: Trajectory, count: int, *, seed: int = 0, person: Person = "same"
) -> tuple[Trajectory, ...]:
    """Draw plausible other takes of a demonstration.

    They differ from the demonstration as another take would, so that distances to them are
    distances between takes; among each other they differ by more than takes do.

    Parameters
    ----------
    trajectory
        The demonstration. A landmark that is not seen (NaN) is not seen in its variants either.
    count
        How many. The first so many of a larger number are the same.
    seed
        Of the random generator; the same seed gives the same variants.
    person
        Whose: the demonstrator's own further takes, or somebody else's.

    Returns
    -------
    `count` trajectories with the demonstration's landmarks, unit and number of moments, from
    second 0 on. A trajectory of fewer than two moments, or without motion, cannot vary but in
    tempo.

    Raises
    ------
    RecognitionError
        When `count` is negative.

    """
    if count < 0:
        raise RecognitionError(f"cannot draw {count} variants: ask for none or more")
    spread = SPREADS[person]
    xy = _bridged(trajectory)
    way = _way(xy)
    draws = _Draws(np.random.default_rng(seed), count, len(trajectory.landmarks))
    centre = xy.mean(axis=0)
    moved = xy - centre
    varied = centre + _displaced(moved, trajectory.landmarks, way, draws, spread)
    if trajectory.unit == "extent":
        varied *= (_extent(xy) / np.maximum(_extent(varied), 1e-12))[:, None, None, None]
    varied = within_reach(varied, trajectory)
    varied[:, ~np.isfinite(trajectory.xy).all(axis=2)] = np.nan
    times = _times(trajectory.time, way, draws, spread)
    return tuple(
        replace(trajectory, xy=path, time=time) for path, time in zip(varied, times, strict=True)
    )


class _Draws:
    """The random numbers of all variants, one row each, so that more variants begin alike."""

    def __init__(self, generator: np.random.Generator, count: int, landmarks: int) -> None:
        shapes = {
            "tempo": (),
            "pace": (PACES,),
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
        """Return the standard normal numbers for one purpose, ``(count, ...)``."""
        return self._of[name]


def _displaced(
    moved: FloatArray,
    landmarks: Sequence[str],
    way: FloatArray,
    draws: _Draws,
    spread: Spread,
) -> FloatArray:
    """Vary paths ``(T, K, 2)`` about their own mean places: ``(count, T, K, 2)``."""
    groups = _groups(landmarks)
    gesturing = np.array([_gestures(name) for name in landmarks])
    own_size = np.sqrt((moved**2).sum(axis=2).mean(axis=0)) * gesturing
    whole_size = float(np.sqrt((own_size**2).sum()))
    habits = _habits(draws["size"], draws["habit"], spread)[:, groups]
    habits[:, ~gesturing] = np.eye(2)
    turned = np.moveaxis(np.moveaxis(moved, 0, 1) @ np.swapaxes(habits, -1, -2), 2, 1)
    numbers = np.arange(1, WAVES + 1)
    strength = 1 / np.sqrt(1 + (numbers / SLOW_WAVES) ** 2)
    strength *= spread.waver / np.sqrt((strength**2).sum())
    care = np.exp(spread.care * draws["care"])[:, None, None, None]
    waver = care * _along(way, numbers, strength, draws["waver"][:, groups])
    drifts = np.arange(DRIFTS)
    sway = _along(way, drifts, np.full(DRIFTS, spread.sway * whole_size), draws["sway"])
    return np.asarray(turned + own_size[:, None] * waver + sway)


def _along(
    way: FloatArray, numbers: npt.NDArray[np.intp], strength: FloatArray, draws: FloatArray
) -> FloatArray:
    """Sum cosines along the way, ``(count, T, K, 2)``, with random coefficients.

    Parameters
    ----------
    way
        ``(T,)`` share of the way.
    numbers, strength
        ``(W,)`` half waves along the way, and the standard deviation of their coefficients.
    draws
        ``(count, K, W, 2)`` standard normal numbers.

    """
    count, landmarks, waves, _ = draws.shape
    cosines = np.cos(np.pi * numbers * way[:, None]) * strength
    flat = np.moveaxis(draws, 2, 1).reshape(count, waves, 2 * landmarks)
    return np.asarray((cosines @ flat).reshape(count, len(way), landmarks, 2))


def _habits(size: FloatArray, habit: FloatArray, spread: Spread) -> FloatArray:
    """Return ``(count, K, 2, 2)`` matrices that size, turn, stretch and shear."""
    slant = spread.slant * habit[..., 0]
    stretch = np.exp2(spread.stretch * habit[..., 1])
    shear = spread.shear * habit[..., 2]
    turn = np.stack([np.cos(slant), -np.sin(slant), np.sin(slant), np.cos(slant)], axis=-1)
    bent = np.stack([stretch, shear, np.zeros_like(shear), 1 / stretch], axis=-1)
    square = (*slant.shape, 2, 2)
    scale = np.exp2(spread.size * size)[:, None, None, None]
    return np.asarray(scale * (turn.reshape(square) @ bent.reshape(square)))


def _groups(landmarks: Sequence[str]) -> npt.NDArray[np.intp]:
    """Return ``(K,)``: per landmark the index of the one whose draws it shares: its arm's first."""
    first: dict[str, int] = {}
    return np.array(
        [first.setdefault(_limb(name), index) for index, name in enumerate(landmarks)],
        dtype=np.intp,
    )


def _gestures(landmark: str) -> bool:
    """Tell whether a landmark may carry a gesture."""
    return part_of(landmark).split("_", 1)[-1] not in TRUNK_AND_LEGS


def _limb(landmark: str) -> str:
    """Name the arm that a landmark belongs to, or the landmark itself."""
    part = part_of(landmark)
    for side in SIDES:
        if part.startswith(side) and part.removeprefix(side) in ARM_PARTS:
            return side + "arm"
    return landmark


def _times(time: FloatArray, way: FloatArray, draws: _Draws, spread: Spread) -> FloatArray:
    """Return ``(count, T)`` seconds: the same moments reached at another tempo and pace."""
    waves = np.cos(np.pi * np.arange(1, PACES + 1) * way[:, None])
    pace = np.exp(spread.pace * draws["pace"] @ waves.T)
    steps = np.diff(time) * (pace[:, 1:] + pace[:, :-1]) / 2
    total = steps.sum(axis=1, keepdims=True)
    wanted = np.exp2(spread.tempo * draws["tempo"])[:, None] * np.ptp(time, axis=0, keepdims=True)
    steps *= np.divide(wanted, total, out=np.ones_like(total), where=total > 0)
    return np.concatenate([np.zeros((len(steps), 1)), np.cumsum(steps, axis=1)], axis=1)


def _bridged(trajectory: Trajectory) -> FloatArray:
    """Return ``(T, K, 2)`` without gaps: bridged, held at the ends, at 0 where never seen."""
    xy = np.zeros_like(trajectory.xy)
    for index in range(len(trajectory.landmarks)):
        path = trajectory.xy[:, index]
        known = np.isfinite(path).all(axis=1)
        if known.any():
            for axis in range(2):
                xy[:, index, axis] = np.interp(
                    trajectory.time, trajectory.time[known], path[known, axis]
                )
    return xy


def _way(xy: FloatArray) -> FloatArray:
    """Return ``(T,)``: the share of the joint path of all landmarks travelled so far."""
    steps = np.sqrt((np.diff(xy, axis=0) ** 2).sum(axis=(1, 2)))
    travelled = np.concatenate([[0.0], np.cumsum(steps)])[: len(xy)]
    return np.asarray(travelled / max(travelled[-1], 1e-12)) if len(xy) else travelled


def _extent(xy: FloatArray) -> FloatArray:
    """Return ``(...,)``: the longest diagonal of a landmark's box in ``(..., T, K, 2)``."""
    return np.asarray(np.linalg.norm(np.ptp(xy, axis=-3), axis=-1).max(axis=-1))
