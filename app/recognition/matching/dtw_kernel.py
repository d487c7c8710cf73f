"""DTW kernel: costs of the best alignments, from the costs of all pairs of steps.

The recurrence of dynamic time warping (Sakoe and Chiba 1978) runs along anti-diagonals, whose cells
are independent, and from both ends of the sequences at once until the halves meet: N steps of three
array operations over all pairs of sequences.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import prod
from threading import local
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from app.recognition.poses.sequence import FloatArray

StepCosts: TypeAlias = npt.NDArray[np.float32]
"""Costs in single precision, because memory traffic takes most of the time. Descriptors have a mean
square of about 1, and distances are exact to a millionth of it."""

Totals: TypeAlias = npt.NDArray[np.float32 | np.float64]


def count_half_steps(steps: int, band: int) -> int:
    """Return H, the number of steps from either end until the halves of an alignment meet."""
    return (steps - 1 + min(band, steps - 1)) // 2 + 1


def compute_alignment_costs(
    costs: npt.NDArray[np.float32 | np.float64], steps: int, band: int
) -> FloatArray:
    """Compute the cost of the best alignment, for many pairs of sequences at once.

    Parameters
    ----------
    costs
        ``(2, ..., H, H, M)``: of each step of one sequence against each of the other, for M
        pairs, first from the start, then reversed from the end; H of `count_half_steps`.
    steps, band
        N and the band, as for `dtw_distances`.

    Returns
    -------
    ``(..., M)``: costs summed along the alignment, divided by N.

    """
    _, *points_of_view, count, _, pairs = costs.shape
    views = prod(points_of_view)
    cells = costs.reshape(2 * views, count * count, pairs).transpose(1, 0, 2)
    sweep = _SWEEPS.of(views, pairs, steps, band, costs.dtype)
    for totals in sweep.totals:
        totals.fill(np.inf)
    sweep.totals[0][len(sweep.totals[0]) // 2] = 0.0  # before the first steps
    for own, one, other, before, place in sweep.diagonals:
        np.minimum(one, other, out=before)
        np.minimum(before, own, out=before)
        np.add(before, cells[place], out=own)
    if sweep.meets_in_cells:
        own[:, :views] = before[:, :views]  # where the halves meet, a cell counts once
    met = [(each[:, :views] + each[::-1, views:]).min(axis=0) for each in sweep.totals]
    least = np.asarray(np.minimum(*met), dtype=np.float64)
    return np.asarray(least.reshape(*points_of_view, pairs) / steps)


@dataclass(frozen=True, eq=False)
class _Sweep:
    """Working memory for costs of one shape, with each diagonal's slices of it.

    Prepared once, because slicing takes a fifth of the time of an alignment.

    Attributes
    ----------
    totals
        ``(offsets, 2 V, M)`` of the even and of the odd diagonals. The cells of a diagonal depend
        on those of the diagonal before, whose offsets i - j have the other parity; stored apart,
        the cells of either are contiguous.
    diagonals
        Of each, in order: its own totals; the neighbours on either side, from the diagonal before;
        room for the least of these three; and the indices of its costs.
    meets_in_cells
        Whether the last diagonal is the one in the middle, and not the one before it.
    """

    totals: tuple[Totals, Totals]
    diagonals: tuple[tuple[Totals, Totals, Totals, Totals, slice], ...]
    meets_in_cells: bool

    @classmethod
    def prepare(
        cls, views: int, pairs: int, steps: int, band: int, precision: np.dtype[Any]
    ) -> _Sweep:
        """Prepare for V views of M pairs of sequences of N steps."""
        even, odd = (
            np.empty((outer + 1, 2 * views, pairs), dtype=precision)
            for outer in _outer_offsets(band)
        )
        best = np.empty((band + 1, 2 * views, pairs), dtype=precision)
        diagonals = []
        for diagonal in (found := _diagonals(steps, band)):
            same, others = (odd, even) if diagonal.number % 2 else (even, odd)
            own = same[diagonal.own]
            neighbours = others[diagonal.one], others[diagonal.other]
            diagonals.append((own, *neighbours, best[: len(own)], diagonal.cells))
        return cls((even, odd), tuple(diagonals), found[-1].number == steps - 1)


class _Sweeps(local):
    """The last used sweeps of each thread; every sweep has its own memory."""

    def __init__(self) -> None:
        self.of = lru_cache(maxsize=4)(_Sweep.prepare)


_SWEEPS = _Sweeps()


def _outer_offsets(band: int) -> tuple[int, int]:
    """Return the smallest even and odd offsets beyond the band, where totals stay infinite."""
    return band + 1 + (band + 1) % 2, band + 1 + band % 2


@dataclass(frozen=True)
class _Diagonal:
    """Indices of the cells of an anti-diagonal within the band.

    Attributes
    ----------
    number
        i + j.
    own
        Indices in the totals with its parity.
    one, other
        Indices in the totals with the other parity: the neighbours on the diagonal before.
    cells
        Indices in the costs, one row per pair of steps.

    """

    number: int
    own: slice
    one: slice
    other: slice
    cells: slice


@lru_cache(maxsize=64)
def _diagonals(steps: int, band: int) -> tuple[_Diagonal, ...]:
    """Return the anti-diagonals with cells in the band, up to the one where the halves meet."""
    found, count, outer = [], count_half_steps(steps, band), _outer_offsets(band)
    for number in range(steps):
        reach = min(band, number)
        reach -= (reach + number) % 2  # offset and number are both even or both odd
        if reach < 0:
            continue
        first = (outer[number % 2] - reach) // 2
        one = (outer[1 - number % 2] - reach - 1) // 2
        start = (number - reach) // 2 * count + (number + reach) // 2
        # Along an anti-diagonal i grows and j falls by one.
        stop = start + reach * (count - 1) + 1
        found.append(
            _Diagonal(
                number=number,
                own=slice(first, first + reach + 1),
                one=slice(one, one + reach + 1),
                other=slice(one + 1, one + reach + 2),
                cells=slice(start, stop, max(count - 1, 1)),
            )
        )
    return tuple(found)
