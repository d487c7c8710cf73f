"""SCUBANetV2: clips of a diver who repeats one sign, with a label for every frame.

``NAME.mp4`` beside ``NAME.json``: ``{"file_name": ..., "labels": [{"frame": 0, "label": null},
...]}``. Label null: nothing is said about the frame; ``Idle``: no sign. Layout as described by
YorkCFR/SCUBANetV2.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

from pydantic import BaseModel, NonNegativeInt, ValidationError

from app.evaluation.labelled_takes import ClipRecorder
from app.recognition import OsgError
from benchmarks.sets.divers.diver_take import DiverTake, find_runs

IDLE = "Idle"
"""Label of frames without a sign."""

SHORTEST = 5
"""Fewest frames of a run; a shorter one is a labelling mistake."""


class FrameLabel(BaseModel):
    """The label of one frame."""

    frame: NonNegativeInt
    label: str | None


class ClipLabels(BaseModel):
    """The labels of one clip."""

    file_name: str
    labels: list[FrameLabel]


def find_label_files(folder: Path) -> tuple[Path, ...]:
    """Find the label files that have a clip of their name beside them."""
    return tuple(
        path for path in sorted(folder.rglob("*.json")) if path.with_suffix(".mp4").is_file()
    )


def read_takes(folder: Path, recorder: ClipRecorder) -> Iterator[DiverTake]:
    """Yield one take for every run of frames with the same label, also of those without a sign.

    Raises
    ------
    OsgError
        When a clip or its labels cannot be read, or the models are not installed.

    """
    for path in find_label_files(folder):
        labels = _read_labels(path)
        poses = recorder.record(path.with_suffix(".mp4")).poses
        in_order = [labels.get(index) for index in range(len(poses))]
        for label, first, last in find_runs(in_order):
            if label is not None and last - first + 1 >= SHORTEST:
                yield DiverTake(
                    source=f"{path.stem}, frames {first} to {last}",
                    label=None if label == IDLE else label,
                    setting=path.stem,
                    poses=poses.between(float(poses.time[first]), float(poses.time[last])),
                )


def _read_labels(path: Path) -> dict[int, str | None]:
    """Return the label of each frame that has an entry."""
    try:
        content = ClipLabels.model_validate(json.loads(path.read_text(encoding="utf-8")))
    except (ValidationError, ValueError) as error:
        raise OsgError(f"{path.name} is no label file of SCUBANetV2: {error}") from error
    return {each.frame: each.label for each in content.labels}
