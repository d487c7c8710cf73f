"""Recordings of a simulated diver, by hand and as hypothesis strategies."""

from collections.abc import Callable, Mapping

import numpy as np
from hypothesis import strategies as st

from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.recognition.poses.sequence import FloatArray, PoseSequence

Shape = Callable[[FloatArray], FloatArray]
"""Maps shares of the duration ``(T,)`` to points ``(T, 2)`` in torso lengths from its centre."""

BODY: Mapping[str, tuple[float, float]] = {
    **dict.fromkeys(POSE_LANDMARKS[:11], (0.0, -0.85)),
    "left_shoulder": (0.3, -0.5),
    "right_shoulder": (-0.3, -0.5),
    "left_elbow": (0.45, 0.0),
    "right_elbow": (-0.45, 0.0),
    "left_wrist": (0.5, 0.5),
    "right_wrist": (-0.5, 0.5),
    "left_hip": (0.2, 0.5),
    "right_hip": (-0.2, 0.5),
}
"""Where a diver's landmarks rest, in torso lengths from the torso's centre, y down."""


def circle(share: FloatArray) -> FloatArray:
    angle = 2 * np.pi * share
    return np.stack([-0.7 + 0.4 * np.cos(angle), 0.4 * np.sin(angle)], axis=1)


def wedge(share: FloatArray) -> FloatArray:
    return np.stack([-1.1 + 0.8 * share, 0.4 - 0.8 * np.abs(2 * share - 1)], axis=1)


def line(share: FloatArray) -> FloatArray:
    return np.stack([-1.2 + share, np.zeros_like(share)], axis=1)


def infinity(share: FloatArray) -> FloatArray:
    angle = 2 * np.pi * share
    return np.stack([-0.7 + 0.5 * np.sin(angle), 0.25 * np.sin(2 * angle)], axis=1)


def square(share: FloatArray) -> FloatArray:
    corners = np.array([[-1.1, -0.4], [-0.3, -0.4], [-0.3, 0.4], [-1.1, 0.4], [-1.1, -0.4]])
    at = np.linspace(0, 1, len(corners))
    return np.stack([np.interp(share, at, corners[:, axis]) for axis in range(2)], axis=1)


def rest(share: FloatArray) -> FloatArray:
    return np.tile(BODY["right_wrist"], (len(share), 1))


SHAPES: Mapping[str, Shape] = {
    "circle": circle,
    "wedge": wedge,
    "line": line,
    "infinity": infinity,
    "square": square,
}


def recording(
    shape: Shape,
    *,
    hand: str = "right_wrist",
    frames: int = 60,
    rate: float = 30.0,
    torso: float = 120.0,
    centre: tuple[float, float] = (320.0, 240.0),
    jitter: float = 0.0,
    seed: int = 0,
    landmarks: tuple[str, ...] = POSE_LANDMARKS,
) -> PoseSequence:
    """Record a diver at rest whose one hand follows `shape`.

    `torso` and `centre` are pixels, `jitter` a standard deviation in torso lengths; a landmark
    without a place in `BODY` lies at the torso's centre.
    """
    resting = np.array([BODY.get(name, (0.0, 0.0)) for name in landmarks])
    xy = np.tile(resting, (frames, 1, 1))
    if hand in landmarks:
        xy[:, landmarks.index(hand)] = shape(np.linspace(0, 1, frames))
    xy += jitter * np.random.default_rng(seed).standard_normal(xy.shape)
    return PoseSequence(
        landmarks=landmarks,
        xy=xy * torso + centre,
        time=np.arange(frames) / rate,
        frame_size=(640, 480),
    )


def known(values: FloatArray | None) -> FloatArray:
    """Return values that must be there."""
    assert values is not None
    return values


def in_space(poses: PoseSequence, turned: float = 0.0, reach: float = 0.4) -> PoseSequence:
    """Give a recording depth, its moving hand `reach` torso lengths in front, and turn the diver.

    `turned` is in degrees, positive to the diver's own left, as the camera far away sees it.
    """
    torso, centre = poses.torso_length() or 1.0, known(poses.torso_centre())
    across, down = np.moveaxis((poses.xy - centre[:, None]) / torso, 2, 0)
    away = np.zeros_like(across)
    away[:, poses.landmarks.index("right_wrist")] = -reach
    cosine, sine = np.cos(np.radians(turned)), np.sin(np.radians(turned))
    across, away = cosine * across - sine * away, sine * across + cosine * away
    return PoseSequence(
        landmarks=poses.landmarks,
        xy=np.stack([across, down], axis=2) * torso + centre[:, None],
        time=poses.time,
        frame_size=poses.frame_size,
        world=np.stack([across, down, away], axis=2) / 2,
    )


@st.composite
def strokes(draw: st.DrawFn) -> Shape:
    """Draw smooth strokes a torso length wide or high: sums of three random harmonics."""
    generator = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    amplitudes = generator.normal(size=(3, 2, 2)) / np.array([1, 2, 3])[:, None, None]
    turns = generator.uniform(0.5, 1.0)

    def waves(share: FloatArray) -> FloatArray:
        angles = 2 * np.pi * turns * share[:, None] * np.arange(1, 4)
        both = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
        return np.asarray(np.einsum("thw,haw->ta", both, amplitudes))

    extent = np.ptp(waves(np.linspace(0, 1, 200)), axis=0).max()
    return lambda share: waves(share) / extent + (-0.7, 0.0)


@st.composite
def recordings(draw: st.DrawFn) -> PoseSequence:
    """Draw recordings of a diver's right hand following a random smooth stroke."""
    return recording(
        draw(strokes()),
        frames=draw(st.integers(20, 90)),
        jitter=0.002,
        seed=draw(st.integers(0, 2**32 - 1)),
    )
