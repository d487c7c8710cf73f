"""Limb length: limits the apparent length of an arm's bones in simulated takes."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.recognition.features.motion import SIDES, list_limbs, parse_body_part
from app.recognition.poses.landmarks import HIPS, SHOULDERS
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory

SHARE_OF_TORSO = {"elbow": 0.65, "wrist": 0.51}
"""Length of the bone that ends there, in torso lengths: upper arm 0.186, forearm 0.146 and trunk
0.288 of the body's height (Drillis and Contini 1966). A bone that points towards the camera looks
shorter, so a demonstration alone may not show its length."""

LEEWAY = 1.05
"""Factor by which a bone may look longer than in the demonstration: a pose model's error."""

_ARMS = list_limbs([side + "wrist" for side in SIDES])


def limit_limbs(paths: FloatArray, demonstration: Trajectory) -> FloatArray:
    """Shorten the arms' bones to their greatest possible length.

    An elbow first follows a wrist that is too far away; then, from the shoulder outwards, each end
    that is too far away is moved back along its bone. Shoulders keep their movement.

    Parameters
    ----------
    paths
        ``(..., T, K, 2)``, finite, of the demonstration's K landmarks.
    demonstration
        The demonstration; each bone may look at least as long as in it.

    Returns
    -------
    Paths of the same shape.

    """
    within = paths.copy()
    places = {parse_body_part(name): index for index, name in enumerate(demonstration.landmarks)}
    lengths = _find_longest(demonstration, places)
    for inner, outer in lengths:
        if outer.endswith("wrist"):
            _move_within(within, places[inner], places[outer], lengths[inner, outer])
    for inner, outer in lengths:
        _move_within(within, places[outer], places[inner], lengths[inner, outer])
    return within


def _find_longest(
    demonstration: Trajectory, places: dict[str, int]
) -> dict[tuple[str, str], float]:
    """Return the greatest length of each bone that was seen, from the trunk outwards."""
    torso = _torso_length(demonstration)
    longest = {}
    for inner, outer in _ARMS:
        if inner not in places or outer not in places:
            continue
        bone = demonstration.xy[:, places[outer]] - demonstration.xy[:, places[inner]]
        seen = np.isfinite(bone).all(axis=1)
        if seen.any():
            shown = LEEWAY * float(np.linalg.norm(bone[seen], axis=1).max())
            share = SHARE_OF_TORSO.get(outer.split("_", 1)[-1], 0.0)
            longest[inner, outer] = max(shown, share * torso)
    return longest


def _torso_length(demonstration: Trajectory) -> float:
    """Return the median distance of mid-shoulders and mid-hips; 0 where they are not seen."""
    if not {*SHOULDERS, *HIPS} <= set(demonstration.landmarks):
        return 0.0
    trunk = demonstration.select((*SHOULDERS, *HIPS)).xy
    lengths = np.linalg.norm(trunk[:, :2].mean(axis=1) - trunk[:, 2:].mean(axis=1), axis=1)
    known = lengths[np.isfinite(lengths)]
    return float(np.median(known)) if len(known) else 0.0


def _move_within(paths: FloatArray, mover: int, anchor: int, longest: float) -> None:
    """Move one landmark along its bone to within `longest` of another, in place."""
    bone: npt.NDArray[np.float64] = paths[..., mover, :] - paths[..., anchor, :]
    length = np.linalg.norm(bone, axis=-1, keepdims=True)
    paths[..., mover, :] -= bone * np.maximum(0.0, 1.0 - longest / np.maximum(length, 1e-12))
