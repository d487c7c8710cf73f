"""Hand regions from the pose: the regions of hands at the ends of the arms."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Final

import numpy as np

from app.recognition.estimation.landmark_models.hand_regions import palm_size, up_of
from app.recognition.estimation.landmark_models.region import Region, upright
from app.recognition.poses.frame import SIDES, Body, Hand, Side
from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.recognition.poses.sequence import FloatArray

LEAST_VISIBILITY: Final = 0.1
"""Least visibility of a wrist whose hand is searched, as in MediaPipe Holistic."""

WRIST_SCALE: Final = 2.0
"""Side of the region over twice the distance from the wrist to the middle knuckle. MediaPipe
Holistic uses 2.7 with a re-crop model; the landmark model alone expects the hand to fill its
region, and finds twice as many at 2.0 (`benchmarks/studies/hands-and-water.md`)."""

WRIST_SHIFT: Final = 0.1
"""Shift towards the finger tips, over the same length, as in MediaPipe Holistic."""

FOREARM_VISIBILITY: Final = 0.5
"""Least visibility of a wrist for a search at the end of its forearm: the larger region needs a
more certain arm."""

FOREARM_SIDES: Final = (0.6, 0.9)
"""Sides of the regions at a forearm's end, over the body's size: a hand is 0.4 of a torso long, and
the landmark model expects it to fill half of its region or more."""

FOREARM_SHIFT: Final = 0.2
"""Shift of these regions beyond the wrist, over the body's size: half a hand."""

FOREARM_REACH: Final = 0.6
"""As `REACH`, for hands found there: 95 % of hands on the tracked body's arms are nearer."""

REACH: Final = 1.0
"""Largest distance between the pose's wrist and the hand's own, in palm sizes. Of hands on the
tracked body's arms 95 % are nearer than 0.6; those of bystanders are several palms away."""


OWN_REACH: Final = 1.5
"""As `REACH`, for a hand that belongs to the nearest of several people: the smoothed wrist of a
fast arm lags behind its hand by up to half a palm."""


def region_of_wrist(body: Body, side: Side) -> Region | None:
    """Return the region of the hand at the end of an arm, from the pose alone.

    The region is centred on the middle finger's knuckle, which lies between those of index and
    little finger, twice as near to the index. It is turned so that this knuckle is straight above
    the wrist (MediaPipe Holistic, Grishchenko and Bazarevsky 2020).

    Parameters
    ----------
    body
        The body in the image.
    side
        The arm.

    Returns
    -------
    None where the wrist is not visible, or the region is not usable.

    """
    wrist, pinky, index = (
        POSE_LANDMARKS.index(f"{side}_{part}") for part in ("wrist", "pinky", "index")
    )
    if not body.visibility[wrist] >= LEAST_VISIBILITY:
        return None
    knuckle = (2 * body.xy[index] + body.xy[pinky]) / 3
    length = 2 * float(np.linalg.norm(knuckle - body.xy[wrist]))
    rotation = upright(body.xy[wrist], knuckle)
    centre = knuckle + WRIST_SHIFT * length * up_of(rotation)
    region = Region(float(centre[0]), float(centre[1]), WRIST_SCALE * length, rotation)
    return region if region.usable else None


def regions_of_forearm(body: Body, side: Side) -> tuple[Region, ...]:
    """Return regions at the end of a forearm, for hands whose fingers the pose does not show.

    A glove hides the fingers that `region_of_wrist` needs. The direction of the forearm and the
    size of the body (the longer of torso and shoulders) also show where a hand is and how large it
    is.
    """
    elbow, wrist = (POSE_LANDMARKS.index(f"{side}_{joint}") for joint in ("elbow", "wrist"))
    if not body.visibility[wrist] >= FOREARM_VISIBILITY:
        return ()
    size = measure_body(body)
    rotation = upright(body.xy[elbow], body.xy[wrist])
    centre = body.xy[wrist] + FOREARM_SHIFT * size * up_of(rotation)
    regions = (
        Region(float(centre[0]), float(centre[1]), share * size, rotation)
        for share in FOREARM_SIDES
    )
    return tuple(region for region in regions if region.usable)


def measure_body(body: Body) -> float:
    """Return the longer of torso and shoulders in pixels; one of them is long in every view."""
    shoulders, hips = (
        body.xy[[POSE_LANDMARKS.index(f"{side}_{joint}") for side in SIDES]]
        for joint in ("shoulder", "hip")
    )
    torso = np.linalg.norm(shoulders.mean(axis=0) - hips.mean(axis=0))
    return float(max(torso, np.linalg.norm(shoulders[0] - shoulders[1])))


def wrist_distance(hand: Hand, body: Body, side: Side) -> float:
    """Return the distance between the hand's wrist and the arm's, in sizes of the hand's palm."""
    wrist = body.xy[POSE_LANDMARKS.index(f"{side}_wrist")]
    return float(np.linalg.norm(hand.xy[0] - wrist)) / max(palm_size(hand.xy), 1e-9)


def find_owner(hand: Hand, bodies: Sequence[Body]) -> int | None:
    """Return which of several bodies a hand belongs to; None where no wrist is within reach."""
    far = [min(_reach_of(hand, body, side) for side in SIDES) for body in bodies]
    nearest = min(range(len(far)), key=far.__getitem__, default=None)
    return nearest if nearest is not None and far[nearest] <= OWN_REACH else None


def find_stray_wrist(hands: Iterable[Hand], bodies: Sequence[Body]) -> FloatArray | None:
    """Return the wrist ``(2,)`` of the largest hand that belongs to none of the bodies."""
    stray = [hand for hand in hands if bodies and find_owner(hand, bodies) is None]
    return max(stray, key=lambda hand: hand.size).xy[0] if stray else None


def _reach_of(hand: Hand, body: Body, side: Side) -> float:
    far = wrist_distance(hand, body, side)
    return far if np.isfinite(far) else np.inf
