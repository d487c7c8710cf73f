"""Explanation: time of an explanation relative to a recognition.

For each gesture of the larger sample language, a plausible take by another person is explained as
if the next gesture had been meant: only large changes help, so nearly all are tried.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial
from statistics import median

from app.recognition import Language, PoseSequence, Recognizer
from app.recognition.explanation.context import RecognitionContext
from app.recognition.explanation.explanation import explain
from app.recognition.gestures.profile import PROFILES
from app.recognition.poses.trajectory import Trajectory
from app.recognition.simulation.variation import draw_variants
from app.resources import samples_dir

TORSO_PIXELS = 120.0
"""Torso length in pixels; normalisation removes it."""


def main() -> None:
    """Print the ratios for both profiles."""
    language = Language.load(samples_dir() / "osg-table-2.json")
    for profile in PROFILES:
        recognizer = Recognizer(language, profile)
        without, whole, tried = [], [], []
        for index, gesture in enumerate(language.gestures):
            assert gesture.trajectory is not None
            poses = _film(draw_variants(gesture.trajectory, 1, seed=index, person="another")[0])
            meant = language.labels[(index + 1) % len(language.labels)]
            anew = partial(RecognitionContext, recognizer=recognizer, poses=poses, whole=poses)
            alone = min(_seconds(partial(recognizer.recognize, poses)) for _ in range(5))
            short, full = (
                partial(explain, anew(), meant, with_counterfactuals=c) for c in (False, True)
            )
            without.append(_seconds(short) / alone)
            whole.append(_seconds(full) / alone)
            tried.append(explain(anew(), meant).tried)
        print(
            f"explanation, {profile}: {median(without):.1f} recognitions "
            f"({min(without):.1f} to {max(without):.1f}); with {median(tried):.0f} changes tried "
            f"{median(whole):.0f} ({min(whole):.0f} to {max(whole):.0f})"
        )


def _film(trajectory: Trajectory) -> PoseSequence:
    return PoseSequence(
        landmarks=trajectory.landmarks,
        xy=trajectory.xy * TORSO_PIXELS + (320.0, 240.0),
        time=trajectory.time,
        frame_size=(640, 480),
    )


def _seconds(run: Callable[[], object]) -> float:
    start = time.perf_counter()
    run()
    return time.perf_counter() - start


if __name__ == "__main__":
    main()
