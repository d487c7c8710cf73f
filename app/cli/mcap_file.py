"""MCAP file of `osg-studio recognize --mcap`: holds the clip and its recognitions."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

from rich.filesize import decimal

from app.bags import bag_and_topic, is_bag
from app.bags.clip import write_video
from app.bags.session_writer import NamedRecognition, write_session
from app.cli.terminal import people, progress_bar
from app.keypoint_files import is_keypoint_file
from app.recognition import Language, Recognition, Recording, Take


def save_session(
    target: Path,
    clip: Path,
    topic: str | None,
    recording: Recording,
    recognitions: Sequence[NamedRecognition],
) -> None:
    """Write a clip and its recognitions to `target`, completely or not at all.

    Parameters
    ----------
    target
        The MCAP file.
    clip, topic
        Source of `recording`, as for `app.cli.clip_argument.read_clip`.
    recording, recognitions
        Landmarks of the clip, and its recognised takes.

    Raises
    ------
    BagError
        When the package that writes MCAP is not installed.

    """
    path, named = bag_and_topic(str(clip))
    with tempfile.TemporaryDirectory(prefix=f".{target.name}-", dir=target.parent) as made:
        partial = Path(made, "session")
        video = _find_video(path, topic or named, Path(made, "video"))
        with progress_bar(target.name) as advance:
            write_session(
                partial, recording, recognitions, video=video, name=path.name, progress=advance
            )
        partial.replace(target)
    people.print(f"{target}: {decimal(target.stat().st_size)}, opens in Foxglove", markup=False)


def name_recognitions(
    language: Language, expected: str | None, results: Sequence[tuple[Take, Recognition]]
) -> list[NamedRecognition]:
    """Return the recognition of each take with the language's name and revision."""
    return [
        NamedRecognition(
            take.stroke_start, take.end, language.name, language.revision, result, expected
        )
        for take, result in results
    ]


def _find_video(path: Path, topic: str | None, copy: Path) -> Path | None:
    """Return the video of a clip; for a bag a copy at `copy`; None where there is no video."""
    if is_bag(path):
        write_video(path, topic, copy)
        return copy
    return None if is_keypoint_file(path) else path
