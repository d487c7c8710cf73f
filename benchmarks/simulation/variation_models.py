"""Variation models: our model of how takes differ, and models from the literature.

The other models change the shape of the path in their own manner; habit, sway and tempo are ours,
except in stochastic resampling.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.simulation.variation import SPREADS, Person, draw_variants, vary

Model = Callable[[Trajectory, int, int, Person], tuple[Trajectory, ...]]
"""Draws variants of a demonstration, given their number, the seed and the person."""

RESAMPLED_POINTS, REMOVED_POINTS, INTERVAL_VARIANCE = 16, 2, 0.25
"""Parameters of stochastic resampling, as chosen by its authors."""

CORNER = 0.35
"""Least turn at a salient point, in radians over two of 32 steps; it also exceeds its
neighbours'."""

POINT_SPREAD: Mapping[Person, float] = {"same": 0.14, "another": 0.20}
"""Spread of salient points, in sizes of the movement: the same as our waver."""

STROKE_SPREAD: Mapping[Person, float] = {"same": 0.2, "another": 0.3}
"""Spread of a stroke's logarithmic length and of its direction: the values nearest to people."""

STROKE_WAVES, RISING_WAVES = 16, 4.0
"""Cosines of the strokes' variation, and the one at which it rises: the values nearest to
people."""


def ours(shown: Trajectory, count: int, seed: int, person: Person) -> tuple[Trajectory, ...]:
    """Draw variants as for the health report."""
    return draw_variants(shown, count, seed=seed, person=person)


def stochastically_resampled(
    shown: Trajectory, count: int, seed: int, _: Person
) -> tuple[Trajectory, ...]:
    """Cut the path into random intervals and make them equally long (Taranta et al. 2016, GPSR)."""
    random = np.random.default_rng(seed)
    flat, travelled = _flat(shown), _measure_way(shown)
    found = []
    for _take in range(count):
        points = RESAMPLED_POINTS + REMOVED_POINTS
        intervals = 1 + random.uniform(0, np.sqrt(12 * INTERVAL_VARIANCE), points - 1)
        at = np.concatenate([[0], np.cumsum(intervals)]) / intervals.sum() * travelled[-1]
        at = np.sort(random.choice(at, RESAMPLED_POINTS, replace=False))
        cuts = np.stack([np.interp(at, travelled, column) for column in flat.T], axis=1)
        vectors = np.diff(cuts, axis=0)
        vectors /= np.linalg.norm(vectors, axis=1, keepdims=True) + 1e-9
        path = np.concatenate([np.zeros_like(vectors[:1]), np.cumsum(vectors, axis=0)])
        path -= path.mean(axis=0)
        path *= np.sqrt((flat - flat.mean(axis=0)).var(axis=0).sum() / path.var(axis=0).sum())
        moments = np.interp(at, travelled, shown.time)
        xy = (path + flat.mean(axis=0)).reshape(-1, *shown.xy.shape[1:])
        take = replace(shown, xy=xy, time=moments - moments[0])
        found.append(take.resample_in_time(len(shown)))
    return tuple(found)


def salient_points(
    shown: Trajectory, count: int, seed: int, person: Person
) -> tuple[Trajectory, ...]:
    """Move ends and corners, with minimum-jerk strokes between them (Cabrera and Wachs 2017)."""
    random = np.random.default_rng(seed)
    found = []
    for take in _draw_steady(shown, count, seed, person):
        way = _measure_way(take)
        places = _corners(take) * way[-1]
        size = np.sqrt(_flat(take).var(axis=0).sum())
        offsets = random.normal(0, POINT_SPREAD[person] * size, (len(places), *take.xy.shape[1:]))
        before = np.clip(np.searchsorted(places, way, side="right") - 1, 0, len(places) - 2)
        share = np.clip((way - places[before]) / np.diff(places)[before], 0, 1)
        share = (share**3 * (10 - 15 * share + 6 * share**2))[:, None, None]
        moved = (1 - share) * offsets[before] + share * offsets[before + 1]
        found.append(replace(take, xy=take.xy + moved))
    return tuple(found)


def varied_strokes(
    shown: Trajectory, count: int, seed: int, person: Person
) -> tuple[Trajectory, ...]:
    """Vary the length and direction of successive strokes (after Plamondon 1995).

    Sigma-lognormal variation changes each stroke's amplitude and angle; here both vary smoothly
    along the way, so that no strokes need to be found.
    """
    random = np.random.default_rng(seed)
    numbers = np.arange(1, STROKE_WAVES + 1)
    strength = np.sqrt(1 + (numbers / RISING_WAVES) ** 2)
    strength *= STROKE_SPREAD[person] * np.sqrt(2 / (strength**2).sum())
    found = []
    for take in _draw_steady(shown, count, seed, person):
        way = _measure_way(take) / _measure_way(take)[-1]
        middle = (way[1:] + way[:-1]) / 2
        draws = random.standard_normal((STROKE_WAVES, 2)) @ (1, 1j)
        care = np.exp(SPREADS[person].care * random.standard_normal())
        changed = np.exp(care * (np.cos(np.pi * numbers * middle[:, None]) * strength) @ draws)
        plane = take.xy @ (1, 1j)
        steps = np.diff(plane, axis=0) * changed[:, None]
        path = np.concatenate([np.zeros_like(steps[:1]), np.cumsum(steps, axis=0)])
        path += plane.mean(axis=0) - path.mean(axis=0)
        found.append(replace(take, xy=np.stack([path.real, path.imag], axis=-1)))
    return tuple(found)


MODELS: dict[str, Model] = {
    "ours": ours,
    "gpsr": stochastically_resampled,
    "salient": salient_points,
    "strokes": varied_strokes,
}


def scaled(factor: float) -> Model:
    """Return our model with the spreads of all shape parameters multiplied by a factor."""

    def model(shown: Trajectory, count: int, seed: int, person: Person) -> tuple[Trajectory, ...]:
        spread = SPREADS[person]
        shape = ("slant", "stretch", "shear", "waver", "sway")
        larger = replace(spread, **{name: factor * getattr(spread, name) for name in shape})
        return vary(shown, count, larger, seed=seed)

    return model


def _draw_steady(
    shown: Trajectory, count: int, seed: int, person: Person
) -> tuple[Trajectory, ...]:
    return vary(shown, count, replace(SPREADS[person], waver=0.0), seed=seed)


def _flat(shown: Trajectory) -> FloatArray:
    """Return ``(T, 2 K)`` without the gaps that `fill_gaps` leaves; these stay at 0."""
    return np.nan_to_num(shown.fill_gaps().xy).reshape(len(shown), -1)


def _measure_way(shown: Trajectory) -> FloatArray:
    """Return ``(T,)``, strictly increasing: the length of the joint path so far."""
    steps = np.linalg.norm(np.diff(_flat(shown), axis=0), axis=1)
    return np.concatenate([[0.0], np.cumsum(steps + 1e-9)])


def _corners(shown: Trajectory) -> FloatArray:
    """Return the shares of the way at which the ends and the corners lie, in ascending order."""
    even = _flat(shown.resample_in_arc_length(32))
    steps = even[2:] - even[:-2]
    units = steps / (np.linalg.norm(steps, axis=1, keepdims=True) + 1e-9)
    turned = np.arccos(np.clip((units[2:] * units[:-2]).sum(axis=1), -1, 1))
    before, after = np.roll(turned, 1), np.roll(turned, -1)
    sharp = np.flatnonzero((turned > CORNER) & (turned >= before) & (turned > after))
    return np.concatenate([[0.0], (sharp + 2) / 31, [1.0]])
