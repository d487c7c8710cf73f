"""Takes of divers: one sign, or none, with where it was shown."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import groupby

from app.recognition import PoseSequence


@dataclass(frozen=True, eq=False)
class DiverTake:
    """One take of a set.

    Attributes
    ----------
    source
        File and frames, for people.
    label
        The sign that is shown; None if it is not one of the set's.
    setting
        Key shared by takes in the same setting: place and view, or the clip.
    poses
        Body and hands.

    """

    source: str
    label: str | None
    setting: str
    poses: PoseSequence


def find_runs(labels: Iterable[str | None]) -> Iterator[tuple[str | None, int, int]]:
    """Yield the label, the first and the last index of each run of equal labels."""
    for label, run in groupby(enumerate(labels), key=lambda pair: pair[1]):
        indices = [index for index, _ in run]
        yield label, indices[0], indices[-1]
