"""Labelled takes: extracts takes from labelled files and caches the recordings."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from app.clip_sources import ReadOptions, is_take, source_of
from app.evaluation.kept_recordings import RECORDING_ENDING, kept_recording, recordings_dir
from app.evaluation.one_shot import LabelledTake
from app.recognition import Recording, takes_in
from app.recognition.errors import ModelError, OsgError
from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.factory import create_estimator
from app.recognition.recording.extraction import record_frames
from app.recognition.recording.video import FrameSource
from app.recognition.text.look_alikes import compose
from app.recognition.triggers.trigger import SALUTE, Trigger

LAYOUTS = ("{label}_*", "{label}/*", "{person}/{label}/*")
"""Default layouts for files one, two and three levels deep."""

SEPARATORS = "_-. "
"""Characters that end the label of a file directly in the folder: ``circle-1.mp4``."""

_FIELDS = {
    "{label}": r"(?P<label>[^/]+?)",
    "{person}": r"(?P<person>[^/]+?)",
    "*": r"[^/]*",
    "#": r"\d+",
}


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


@dataclass(frozen=True)
class LabelledFile:
    """A file with the label and person in its path.

    Attributes
    ----------
    path
        The clip, the saved recording, or the keypoint file (of OpenPose, the folder).
    label
        The gesture it shows.
    person
        Person who shows it; empty where the layout has none.

    """

    path: Path
    label: str
    person: str = ""


def labelled_files(folder: Path, layout: str | None = None) -> tuple[LabelledFile, ...]:
    """Find the clips, recordings and keypoint files of a folder, with their labels.

    Parameters
    ----------
    folder
        Searched with its subfolders; names that begin with a dot are ignored.
    layout
        Pattern of a file's path below the folder, without suffix, such as ``{person}/{label}_#``:
        ``{label}`` and ``{person}`` match as little as possible, ``*`` any text within one level,
        ``#`` a number. None: one of `LAYOUTS` by depth, where the label of a file directly in the
        folder may end in any of `SEPARATORS`.

    Returns
    -------
    The files in the order of their paths.

    Raises
    ------
    OsgError
        When the layout has no label, or no file matches.

    """
    if layout is not None and "{label}" not in layout:
        raise OsgError(f"layout {layout!r} has no {{label}}: add it, as in {{person}}/{{label}}_#")
    found = []
    for path in _readable(folder):
        relative = PurePosixPath(path.relative_to(folder).as_posix())
        name = str(relative if path.is_dir() else relative.with_suffix(""))
        if fields := _read(name, layout):
            label, person = (compose(fields.get(key) or "") for key in ("label", "person"))
            found.append(LabelledFile(path, label, person))
    if not found:
        raise OsgError(
            f"{folder} holds no clip that fits {layout or ' or '.join(LAYOUTS)}; name its files "
            "so, or give their layout with --layout"
        )
    return tuple(found)


def _readable(folder: Path) -> Iterator[Path]:
    """Yield the files that may be takes; a folder of OpenPose is one take, not its frames."""
    for path in sorted(folder.iterdir()):
        if path.name.startswith("."):
            continue
        if is_take(path) or (path.is_file() and path.suffix.lower() == RECORDING_ENDING):
            yield path
        elif path.is_dir():
            yield from _readable(path)


def _read(name: str, layout: str | None) -> dict[str, str] | None:
    """Read label and person from a path without suffix; None where it does not match."""
    if layout is None:
        depth = name.count("/")
        if depth >= len(LAYOUTS):
            return None
        if depth == 0:
            return {"label": re.split(f"[{re.escape(SEPARATORS)}]", name, maxsplit=1)[0]}
        layout = LAYOUTS[depth]
    parts = re.split(r"(\{label\}|\{person\}|\*|#)", layout)
    pattern = "".join(_FIELDS.get(part, re.escape(part)) for part in parts)
    match = re.fullmatch(pattern, name)
    return match.groupdict() if match else None
