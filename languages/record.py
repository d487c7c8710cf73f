"""Recordings: extracts the landmarks of clips, rounded for the repository.

Pose models round differently on other processors, and tracking carries that along. The tests read
the recordings of two (`tests/recordings`), so that nothing holds for one processor alone. Run
``python -m languages.record FOLDER`` from the repository's root; ``--clips`` names other clips than
the samples, such as those of signs by other divers, which are rendered for the tests alone.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np

from app.recognition import Recording, record
from app.recognition.poses.sequence import FloatArray
from languages.build import FOLDER

PIXEL_PARTS = 64
"""Places are kept to 1/64 pixel: thirty times finer than what changes any label."""

SCORE_PARTS = 1024
"""Scores and confidences are kept to 1/1024."""


def round_recording(recording: Recording) -> Recording:
    """Round places and scores, so that the file takes a sixth of the room."""
    poses = recording.poses
    confidence = poses.confidence
    return replace(
        recording,
        poses=replace(
            poses,
            xy=_round(poses.xy, PIXEL_PARTS),
            confidence=None if confidence is None else _round(confidence, SCORE_PARTS),
        ),
        hands=tuple(
            tuple(
                replace(
                    hand,
                    xy=_round(hand.xy, PIXEL_PARTS),
                    score=float(_round(np.array(hand.score), SCORE_PARTS)),
                )
                for hand in frame
            )
            for frame in recording.hands
        ),
        salute=_round(recording.salute, SCORE_PARTS),
    )


def _round(values: FloatArray, parts: int) -> FloatArray:
    return np.asarray(np.round(values * parts) / parts, dtype=np.float64)


def main() -> None:
    """Write one file a clip into the folder given; clips that have one already are passed over."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("folder", type=Path, help="made when missing")
    parser.add_argument("--clips", type=Path, default=FOLDER / "clips", help="folder of the clips")
    given = parser.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    for clip in sorted(given.clips.glob("*.mp4")):
        file = given.folder / f"{clip.stem}.npz"
        if not file.exists():
            round_recording(record(clip)).save(file)
            print(file)


if __name__ == "__main__":
    main()
