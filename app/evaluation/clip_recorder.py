"""Clip recorder: finds the poses in clips and keeps the recordings, so that a clip is read once."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

from app.clip_sources import ReadOptions, source_of
from app.evaluation.kept_recordings import RECORDING_ENDING, kept_recording, recordings_dir
from app.keypoint_files import KeypointOptions
from app.recognition import Recording
from app.recognition.estimation import PoseEstimator, create_estimator
from app.recognition.recording.extraction import record_frames
from app.recognition.recording.video import FrameSource

Progress = Callable[[int, int, str], None]
"""``progress(done, total, name)``: frames of the file of that name."""


class ClipRecorder:
    """Records clips, keypoint files and frames; loads the models at the first picture.

    Parameters
    ----------
    keep_in
        Cache folder of recordings, `recordings_dir` by default. The key is a clip's content, so a
        clip may be renamed or moved.
    keypoints
        Values that keypoint files do not contain.
    progress
        Called after every extracted frame; an exception in it stops the extraction.

    """

    def __init__(
        self,
        keep_in: Path | None = None,
        *,
        keypoints: KeypointOptions | None = None,
        progress: Progress | None = None,
    ) -> None:
        self._folder = keep_in or recordings_dir()
        self._options = ReadOptions.of_keypoints(keypoints or KeypointOptions())
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
        kept = kept_recording(path, self._folder)
        if kept.is_file():
            return Recording.load(kept)
        progress = None
        if self._progress is not None:
            progress = partial(self._advance, path.name, self._progress)
        recording = source.record(
            path, self._options, estimator=self._open_estimator(), progress=progress
        ).recording
        self._folder.mkdir(parents=True, exist_ok=True)
        recording.save(kept)
        return recording

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

    @staticmethod
    def _advance(name: str, progress: Progress, done: int, total: int) -> None:
        progress(done, total, name)
