"""Every recorded set by its name: hands, whole bodies, hands' paths carried by bodies."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.figures import Figure, Measurement
from benchmarks.sets.drawn_sets import SETS as DRAWN
from benchmarks.sets.drawn_sets import drawn_sets
from benchmarks.sets.held_signs import HAND_LETTERS, LETTERS_FILE, read_hand_letters
from benchmarks.sets.recorded_sets import DOMAINS, SETS, RecordedSet, recorded_sets
from benchmarks.sets.simulated_bodies import CARRIED, carried_sets
from benchmarks.sets.whole_body_sets import ARM_CLASSES, FILES, whole_body_sets

PEOPLE = {
    **dict.fromkeys(DOMAINS, 10),
    **dict.fromkeys(ARM_CLASSES, 8),
    **dict.fromkeys(CARRIED, 8),
    **dict.fromkeys(DRAWN, 10),
    "utkinect": 10,
    HAND_LETTERS: 6,
}
"""People of each set that names them."""


def all_sets(folder: Path, names: Sequence[str] | None = None) -> Iterator[RecordedSet]:
    """Yield the sets of these names; None: those of hands, of whole bodies, and carried paths."""
    wanted = [*SETS, *ARM_CLASSES, *CARRIED] if names is None else names
    yield from recorded_sets(folder, [name for name in wanted if name in SETS])
    yield from whole_body_sets(folder, [name for name in wanted if name in ARM_CLASSES])
    yield from carried_sets(folder, [name for name in wanted if name in CARRIED])
    if HAND_LETTERS in wanted:
        yield read_hand_letters(folder)
    yield from (each for each in drawn_sets() if each.name in wanted)


def find_file(folder: Path, name: str) -> tuple[Path, ...]:
    """Return the file that holds a set; a simulated set has none."""
    if name in DRAWN or name == "carried_figures":
        return ()
    if name in DOMAINS or name in CARRIED:
        return (folder / "madlab3d.npz",)
    if name == HAND_LETTERS:
        return (folder / LETTERS_FILE,)
    return (folder / f"{FILES.get(name, name)}.npz",)


def find_files(folder: Path, names: Iterable[str]) -> tuple[Path, ...]:
    """Return the files that hold some sets, each once."""
    return tuple(dict.fromkeys(file for name in names for file in find_file(folder, name)))


def measure_sets(
    topic: str,
    folder: Path,
    names: Iterable[str],
    run: Callable[[RecordedSet, bool], Iterable[Figure]],
    protocol: str,
    *further: Path,
) -> Iterator[Measurement]:
    """Yield a measurement for each set.

    Parameters
    ----------
    topic
        First part of the measurements' names.
    folder
        It holds ``trajectories/``.
    names
        Of the sets.
    run
        Measures a set; its second argument says whether quickly.
    protocol
        How, in one sentence.
    further
        Files that `run` reads as well.

    """
    trajectories = folder / "trajectories"
    for name in names:
        yield Measurement(
            name=f"{topic}/{name}",
            run=partial(_run, trajectories, name, run),
            data=name,
            protocol=protocol,
            people=PEOPLE.get(name),
            reads=(*find_file(trajectories, name), *further),
        )


def _run(
    trajectories: Path, name: str, run: Callable[[RecordedSet, bool], Iterable[Figure]], quick: bool
) -> Iterable[Figure]:
    (recorded,) = all_sets(trajectories, [name])
    return run(recorded, quick)


def is_of_bodies(recorded: RecordedSet) -> bool:
    """Return whether the torso is seen."""
    return recorded.recordings[0].torso_length() is not None


def count_people(recorded: RecordedSet) -> int | None:
    """Return how many people there are takes of, None where they are not known."""
    count = len(np.unique(recorded.people))
    return count if count > 1 else None
