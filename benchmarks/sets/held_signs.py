"""Held signs: takes of divers' signs that are hand shapes, as pose sequences of one hand."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from app.recognition import PoseSequence
from app.recognition.poses.sequence import HANDS_SHAPE

FILE = "scuba_hands.npz"
FRAME = (640, 480)
"""Picture size: the file gives fractions of a picture of unknown size; with sides of 4 to 3 a flat
hand has realistic proportions."""
RATE = 30.0
TAKES_OF_A_RUN = 5
"""Takes in a row with the same hand, side of the hand and view."""
SHOWN_IN_TWO_WAYS = "stop"
"""A label whose first runs show a flat hand and whose last ones a fist: treated as two signs."""


@dataclass(frozen=True)
class HeldSigns:
    """Takes of held signs.

    Attributes
    ----------
    takes
        N pose sequences: a hand, and the wrist as the only landmark of a body.
    labels, runs
        ``(N,)`` sign and run of each; the hand, its side (palm or back) and the view differ between
        runs.

    """

    takes: list[PoseSequence]
    labels: npt.NDArray[np.str_]
    runs: npt.NDArray[np.intp]


def read_held_signs(folder: Path) -> HeldSigns:
    """Read the takes of `FILE` in a folder."""
    with np.load(folder / FILE, allow_pickle=True) as file:
        places, labels, numbers = file["x"], file["label"].astype("U12"), file["rep"]
    runs = np.asarray(numbers // TAKES_OF_A_RUN, dtype=np.intp)
    fists = (labels == SHOWN_IN_TWO_WAYS) & (runs >= 3)
    labels[fists] = "stop by fist"
    return HeldSigns([_read(each) for each in places], labels, runs)


def _read(places: npt.NDArray[np.float32]) -> PoseSequence:
    """Return the hand that is seen longer, as the right one: the file does not name the sides."""
    count = HANDS_SHAPE[1]
    hands = places.astype(np.float64).reshape(len(places), 2, count, 3)[..., :2] * FRAME
    seen = np.isfinite(hands).all(axis=(2, 3)).mean(axis=0)
    shown = hands[:, 0 if seen[0] > 0.5 else int(seen.argmax())]
    both = np.full((len(places), *HANDS_SHAPE), np.nan)
    both[:, 1] = shown
    return PoseSequence(
        landmarks=("right_wrist",),
        xy=shown[:, :1],
        time=np.arange(len(places)) / RATE,
        frame_size=FRAME,
        hands=both,
    )
