"""Elastic matching: how far sequences lie apart when each may run ahead of the other for a while.

Dynamic time warping (Sakoe and Chiba 1978) between one query and many references at once. The
recurrence goes along anti-diagonals, on which no cell depends on another one: each of the 2N - 1
diagonals is one array operation over all references.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import prod

import numpy as np
import numpy.typing as npt

from app.recognition.poses import FloatArray


def elastic_distances(query: FloatArray, references: FloatArray, band: int) -> FloatArray:
    """Measure the cost of the best alignment of a query with each reference.

    Parameters
    ----------
    query
        ``(N, D)``, one vector a step. NaN: this component of the vector is not known; it is left
        out, and what is known of the two vectors stands for the whole.
    references
        ``(M, N, D)``.
    band
        Most steps that one sequence may be ahead of the other (Sakoe and Chiba's window).

    Returns
    -------
    ``(M,)``: squared Euclidean distances summed along the alignment over N, so that it does not
    grow with the number of steps; infinite where nothing can be compared.

    """
    return alignment_costs(squared_distances(query, references), band)


def alignment_costs(costs: FloatArray, band: int) -> FloatArray:
    """Measure the cost of the best alignment of steps, for many pairs of sequences at once.

    Parameters
    ----------
    costs
        ``(..., N, N, M)``: of each step of the one sequence against each of the other, for M pairs.
    band
        As for `elastic_distances`.

    Returns
    -------
    ``(..., M)``: costs summed along the alignment over N.

    """
    *points_of_view, steps, _, pairs = costs.shape
    cells = costs.reshape(prod(points_of_view), steps * steps, pairs)
    # Row `offset + band + 1` is the cell with `i - j = offset`; the outer two rows stay infinite.
    total = np.full((len(cells), 2 * band + 3, pairs), np.inf)
    total[:, band + 1] = cells[:, 0]
    for diagonal in _diagonals(steps, band):
        # A row was last written two diagonals ago (both ran on), its neighbours one ago.
        best = np.minimum(total[:, diagonal.one], total[:, diagonal.other])
        np.minimum(best, total[:, diagonal.both], out=best)
        np.add(best, cells[:, diagonal.cells], out=total[:, diagonal.both])
    return np.asarray((total[:, band + 1] / steps).reshape(*points_of_view, pairs))


@dataclass(frozen=True)
class _Diagonal:
    """Where the cells of an anti-diagonal within the band lie.

    Attributes
    ----------
    both, one, other
        Rows of the totals: its own, and those of the neighbours on the diagonal before.
    cells
        Of the costs, one row a pair of steps.

    """

    both: slice
    one: slice
    other: slice
    cells: slice


@lru_cache(maxsize=64)
def _diagonals(steps: int, band: int) -> tuple[_Diagonal, ...]:
    """Return the anti-diagonals after the first that have a cell within the band."""
    found = []
    for diagonal in range(1, 2 * steps - 1):
        reach = min(band, diagonal, 2 * steps - 2 - diagonal)
        reach -= (reach + diagonal) % 2  # offset and diagonal are both even or both odd
        if reach < 0:
            continue
        first, last = band + 1 - reach, band + 2 + reach
        start = (diagonal - reach) // 2 * steps + (diagonal + reach) // 2
        # Along an anti-diagonal i grows and j falls by one.
        stop = start + reach * (steps - 1) + 1
        found.append(
            _Diagonal(
                both=slice(first, last, 2),
                one=slice(first - 1, last - 1, 2),
                other=slice(first + 1, last + 1, 2),
                cells=slice(start, stop, max(steps - 1, 1)),
            )
        )
    return tuple(found)


def elastic_pairs(query: FloatArray, reference: FloatArray, band: int) -> npt.NDArray[np.intp]:
    """Find the best alignment itself, for one reference: which step corresponds to which.

    Parameters
    ----------
    query, reference
        ``(N, D)`` each, with NaN as for `elastic_distances`.
    band
        As for `elastic_distances`.

    Returns
    -------
    ``(S, 2)``: steps of the query and of the reference, from the first of both to the last of
    both, of which each or either runs on. The costs of these pairs add up to the distance; of
    equally good alignments the one in which both run on is taken.

    """
    costs = squared_distances(query, reference[None])[:, :, 0]
    steps = len(query)
    # Row and column 0 stand before the first steps.
    total = np.full((steps + 1, steps + 1), np.inf)
    total[0, 0] = 0.0
    for i in range(steps):
        for j in range(max(0, i - band), min(steps, i + band + 1)):
            before = min(total[i, j], total[i, j + 1], total[i + 1, j])
            total[i + 1, j + 1] = before + costs[i, j]
    pairs = [(steps, steps)]
    while pairs[-1] != (1, 1):
        i, j = pairs[-1]
        before = [cell for cell in ((i - 1, j - 1), (i - 1, j), (i, j - 1)) if min(cell) > 0]
        pairs.append(min(before, key=lambda cell: total[cell]))
    return np.array(pairs[::-1], dtype=np.intp) - 1


def squared_distances(
    query: FloatArray, references: FloatArray, out: FloatArray | None = None
) -> FloatArray:
    """Measure the squared distance of every step of the query to every step of the references.

    Parameters
    ----------
    query, references
        ``(N, D)`` and ``(M, N, D)``, with NaN as for `elastic_distances`.
    out
        Where to write the answer, contiguous: asking the system for fresh memory for each would
        take longer than the arithmetic.

    Returns
    -------
    ``(N, N, M)``, infinite where nothing can be compared.

    """
    if out is None:
        out = np.empty((len(query), len(query), len(references)))
    if np.isfinite(query).all() and np.isfinite(references).all():
        return _without_rounding(_complete(query, references, out))
    known, others_known = np.isfinite(query), np.isfinite(references)
    left, right = np.where(known, query, 0.0), np.where(others_known, references, 0.0)
    mask, others_mask = known.astype(np.float64), others_known.astype(np.float64)
    squares = (
        _products(left**2, others_mask) + _products(mask, right**2) - 2.0 * _products(left, right)
    )
    compared = _products(mask, others_mask)
    scale = np.divide(
        query.shape[1], compared, out=np.full_like(compared, np.inf), where=compared > 0
    )
    np.multiply(np.where(compared > 0, squares, 1.0), scale, out=out)
    return _without_rounding(out)


def _complete(query: FloatArray, references: FloatArray, out: FloatArray) -> FloatArray:
    """|q - r|^2 = (-2q, |q|^2, 1) . (r, 1, |r|^2): a single matrix product."""
    count, steps, size = references.shape
    left = np.concatenate([-2 * query, (query**2).sum(1)[:, None], np.ones((len(query), 1))], 1)
    right = np.ones((size + 2, steps, count))
    right[:size] = references.transpose(2, 1, 0)
    np.einsum("dnm,dnm->nm", right[:size], right[:size], out=right[-1])
    columns = steps * count
    np.matmul(left, right.reshape(size + 2, columns), out=out.reshape(len(query), columns))
    return out


def _products(left: FloatArray, right: FloatArray) -> FloatArray:
    """Inner products ``(N, N, M)`` of the vectors of ``(N, D)`` and ``(M, N, D)``."""
    count, steps, size = right.shape
    columns = np.ascontiguousarray(right.transpose(2, 1, 0)).reshape(size, steps * count)
    return (left @ columns).reshape(len(left), steps, count)


def _without_rounding(squares: FloatArray) -> FloatArray:
    """Undo, in place, what rounding leaves of differences of nearly equal sums."""
    squares[squares < 1e-12] = 0.0
    return squares
