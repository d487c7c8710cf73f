"""Embedding: a map of a language's gestures in the plane, with similar gestures close together."""

from __future__ import annotations

import numpy as np

from app.recognition.poses.sequence import FloatArray


def embed_gestures(distances: FloatArray) -> FloatArray:
    """Embed gestures in the plane by classical multidimensional scaling (Torgerson 1952).

    Parameters
    ----------
    distances
        ``(G, G)`` >= 0, of each gesture (row) to each other one. Both directions are averaged;
        infinite ones count as the largest finite one.

    Returns
    -------
    ``(G, 2)`` in the unit of the distances, centred at 0, the wider spread along x; the best
    approximation in two dimensions. The sign of an axis is such that its farthest gesture is
    positive, so that the same distances give the same map.

    """
    finite = np.isfinite(distances)
    far = float(distances[finite].max(initial=0.0)) or 1.0
    known = np.where(finite, distances, far)
    even = (known + known.T) / 2
    np.fill_diagonal(even, 0.0)
    count = len(even)
    centring = np.eye(count) - 1 / max(count, 1)
    values, vectors = np.linalg.eigh(-centring @ even**2 @ centring / 2)
    place = np.zeros((count, 2))
    for axis, index in enumerate(range(count - 1, max(count - 3, -1), -1)):
        along = vectors[:, index] * np.sqrt(max(float(values[index]), 0.0))
        place[:, axis] = along * (np.sign(along[np.abs(along).argmax()]) or 1.0)
    return place
