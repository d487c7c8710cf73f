"""What `osg-studio recognize --mcap` writes: the clip and all that was recognised, in one file."""

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
    """Write a session to `target`, all of it or nothing.

    Parameters
    ----------
    target
        The MCAP file.
    clip, topic
        Where `recording` was read from, as for `app.cli.clip_argument.read_clip`.
    recording, recognitions
        What was found in the clip, and recognised.

    Raises
    ------
    BagError
        When the package that writes MCAP is not installed.

    """
    path, named = bag_and_topic(str(clip))
    with tempfile.TemporaryDirectory(prefix=f".{target.name}-", dir=target.parent) as made:
        partial = Path(made, "session")
        video = _video(path, topic or named, Path(made, "video"))
        with progress_bar(target.name) as advance:
            write_session(
                partial, recording, recognitions, video=video, name=path.name, progress=advance
            )
        partial.replace(target)
    people.print(f"{target}: {decimal(target.stat().st_size)}, opens in Foxglove", markup=False)


def named_recognitions(
    language: Language, expected: str | None, results: Sequence[tuple[Take, Recognition]]
) -> list[NamedRecognition]:
    """Return what was recognised in each take, with the language's name and revision."""
    return [
        NamedRecognition(
            take.stroke_start, take.end, language.name, language.revision, result, expected
        )
        for take, result in results
    ]


def _video(path: Path, topic: str | None, copy: Path) -> Path | None:
    """Return the video of a clip; of a dive recording, a copy; None: it has none."""
    if is_bag(path):
        write_video(path, topic, copy)
        return copy
    return None if is_keypoint_file(path) else path
