"""Recorded sets: other people's trajectories as pose sequences. Only x and y are used."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from app.recognition import PoseSequence
from benchmarks.methods.base import Demonstration

FRAME = (640, 480)
RATE = 30.0
"""Frames per second, about that of all sets."""

DOMAINS = ("digits", "letters", "commands")
"""Parts of 3DMadLabSD that published numbers exist for."""

SETS = (*DOMAINS, "grufba3d", "natops")
"""Names of all sets."""

DUPLICATED = "Wheel"
"""A class of 3DMadLabSD that shares 60 identical trajectories with the digit 0."""


@dataclass(frozen=True)
class RecordedSet:
    """Recordings of several people.

    Attributes
    ----------
    name
        Name in the report.
    recordings
        N pose sequences.
    labels, people
        ``(N,)`` class and person of each; one unknown person if the set does not name people.

    """

    name: str
    recordings: list[PoseSequence]
    labels: npt.NDArray[np.str_]
    people: npt.NDArray[np.str_]

    def show(self, takes: Sequence[int]) -> list[Demonstration]:
        """Return recordings as demonstrations."""
        return [
            Demonstration(str(self.labels[each]), self.recordings[each], str(self.people[each]))
            for each in takes
        ]


def recorded_sets(folder: Path, names: Collection[str] | None = None) -> Iterator[RecordedSet]:
    """Read the three sets that published numbers exist for, and two with both arms.

    `names`: only these; None: all.
    """
    wanted = SETS if names is None else [name for name in SETS if name in names]
    madlab = read_arrays(folder / "madlab3d.npz")
    for domain in (name for name in wanted if name in DOMAINS):
        chosen = (madlab["domain"] == domain) & (madlab["label"] != DUPLICATED)
        yield _recorded_set(domain, madlab, np.flatnonzero(chosen))
    for name in (name for name in wanted if name not in DOMAINS):
        content = read_arrays(folder / f"{name}.npz")
        yield _recorded_set(name, content, np.arange(len(content["label"])))


def read_arrays(path: Path) -> dict[str, npt.NDArray[Any]]:
    """Read all arrays of a file once: each access to an opened file would read again."""
    with np.load(path, allow_pickle=True) as file:
        return dict(file)


def _recorded_set(
    name: str, content: dict[str, npt.NDArray[Any]], chosen: npt.NDArray[np.intp]
) -> RecordedSet:
    """Bring trackers' units to pixels, y down, with one scale for the whole set."""
    landmarks = tuple(str(joint) for joint in content["joint_names"])
    paths = [content["x"][index][:, :, :2].astype(np.float64) for index in chosen]
    widest = max(float(np.ptp(path, axis=0).max()) for path in paths)
    recordings = [
        PoseSequence(
            landmarks=landmarks,
            xy=(path - path.mean(axis=(0, 1))) * (1, -1) * (FRAME[1] / widest)
            + np.array(FRAME) / 2,
            time=np.arange(len(path)) / RATE,
            frame_size=FRAME,
        )
        for path in paths
    ]
    people = content["subject"][chosen].astype(str)
    if name not in DOMAINS:  # the files of the other sets do not name people
        people = np.full(len(chosen), "unknown")
    return RecordedSet(name, recordings, content["label"][chosen].astype(str), people)
