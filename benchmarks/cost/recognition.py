"""Recognition: time as a function of the number of gestures.

The query is rendered and described once per distinct set of salient keypoints, so a thousand
gestures must cost far less than 125 times as much as eight. Times are processor time, so that other
programs do not count.
"""

from __future__ import annotations

from statistics import median
from time import process_time

import numpy as np

from app.recognition import Gesture, Language, PoseSequence, Recognizer
from app.recognition.gestures.profile import PROFILES

SIZES = (8, 100, 1000)
ROUNDS = 15


def wander(seed: int) -> PoseSequence:
    """Draw a smooth random figure with one wrist before a still torso."""
    random = np.random.default_rng(seed)
    time = np.linspace(0.0, 3.0, 90)
    phase = 2 * np.pi * np.outer(np.arange(1, 5), time / time[-1])
    size = random.normal(size=(2, 4)) / np.arange(1, 5)
    wrist = size @ np.sin(phase + random.uniform(0, 2 * np.pi, size=(4, 1)))
    wrist *= 120 / np.ptp(wrist, axis=1).max()
    still = np.array([[260.0, 160], [380, 160], [280, 340], [360, 340]])
    body = np.broadcast_to(still, (len(time), 4, 2))
    return PoseSequence(
        landmarks=("right_shoulder", "left_shoulder", "right_hip", "left_hip", "right_wrist"),
        xy=np.concatenate([body, 200 + wrist.T[:, None]], axis=1),
        time=time,
        frame_size=(640, 480),
    )


def main() -> None:
    """Print the time of one recognition relative to the smallest language, per profile."""
    query = wander(seed=-1 % 2**32)
    gestures = [Gesture.from_demonstration(f"figure {n}", wander(n)) for n in range(max(SIZES))]
    for profile in PROFILES:
        recognizers = {
            size: Recognizer(Language(name="bench", gestures=gestures[:size]), profile)
            for size in SIZES
        }
        times: dict[int, list[float]] = {size: [] for size in SIZES}
        for _ in range(ROUNDS):
            for size, recognizer in recognizers.items():
                start = process_time()
                recognizer.recognize(query)
                times[size].append(process_time() - start)
        base = median(times[SIZES[0]])
        for size in SIZES:
            print(
                f"profile {profile}, {size:>4} gestures: {median(times[size]) / base:5.2f} times "
                f"the time of {SIZES[0]} ({size / SIZES[0]:.0f} times the gestures)"
            )
