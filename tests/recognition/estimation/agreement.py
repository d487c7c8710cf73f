"""Agreement of two estimators on a clip.

Tracking feeds every frame's landmarks into the next frame's region, and a region moved by 1e-5 of
its side moves the next by ten times as much, until the noise saturates at about 1 % of the side. So
two runs with different arithmetic diverge on hard images, even two runs of the library: this is
measured too, with images in which one pixel in a hundred is one step brighter. `python -m
tests.recognition.estimation.agreement CLIP...` prints the table.
"""

from __future__ import annotations

import itertools
import sys
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.factory import OnnxPoseEstimator
from app.recognition.estimation.mediapipe_estimator import MediaPipeEstimator
from app.recognition.poses.frame import FrameLandmarks, Hand, Image
from app.recognition.poses.sequence import FloatArray
from app.recognition.recording.video import VideoFrame
from tests.recognition.estimation.clip_frames import clip_frames

UPPER_BODY = slice(0, 23)
"""Head, arms and hands of the 33 landmarks: all that a diver's gesture is made of."""


@dataclass(frozen=True, eq=False)
class Agreement:
    """What two estimators found in the same frames.

    Attributes
    ----------
    frames
        How many frames there were.
    bodies, hands
        How many the first and the second estimator found in all.
    body_errors, hand_errors
        Mean distance per body (upper body) and hand that both found: of the x distance over
        the frame's width and the y distance over its height.

    """

    frames: int
    bodies: tuple[int, int]
    hands: tuple[int, int]
    body_errors: FloatArray
    hand_errors: FloatArray

    @property
    def body(self) -> float:
        """Mean over the bodies; 0 where there is none."""
        return float(self.body_errors.mean()) if len(self.body_errors) else 0.0

    @property
    def hand(self) -> float:
        """Mean over the hands; 0 where there is none."""
        return float(self.hand_errors.mean()) if len(self.hand_errors) else 0.0

    @property
    def typical_body(self) -> float:
        """Median over the bodies, which a single exchange of left and right does not shift."""
        return float(np.median(self.body_errors)) if len(self.body_errors) else 0.0


def pooled(agreements: Iterable[Agreement]) -> Agreement:
    """Combine the agreement of several clips: every body and every hand counts the same."""
    parts = tuple(agreements)
    return Agreement(
        frames=sum(part.frames for part in parts),
        bodies=(sum(part.bodies[0] for part in parts), sum(part.bodies[1] for part in parts)),
        hands=(sum(part.hands[0] for part in parts), sum(part.hands[1] for part in parts)),
        body_errors=np.concatenate([part.body_errors for part in parts]),
        hand_errors=np.concatenate([part.hand_errors for part in parts]),
    )


def compare(
    one: Callable[[VideoFrame], FrameLandmarks],
    other: Callable[[VideoFrame], FrameLandmarks],
    frames: Iterable[VideoFrame],
) -> Agreement:
    """Run two estimators over the same frames."""
    count, bodies, hands = 0, [0, 0], [0, 0]
    body_errors: list[float] = []
    hand_errors: list[float] = []
    for frame in frames:
        mine, theirs = one(frame), other(frame)
        size = np.array([frame.image.shape[1], frame.image.shape[0]], dtype=np.float64)
        count += 1
        for index, result in enumerate((mine, theirs)):
            bodies[index] += result.body is not None
            hands[index] += len(result.hands)
        if mine.body is not None and theirs.body is not None:
            difference = (mine.body.xy - theirs.body.xy)[UPPER_BODY] / size
            body_errors.append(float(np.abs(difference).mean()))
        hand_errors += _hand_errors(mine.hands, theirs.hands, size)
    return Agreement(
        count,
        (bodies[0], bodies[1]),
        (hands[0], hands[1]),
        np.array(body_errors),
        np.array(hand_errors),
    )


def _hand_errors(mine: Sequence[Hand], theirs: Sequence[Hand], size: FloatArray) -> list[float]:
    """Mean error of each of their hands to the nearest of mine."""
    if not mine:
        return []
    return [
        min(float(np.abs((hand.xy - other.xy) / size).mean()) for other in mine) for hand in theirs
    ]


def tracking(estimator: PoseEstimator) -> Callable[[VideoFrame], FrameLandmarks]:
    """Return the estimator as it is used: reset once, then frame after frame."""
    estimator.reset()
    return lambda frame: estimator.estimate(frame.image, frame.time)


def in_stretches(estimator: PoseEstimator, length: int) -> Callable[[VideoFrame], FrameLandmarks]:
    """Return the estimator, reset after every `length` frames."""
    seen = itertools.count()

    def estimate(frame: VideoFrame) -> FrameLandmarks:
        if next(seen) % length == 0:
            estimator.reset()
        return estimator.estimate(frame.image, frame.time)

    return estimate


def disturbed(estimate: Callable[[VideoFrame], FrameLandmarks]) -> Callable[..., FrameLandmarks]:
    """Return the estimator on images changed so little that nobody sees it."""
    generator = np.random.default_rng(0)

    def changed(image: Image) -> Image:
        brighter = generator.random(image.shape[:2], dtype=np.float32) < 0.01
        return image + (brighter[..., None] & (image < 255)).astype(np.uint8)

    return lambda frame: estimate(VideoFrame(frame.index, frame.time, changed(frame.image)))


def main(clips: Sequence[str], frames: int = 90) -> None:
    """Print a line per clip; errors in millionths of the frame, mean and median of the body's."""
    ours, library, again = (
        OnnxPoseEstimator(hands="palm"),
        MediaPipeEstimator(),
        MediaPipeEstimator(),
    )
    print("clip | frames | bodies | hands | body mean | median | hands mean | library with itself")
    for clip in map(Path, clips):
        agreement = compare(tracking(ours), tracking(library), clip_frames(clip, frames))
        noise = compare(tracking(library), disturbed(tracking(again)), clip_frames(clip, frames))
        print(
            clip.name,
            agreement.frames,
            "{}/{}".format(*agreement.bodies),
            "{}/{}".format(*agreement.hands),
            f"{1e6 * agreement.body:.0f}",
            f"{1e6 * agreement.typical_body:.0f}",
            f"{1e6 * agreement.hand:.0f}",
            f"{1e6 * noise.body:.0f} ({1e6 * noise.typical_body:.0f}), "
            f"hands {noise.hands[0]}/{noise.hands[1]}",
            sep=" | ",
            flush=True,
        )


if __name__ == "__main__":
    main(sys.argv[1:])
