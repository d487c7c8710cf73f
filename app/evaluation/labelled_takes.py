"""Labelled takes: extracts takes from labelled files and caches the recordings."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from app.evaluation.clip_recorder import ClipRecorder, Progress
from app.evaluation.labelled_files import LabelledFile
from app.evaluation.one_shot import LabelledTake
from app.keypoint_files import KeypointOptions
from app.recognition import Recording, takes_in
from app.recognition.errors import ModelError, OsgError
from app.recognition.triggers.trigger import SALUTE, Trigger


@dataclass(frozen=True, eq=False)
class Collection:
    """The takes of a folder.

    Attributes
    ----------
    takes
        Takes in the order of the files.
    problems
        Reason for each file that could not be read.

    """

    takes: tuple[LabelledTake, ...]
    problems: dict[str, str]


def collect_takes(
    files: Sequence[LabelledFile],
    *,
    keep_in: Path | None = None,
    keypoints: KeypointOptions | None = None,
    trigger: Trigger = SALUTE,
    progress: Progress | None = None,
) -> Collection:
    """Read all files and collect their takes; unreadable files become problems.

    Parameters
    ----------
    files
        Clips, recordings that `Recording.save` wrote, and keypoint files of other programs.
    keep_in
        Cache folder of recordings, `recordings_dir` by default. The key is a clip's content, so a
        clip may be renamed or moved.
    keypoints
        Values that keypoint files do not contain.
    trigger
        What begins and ends a take.
    progress
        Called after every extracted frame; an exception in it stops the extraction.

    Raises
    ------
    ModelError
        When a clip must be extracted and the models are not installed.

    """
    takes: list[LabelledTake] = []
    problems: dict[str, str] = {}
    with closing(ClipRecorder(keep_in, keypoints=keypoints, progress=progress)) as recorder:
        for file in files:
            try:
                takes += _takes(file, recorder.record(file.path), trigger)
            except ModelError:
                raise
            except (OsgError, OSError) as error:
                problems[str(file.path)] = str(error)
    return Collection(tuple(takes), problems)


def _takes(file: LabelledFile, recording: Recording, trigger: Trigger) -> list[LabelledTake]:
    """Return the takes between triggers, or the whole recording where there are none."""
    found = [take.poses for take in takes_in(recording, trigger=trigger)] or [recording.poses]
    sources = [f"{file.path}, take {number}" for number in range(1, len(found) + 1)]
    if len(found) == 1:
        sources = [str(file.path)]
    return [
        LabelledTake(source, file.label, file.person, poses)
        for source, poses in zip(sources, found, strict=True)
    ]
