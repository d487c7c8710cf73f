"""Labelled takes: extracts takes from labelled files and caches the recordings."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from app.clip_sources import ReadOptions, source_of
from app.evaluation.kept_recordings import RECORDING_ENDING, kept_recording, recordings_dir
from app.evaluation.labelled_files import LabelledFile
from app.evaluation.one_shot import LabelledTake
from app.recognition import Recording, takes_in
from app.recognition.errors import ModelError, OsgError
from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.factory import create_estimator
from app.recognition.recording.extraction import record_frames
from app.recognition.recording.video import FrameSource
from app.recognition.triggers.trigger import SALUTE, Trigger

Progress = Callable[[int, int, str], None]
"""``progress(done, total, name)``: frames of the file of that name."""


class ClipRecorder:
    """Records clips, keypoint files and frames; loads the models at the first picture.

    Parameters
    ----------
    keep_in
        Cache folder of recordings, `recordings_dir` by default. The key is a clip's content, so a
        clip may be renamed or moved.
    options
        How files are read; only what concerns keypoint files, and by how much pictures are turned.
    progress
        Called after every extracted frame; an exception in it stops the extraction.

    """

    def __init__(
        self,
        keep_in: Path | None = None,
        *,
        options: ReadOptions | None = None,
        progress: Progress | None = None,
    ) -> None:
        self._folder = keep_in or recordings_dir()
        self._options = options or ReadOptions()
        self._progress = progress
        self._estimator: PoseEstimator | None = None

    def record(self, path: Path) -> Recording:
        """Return the recording of a clip, a saved recording or a keypoint file.

        Raises
        ------
        OsgError
            When the file cannot be read, or the models that it needs are not installed.

        """
        if path.suffix.lower() == RECORDING_ENDING:
            return Recording.load(path)
        source = source_of(path)
        if not source.shows_pictures(path, self._options):
            return source.record(path, self._options).recording
        kept = kept_recording(path, self._folder, self._options.turn)
        if kept.is_file():
            return Recording.load(kept)

        def advance(done: int, total: int) -> None:
            if self._progress is not None:
                self._progress(done, total, path.name)

        estimator = self._open_estimator()
        read = source.record(path, self._options, estimator=estimator, progress=advance)
        self._folder.mkdir(parents=True, exist_ok=True)
        read.recording.save(kept)
        return read.recording

    def record_frames(self, frames: FrameSource) -> Recording:
        """Return the recording of frames that are no file; it is not kept.

        Raises
        ------
        OsgError
            When a frame cannot be read, or the models are not installed.

        """
        return record_frames(frames, estimator=self._open_estimator())

    def close(self) -> None:
        """Release the models."""
        if self._estimator is not None:
            self._estimator.close()

    def _open_estimator(self) -> PoseEstimator:
        if self._estimator is None:
            self._estimator = create_estimator()
        return self._estimator


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
    options: ReadOptions | None = None,
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
    options
        How files are read, see `ClipRecorder`.
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
    with closing(ClipRecorder(keep_in, options=options, progress=progress)) as recorder:
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
