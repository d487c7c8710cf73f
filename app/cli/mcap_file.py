"""MCAP file of `osg-studio recognize --mcap`: holds the clip and its recognitions."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

from rich.filesize import decimal

from app.bags import bag_and_topic
from app.bags.export_writer import NamedRecognition, write_bag
from app.cli.clip_argument import ClipReading
from app.cli.terminal import progress_bar, tell
from app.clip_sources import source_of
from app.recognition import Language, Recognition, Recording, Take


def save_bag(
    target: Path,
    clip: Path,
    reading: ClipReading,
    recording: Recording,
    language: Language,
    expected: str | None,
    results: Sequence[tuple[Take, Recognition]],
) -> None:
    """Write a clip and its recognitions to `target`, completely or not at all.

    Parameters
    ----------
    target
        The MCAP file.
    clip, reading
        Source of `recording`, as for `app.cli.clip_argument.read_clip`.
    recording
        Landmarks of the clip.
    language, expected, results
        The language by which its takes were recognised, the label meant if known, and the takes.

    Raises
    ------
    BagError
        When the package that writes MCAP is not installed.

    """
    name, revision = language.name, language.revision
    recognitions = [
        NamedRecognition(take.stroke_start, take.end, name, revision, result, expected)
        for take, result in results
    ]
    path, named = bag_and_topic(str(clip))
    with tempfile.TemporaryDirectory(prefix=f".{target.name}-", dir=target.parent) as made:
        partial = Path(made, "session")
        options = reading.options(named)
        source = source_of(path, options.topic)
        video = source.playable_video(path, options, Path(made, "video"))
        with progress_bar(target.name) as advance:
            write_bag(
                partial,
                recording,
                recognitions,
                video=video,
                name=path.name,
                trigger=language.trigger,
                progress=advance,
            )
        partial.replace(target)
    tell(f"{target}: {decimal(target.stat().st_size)}, opens in Foxglove")
