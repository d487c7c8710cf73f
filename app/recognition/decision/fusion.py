"""Fusion: how much each voter has to say in a language, and one score from all of their distances.

A voter's distances are divided by its own typical distance between two gestures of the language,
so that 1 means "as different as two gestures are", whatever the voter's unit. Its say is

    say = prior * max(0, 1 - within / between),

where `within` is what the same gesture's takes by two people typically differ by (`TYPICAL`, from
recordings), and `between` the median distance between two gestures of this language. A voter for
whom this language's gestures differ no more than people do has no say.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.recognition.poses.sequence import FloatArray


@dataclass(frozen=True)
class Trust:
    """What is known of a voter before any language is.

    Attributes
    ----------
    prior
        Its say beside ``path`` with 1.
    within
        Mean distance between two people's takes of one gesture.
    between
        Typical distance between two gestures; stands in where a language has only one.

    """

    prior: float
    within: float
    between: float


TYPICAL = {
    "hu": Trust(0.05, 2.9, 4.7),
    "zernike": Trust(0.05, 0.40, 0.62),
    "fourier": Trust(0.05, 0.33, 0.80),
    "aspect_ratio": Trust(0.05, 0.30, 0.46),
    "solidity": Trust(0.05, 0.075, 0.29),
    "circularity": Trust(0.05, 0.055, 0.17),
    "path_complexity": Trust(0.2, 0.10, 0.23),
    "path": Trust(1.0, 0.077, 1.1),
    "direction": Trust(1.0, 0.131, 1.3),
    "posture": Trust(3.0, 0.19, 1.1),
    "hand_attitude": Trust(1.0, 0.13, 0.56),
    "wrist_bend": Trust(0.5, 0.45, 0.58),
    "cloud": Trust(0.2, 0.18, 0.43),
    "stroke_direction": Trust(0.05, 0.35, 2.5),
    "which_hand": Trust(0.05, 0.05, 0.5),
    "path_length": Trust(0.0, 0.11, 0.28),
    "tempo": Trust(0.0, 0.35, 0.5),
}
"""Measured on air-drawn digits, letters and commands, two-handed figures and aircraft
marshalling by other people (`docs/results.md`): the geometric mean over the sets.

Paths and postures decide; of the shape voters, which are blind to order, ``path_complexity`` adds
what the elastic ones miss (a 1 with its flag against a narrow 2), the others break ties.
``wrist_bend`` is measured on marshalling alone, the only set with forearms and hands, and wrists
that mean nothing are bent somehow in every demonstration. Its prior is therefore half that of
``hand_attitude``: with as much, one in a hundred more is named there, and a circle drawn with
another bend is as near to the triangle in our clips.
"""

PAIRS_BEFORE = 3
"""Pairs of gestures that the typical distance counts for: a language of two has one pair, and one
pair may be alike by chance."""


def says(
    voters: Sequence[str], own: Sequence[FloatArray], landmarks: int
) -> tuple[FloatArray, FloatArray]:
    """Work out the say of each voter in a language.

    Parameters
    ----------
    voters
        V names.
    own
        Per voter its finite distances between gestures of the language, all that there are.
    landmarks
        How many landmarks the language follows: the joint direction of many is mostly the sway
        of those at rest, so its prior is divided by it.

    Returns
    -------
    ``(V,)`` says and ``(V,)`` typical distances between gestures, > 0.

    """
    say, between = np.zeros(len(voters)), np.ones(len(voters))
    for index, (voter, distances) in enumerate(zip(voters, own, strict=True)):
        trust = TYPICAL[voter]
        known = np.concatenate([distances, np.full(PAIRS_BEFORE, trust.between)])
        between[index] = float(np.median(known))
        prior = trust.prior / (landmarks if voter == "direction" else 1)
        say[index] = prior * max(0.0, 1.0 - trust.within / max(between[index], 1e-9))
    return say, np.maximum(between, 1e-9)


def fused(distances: FloatArray, say: FloatArray, between: FloatArray) -> FloatArray:
    """Fuse distances ``(V, ...)`` to one score each: the sum of the `contributions`.

    Returns
    -------
    The mean of the relative distances, weighted by the voters' say: 0 for the same, about 1 for
    another gesture; infinite where no voter with a say can compare.

    """
    return np.asarray(contributions(distances, say, between).sum(axis=0), dtype=np.float64)


def contributions(distances: FloatArray, say: FloatArray, between: FloatArray) -> FloatArray:
    """Tell what each voter adds to the fused score.

    Returns
    -------
    Of the shape of `distances`, ``(V, ...)``: 0 where a voter has no say or cannot compare, all
    infinite where none with a say can.

    """
    shape = (-1,) + (1,) * (distances.ndim - 1)
    known = np.isfinite(distances)
    if known.all() and (whole := say.sum()) > 0:
        return np.asarray(distances * (say / (between * whole)).reshape(shape))
    weight = np.where(known, say.reshape(shape), 0.0)
    relative = np.where(known, distances, 0.0) / between.reshape(shape)
    total = np.broadcast_to(weight.sum(axis=0), weight.shape)
    shares: FloatArray = np.full(weight.shape, np.inf)
    np.divide(weight * relative, total, out=shares, where=total > 0)
    return shares
