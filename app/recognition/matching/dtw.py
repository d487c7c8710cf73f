"""Dynamic time warping (DTW) between one query and many references (Sakoe and Chiba 1978).

`step_distances` computes the distances of all pairs of steps as roots of matrix products:
``|q - r|^2 = |q|^2 - 2 q . r + |r|^2`` is the product of ``(-2 q, |q|^2, 1)`` and
``(r, 1, |r|^2)``, so that one multiplication of matrices compares a query with many references.
`dtw_kernel` finds the best alignments of these costs, for `dtw_distances`, `dtw_pairs` and
references that are prepared once (`DtwReferences`, `DtwBatch`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from app.recognition.matching.dtw_kernel import (
    StepCosts,
    compute_alignment_costs,
    count_half_steps,
)
from app.recognition.poses.sequence import FloatArray

Precision = TypeVar("Precision", np.float32, np.float64)

ROUNDING = {"float64": 1e-12, "float32": 4e-6}
"""Squared distances below it are rounding errors of nearly equal sums and set to 0, by precision:
descriptors have a mean square of about 1, and steps of two takes are much farther apart."""


def step_distances(
    query: FloatArray,
    references: FloatArray,
    out: npt.NDArray[np.float32 | np.float64] | None = None,
) -> npt.NDArray[np.float32 | np.float64]:
    """Compute the distance of every step of the query to every step of the references.

    Parameters
    ----------
    query, references
        ``(..., N, D)`` and ``(..., M, N, D)``. NaN: an unknown component, which is left out; the
        known components are scaled to stand for the whole vector.
    out
        Array to write the result to, in its own precision; the last three axes contiguous.

    Returns
    -------
    ``(..., N, N, M)``, infinite where nothing can be compared.

    """
    *leading, count, steps, _ = references.shape
    flat = (*leading, query.shape[-2], steps * count)
    if out is None:
        out = np.empty((*leading, query.shape[-2], steps, count))
    squares = out.reshape(flat)
    if query.shape[-1] and np.isfinite(query).all() and np.isfinite(references).all():
        np.matmul(for_query(query), _flatten(for_references(references)), out=squares)
    else:
        _compute_partial(query, references, squares)
    take_root(squares)
    return out


def take_root(squares: npt.NDArray[np.float32 | np.float64]) -> None:
    """Replace squared distances by distances, in their own precision; rounding errors become 0."""
    squares[squares < ROUNDING[squares.dtype.name]] = 0.0
    np.sqrt(squares, out=squares)


def for_query(query: npt.NDArray[Precision]) -> npt.NDArray[Precision]:
    """Return the left side of the product, ``(..., N, D + 2)``, of ``(..., N, D)``."""
    *leading, size = query.shape
    left = np.empty((*leading, size + 2), dtype=query.dtype)
    left[..., size + 1] = 1.0
    np.multiply(query, -2.0, out=left[..., :size])
    np.vecdot(query, query, out=left[..., size])
    return left


def for_references(references: npt.NDArray[Precision]) -> npt.NDArray[Precision]:
    """Return its right side, ``(..., D + 2, N, M)``, of ``(..., M, N, D)``."""
    *leading, count, steps, size = references.shape
    right = np.ones((*leading, size + 2, steps, count), dtype=references.dtype)
    right[..., :size, :, :] = np.moveaxis(references, (-1, -2, -3), (-3, -2, -1))
    np.einsum("...mnd,...mnd->...nm", references, references, out=right[..., size + 1, :, :])
    return right


def _compute_partial(
    query: FloatArray, references: FloatArray, out: npt.NDArray[np.float32 | np.float64]
) -> None:
    """Compute the squared distances, ``(..., N, N M)``, of vectors with unknown components."""
    known, others_known = np.isfinite(query), np.isfinite(references)
    left, right = np.where(known, query, 0.0), np.where(others_known, references, 0.0)
    mask, others_mask = known.astype(np.float64), _transpose(others_known.astype(np.float64))
    turned = _transpose(right)
    squares = left**2 @ others_mask + mask @ turned**2 - 2.0 * (left @ turned)
    compared = mask @ others_mask
    scale = np.divide(
        query.shape[-1], compared, out=np.full_like(compared, np.inf), where=compared > 0
    )
    np.multiply(np.where(compared > 0, squares, 1.0), scale, out=out)


def _transpose(references: FloatArray) -> FloatArray:
    """Reshape ``(..., M, N, D)`` to ``(..., D, N M)``."""
    turned = np.ascontiguousarray(np.moveaxis(references, (-1, -2, -3), (-3, -2, -1)))
    return _flatten(turned)


def _flatten(sides: FloatArray) -> FloatArray:
    """Flatten the steps of all references: ``(..., D, N, M)`` to ``(..., D, N M)``."""
    *leading, steps, count = sides.shape
    return sides.reshape(*leading, steps * count)


BAND = 8
"""Steps of 32 that one movement may be ahead of the other (Sakoe-Chiba band): a quarter, where
accuracy on drawn figures levels off; without a band, a loop could match a corner."""

OPEN_ENDS = 3
"""Steps of 32 at either end of either movement that may be left out: a tenth. A part of the way to
or from the gesture, on one side only, then does not decide (`benchmarks/studies/cutting.md`)."""


def dtw_distances(query: FloatArray, references: FloatArray, band: int) -> FloatArray:
    """Compute the DTW distance of a query to each reference: the cost of the best alignment.

    Parameters
    ----------
    query
        ``(N, D)``, one vector a step. NaN: an unknown component, which is left out; the known
        components are scaled to stand for the whole vector.
    references
        ``(M, N, D)``.
    band
        Most steps that one sequence may be ahead of the other (Sakoe and Chiba's window).

    Returns
    -------
    ``(M,)``: Euclidean distances of the steps summed along the alignment, divided by N, so that
    they do not grow with the number of steps; infinite where nothing can be compared.

    """
    count = count_half_steps(len(query), band)
    costs = step_distances(_from_both_ends(query, count), _from_both_ends(references, count))
    return compute_alignment_costs(costs, len(query), band)


@dataclass(frozen=True, eq=False)
class DtwReferences:
    """DTW references: sequences prepared once for comparison with many queries.

    The distances are those of `dtw_distances`, but components that are unknown at all steps of
    the query, or of all references, are left out first.

    Attributes
    ----------
    sequences
        ``(R, N, D)``, with NaN as for `dtw_distances`.
    band
        As for `dtw_distances`.
    ends
        Steps at either end of either sequence that cost nothing where the other one has not begun,
        or has ended.

    """

    sequences: FloatArray
    band: int
    ends: int = 0

    def distances(self, query: FloatArray) -> FloatArray:
        """Return the DTW distances of ``(N, D)`` to all references, ``(R,)``."""
        return compute_alignment_costs(self.step_costs(query), len(query), self.band)

    def step_costs(
        self,
        query: FloatArray,
        rows: npt.NDArray[np.intp] | None = None,
        out: StepCosts | None = None,
    ) -> StepCosts:
        """Compute the costs of a query's steps against some references, from both ends.

        Parameters
        ----------
        query
            ``(N, D)``.
        rows
            Indices of M of the references; all when not given.
        out
            Array to write the result to; allocating memory would take longer than the arithmetic.

        Returns
        -------
        ``(2, H, H, M)``: distances of the first H steps, and of the last H in reverse
        order, for `compute_alignment_costs`; infinite where nothing is comparable.

        """
        count = count_half_steps(len(query), self.band)
        pairs = len(self.sequences) if rows is None else len(rows)
        if out is None:
            out = np.empty((2, count, count, pairs), dtype=np.float32)
        if self.complete and np.isfinite(query[:, self.known]).all():
            known_steps = query[:, self.known].astype(np.float32)
            left = for_query(_from_both_ends(known_steps, count))
            right = self._sides_of(rows).reshape(2, -1, count * pairs)
            np.matmul(left, right, out=out.reshape(2, count, count * pairs))
            take_root(out)
            return _open_ends(out, self.ends)
        references = self.sequences if rows is None else self.sequences[rows]
        known = np.isfinite(query).any(axis=0) & np.isfinite(references).any(axis=(0, 1))
        step_distances(
            _from_both_ends(query[:, known], count),
            _from_both_ends(references[..., known], count),
            out,
        )
        return _open_ends(out, self.ends)

    @cached_property
    def known(self) -> npt.NDArray[np.intp]:
        """Indices of the components that are known in any reference at any step."""
        return np.flatnonzero(np.isfinite(self.sequences).any(axis=(0, 1)))

    @cached_property
    def complete(self) -> bool:
        """Whether these components are known at all steps of all references."""
        return bool(len(self.known) and np.isfinite(self.sequences[..., self.known]).all())

    def _sides_of(self, rows: npt.NDArray[np.intp] | None) -> StepCosts:
        """Return one side of the matrix products that give the costs, ``(2, D' + 2, H, M)``."""
        if rows is None:
            return self._sides
        return np.ascontiguousarray(np.moveaxis(self.sides_by_row[rows], 0, -1))

    @cached_property
    def _sides(self) -> StepCosts:
        count = count_half_steps(self.sequences.shape[1], self.band)
        known_steps = self.sequences[..., self.known].astype(np.float32)
        return for_references(_from_both_ends(known_steps, count))

    @cached_property
    def sides_by_row(self) -> StepCosts:
        """The same with the references first, ``(R, 2, D' + 2, H)``: faster to take some rows."""
        return np.ascontiguousarray(np.moveaxis(self._sides, -1, 0))


@dataclass(frozen=True, eq=False)
class DtwBatch:
    """A batch of DTW references: the descriptors of several voters, compared together.

    Attributes
    ----------
    views
        V references, one a voter, with the same numbers of sequences and steps, and the same band.
    """

    views: tuple[DtwReferences, ...]

    def step_costs(
        self, queries: Sequence[FloatArray], rows: npt.NDArray[np.intp] | None = None
    ) -> StepCosts:
        """Compute the costs of a query's steps against some references, from both ends.

        All views are gathered and multiplied at once: each alone is so small that the calls would
        take longer than the arithmetic.

        Parameters
        ----------
        queries
            V of ``(N, D)``, one a view.
        rows
            Indices of M of the references; all when not given.

        Returns
        -------
        ``(2, V, H, H, M)``: of each view what `DtwReferences.step_costs` returns.

        """
        references, steps, _ = self.views[0].sequences.shape
        count = count_half_steps(steps, self.views[0].band)
        pairs = references if rows is None else len(rows)
        costs = np.empty((2, len(self.views), count, count, pairs), dtype=np.float32)
        alone = set(range(len(self.views)))
        if self._joined:
            known = np.concatenate(queries, axis=1).take(self._known, axis=1)
            if np.isfinite(known).all():
                self._joined_costs(known, rows, costs)
                alone -= self._joined.keys()
        for index in alone:
            self.views[index].step_costs(queries[index], rows, costs[:, index])
        return costs

    def _joined_costs(
        self, query: FloatArray, rows: npt.NDArray[np.intp] | None, costs: StepCosts
    ) -> None:
        """Write the costs of the joined views; the query is ``(N, D)``, all views side by side."""
        _, _, _, count, pairs = costs.shape
        sides = self._sides_by_row if rows is None else self._sides_by_row.take(rows, axis=0)
        right = np.ascontiguousarray(sides.transpose(1, 2, 3, 0))
        size = query.shape[1]
        powers = np.ones((2, count, 2 * size + 1), dtype=np.float32)
        steps, squares = powers[..., :size], powers[..., size:-1]
        steps[0], steps[1] = query[:count], query[: -count - 1 : -1]
        np.multiply(steps, steps, out=squares)
        left = powers @ self._left_of_powers
        for index, part in self._joined.items():
            np.matmul(
                left[..., part],
                right[:, part].reshape(2, -1, count * pairs),
                out=costs[:, index].reshape(2, count, count * pairs),
            )
            take_root(costs[:, index])
            _open_ends(costs[:, index], self.views[index].ends)

    @cached_property
    def _known(self) -> npt.NDArray[np.intp]:
        """Indices of the joined views' known components among all views side by side."""
        widths = [view.sequences.shape[-1] for view in self.views]
        starts = np.cumsum([0, *widths])
        return np.concatenate([starts[index] + self.views[index].known for index in self._joined])

    @cached_property
    def _left_of_powers(self) -> StepCosts:
        """``(2 D + 1, P)``: maps a step's known components, their squares and 1 to left sides.

        One product gives the left sides of all joined views, side by side.
        """
        size = len(self._known)
        turned = np.zeros((2 * size + 1, self._sides_by_row.shape[2]), dtype=np.float32)
        start = 0
        for part in self._joined.values():
            norm, one = part.stop - 2, part.stop - 1
            stop = start + norm - part.start
            turned[start:stop, part.start : norm] = -2.0 * np.eye(stop - start)
            turned[size + start : size + stop, norm] = 1.0
            turned[2 * size, one] = 1.0
            start = stop
        return turned

    @cached_property
    def _joined(self) -> dict[int, slice]:
        """Rows of the products' right sides by the index of each complete view."""
        joined, start = {}, 0
        for index, view in enumerate(self.views):
            if view.complete:
                joined[index] = slice(start, start + len(view.known) + 2)
                start = joined[index].stop
        return joined

    @cached_property
    def _sides_by_row(self) -> StepCosts:
        """The right sides of the joined views, one below the other."""
        return np.concatenate([self.views[index].sides_by_row for index in self._joined], axis=2)


def _open_ends(costs: StepCosts, ends: int) -> StepCosts:
    """Let the first steps of ``(..., H, H, M)`` cost nothing against the other's first step."""
    for border in (costs[..., :ends, :1, :], costs[..., :1, :ends, :]):
        np.copyto(border, 0.0, where=np.isfinite(border))
    return costs


def _from_both_ends(sequences: npt.NDArray[Precision], count: int) -> npt.NDArray[Precision]:
    """Return the first steps of ``(..., N, D)`` and the last ones reversed: ``(2, ..., H, D)``."""
    shape = (2, *sequences.shape[:-2], count, sequences.shape[-1])
    ends = np.empty(shape, dtype=sequences.dtype)
    ends[0], ends[1] = sequences[..., :count, :], sequences[..., ::-1, :][..., :count, :]
    return ends


def dtw_pairs(query: FloatArray, reference: FloatArray, band: int) -> npt.NDArray[np.intp]:
    """Find the best DTW alignment of a query with one reference: the pairs of aligned steps.

    Parameters
    ----------
    query, reference
        ``(N, D)`` each, with NaN as for `dtw_distances`.
    band
        As for `dtw_distances`.

    Returns
    -------
    ``(S, 2)``: steps of the query and of the reference, from the first of both to the last of
    both; from pair to pair one or both advance. The costs of these pairs add up to the distance;
    of equally good alignments the one in which both advance is chosen.

    """
    costs = step_distances(query, reference[None])[..., 0]
    steps = len(query)
    # Row and column 0 are before the first steps.
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
