"""Rendered clips: languages shown by one diver, and takes of other divers, read by the models.

They are the only sets whose keypoints have a pose model's errors, and whose takes lie between two
salutes. A clip without a take is left out.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from pathlib import Path

import numpy as np

from app.recognition import find_takes
from benchmarks.sets.recorded_sets import RecordedSet

CLIPS = ("strokes", "rendered_letters")
"""Folders of clips named ``LABEL_demo.mp4``, and ``LABEL_`` and anything else for the takes."""

DEMONSTRATOR, OTHERS = "demonstrator", "others"
"""The two people of a set: only the first has shown every class."""


def rendered_clips(folder: Path, names: Collection[str] | None = None) -> Iterator[RecordedSet]:
    """Read the sets of clips in `folder` with their first takes; missing folders are left out."""
    for name in CLIPS if names is None else names:
        shown = [
            (
                takes[0].poses,
                clip.stem.partition("_")[0],
                DEMONSTRATOR if clip.stem.endswith("_demo") else OTHERS,
            )
            for clip in sorted((folder / name).glob("*.mp4"))
            if (takes := find_takes(clip))
        ]
        if shown:
            recordings, labels, people = zip(*shown, strict=True)
            yield RecordedSet(name, [*recordings], np.array(labels), np.array(people))
