"""References: all that a query is compared with, demonstrations and mirror images."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.recognition.gestures.gesture import Gesture
from app.recognition.poses.sequence import FloatArray


@dataclass(frozen=True, eq=False)
class References:
    """All that a query is compared with: every demonstration, and mirror images of some.

    Attributes
    ----------
    gestures
        S gestures of one demonstration each: first those of the language, then their further
        demonstrations, then mirror images.
    owners
        ``(S,)``: index of each one's gesture in the language.
    demonstrations
        ``(S,)``: index of each one's demonstration in its gesture.
    mirrored
        ``(S,)``: whether it is a mirror image.

    """

    gestures: tuple[Gesture, ...]
    owners: npt.NDArray[np.intp]
    demonstrations: npt.NDArray[np.intp]
    mirrored: npt.NDArray[np.bool_]

    @classmethod
    def of(cls, gestures: Sequence[Gesture]) -> References:
        """List the references of a language's gestures; mirror images where their switch is on."""
        shown = [
            (number, owner, each)
            for owner, gesture in enumerate(gestures)
            for number, each in enumerate(gesture.single_demonstrations())
        ]
        shown.sort(key=lambda each: each[0] > 0)
        images = [
            (number, owner, each.mirror())
            for number, owner, each in shown
            if each.switches.mirror == "on" and each.trajectory is not None
        ]
        numbers, owners, every = zip(*shown, *images, strict=True)
        return cls(
            gestures=tuple(every),
            owners=np.array(owners, dtype=np.intp),
            demonstrations=np.array(numbers, dtype=np.intp),
            mirrored=np.arange(len(every)) >= len(shown),
        )

    def find_nearest(self, scores: FloatArray) -> npt.NDArray[np.intp]:
        """Return the reference of each gesture with the smallest of ``(S,)`` scores, ``(G,)``."""
        order = np.argsort(-scores, kind="stable")
        nearest = np.empty(int(self.owners.max()) + 1, dtype=np.intp)
        nearest[self.owners[order]] = order  # the best is written last
        return nearest
