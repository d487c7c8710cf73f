"""Published sets of divers' signs, by what tells their folders apart."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from app.evaluation.labelled_takes import ClipRecorder
from app.recognition import OsgError
from benchmarks.sets.divers import caddy, scubanet, sdg11
from benchmarks.sets.divers.diver_take import DiverTake


@dataclass(frozen=True)
class PublishedSet:
    """A set and its layout.

    Attributes
    ----------
    name
        The authors' name of the set.
    finds
        Returns the files that identify the set; none if the folder holds another one.
    reads
        Yields the takes of a folder.

    """

    name: str
    finds: Callable[[Path], tuple[Path, ...]]
    reads: Callable[[Path, ClipRecorder], Iterator[DiverTake]]


PUBLISHED_SETS: Final = (
    PublishedSet("CADDY", caddy.find_tables, caddy.read_takes),
    PublishedSet("SCUBANetV2", scubanet.find_label_files, scubanet.read_takes),
    PublishedSet("SDG11", sdg11.find_clips, sdg11.read_takes),
)


def find_set(folder: Path) -> PublishedSet:
    """Return the set that a folder holds.

    Raises
    ------
    OsgError
        When it holds none of them.

    """
    for each in PUBLISHED_SETS:
        if each.finds(folder):
            return each
    names = ", ".join(each.name for each in PUBLISHED_SETS)
    raise OsgError(f"{folder} holds none of {names}: give the folder to which one was unpacked")
