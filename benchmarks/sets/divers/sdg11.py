"""SDG11: eleven divers' signs in clips of about two seconds, one sign a clip.

``SIGN/SIGN_PLACE_VIEW_id.MP4``, where PLACE is TANK, SEA, SPRINGS and so on, perhaps with a
modifier (AQUARIUM-LOWVIZ), and VIEW is VERTICAL or HORIZONTAL, how the diver lies. People are not
told. Layout as described by aprilab-uf/SDG11, `dataset_contribution_guide.md`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from app.clip_sources import is_take
from app.evaluation.labelled_takes import ClipRecorder
from app.recognition import takes_in
from benchmarks.sets.divers.diver_take import DiverTake

NAME = re.compile(
    r"(?P<sign>[^_]+(?:_[^_]+)*?)_(?P<place>[A-Z-]+)_(?P<view>VERTICAL|HORIZONTAL)_[^_]+", re.I
)
"""Names of clips, without their ending."""


def find_clips(folder: Path) -> tuple[Path, ...]:
    """Find the clips whose names follow the set's rule, in folders of signs."""
    return tuple(
        path
        for path in sorted(folder.glob("*/*"))
        if is_take(path) and NAME.fullmatch(path.stem) is not None
    )


def read_takes(folder: Path, recorder: ClipRecorder) -> Iterator[DiverTake]:
    """Yield one take a clip: what lies between salutes, or all of it where there are none.

    Raises
    ------
    OsgError
        When a clip cannot be read, or the models are not installed.

    """
    for path in find_clips(folder):
        if (name := NAME.fullmatch(path.stem)) is None:
            continue
        recording = recorder.record(path)
        takes = takes_in(recording)
        yield DiverTake(
            source=str(path.relative_to(folder)),
            label=path.parent.name,
            setting=f"{name['place']} {name['view']}".upper(),
            poses=takes[0].poses if takes else recording.poses,
        )
