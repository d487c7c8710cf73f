"""Held signs: takes of divers' signs and of letters, as pose sequences of one hand."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from app.recognition import PoseSequence
from app.recognition.poses.sequence import HANDS_SHAPE
from benchmarks.sets.recorded_sets import RecordedSet

FILE = "scuba_hands.npz"
HAND_LETTERS = "hand_letters"
"""Name of the set of letters."""
LETTERS_FILE = f"{HAND_LETTERS}.npz"
SHARED_LETTERS = "BCILOUVWY"
"""Letters that all seven alphabets show with the same hand shape."""
COPY = "fsl"
"""An alphabet whose clips are those of another one (`ase`) under a second name: left out."""
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


def read_hand_letters(folder: Path) -> RecordedSet:
    """Read the takes of the shared letters of `LETTERS_FILE` in a folder, without the `COPY`.

    A take is a hand, and the wrist as the only landmark of a body; each signer shows each letter
    once at most.
    """
    with np.load(folder / LETTERS_FILE, allow_pickle=True) as file:
        content = {name: file[name] for name in ("x", "t", "label", "subject", "frame_size")}
    shown, signers = content["label"].astype(str), content["subject"].astype(str)
    chosen = np.flatnonzero(np.isin(shown, list(SHARED_LETTERS)) & (signers != COPY))
    takes = [
        make_take(
            content["x"][index].astype(np.float64),
            content["t"][index].astype(np.float64),
            tuple(content["frame_size"][index].tolist()),
        )
        for index in chosen.tolist()
    ]
    return RecordedSet(HAND_LETTERS, takes, shown[chosen], signers[chosen])


def _read(places: npt.NDArray[np.float32]) -> PoseSequence:
    """Return the hand that is seen longer, as the right one: the file does not name the sides."""
    count = HANDS_SHAPE[1]
    hands = places.astype(np.float64).reshape(len(places), 2, count, 3)[..., :2] * FRAME
    seen = np.isfinite(hands).all(axis=(2, 3)).mean(axis=0)
    shown = hands[:, 0 if seen[0] > 0.5 else int(seen.argmax())]
    return make_take(shown, np.arange(len(places)) / RATE, FRAME)


def make_take(
    hand: npt.NDArray[np.float64], time: npt.NDArray[np.float64], frame_size: tuple[int, int]
) -> PoseSequence:
    """Return a take of one hand ``(T, 21, 2)`` in pixels, as the right one, at times in seconds."""
    both = np.full((len(hand), *HANDS_SHAPE), np.nan)
    both[:, 1] = hand
    return PoseSequence(
        landmarks=("right_wrist",), xy=hand[:, :1], time=time, frame_size=frame_size, hands=both
    )
