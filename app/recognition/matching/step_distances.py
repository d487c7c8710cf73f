"""Step distances: distances of all steps of sequences to each other, as roots of matrix products.

``|q - r|^2 = |q|^2 - 2 q . r + |r|^2`` is the product of ``(-2 q, |q|^2, 1)`` and
``(r, 1, |r|^2)``, so that one multiplication of matrices compares a query with many references.
"""

from __future__ import annotations

from typing import TypeVar

import numpy as np
import numpy.typing as npt

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
