"""Command ``osg-studio extract``: finds the landmarks of a season's footage, in parallel."""

from __future__ import annotations

import asyncio
import os
import shutil
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.bags.staging import is_bag_archive
from app.cli.administration import settings_of
from app.cli.batch import tell_left_out
from app.cli.clip_argument import TurnOption
from app.cli.terminal import progress_bar, tell
from app.clip_sources import CHAPTERS, SOURCES, ReadOptions
from app.evaluation.kept_recordings import RECORDING_ENDING, recordings_dir
from app.recognition.errors import OsgError

if TYPE_CHECKING:
    from app.api.workers.footage import Extracted, Footage, FootageProgress
    from app.api.workers.worker_processes import Workers

SOME_FAILED = 1
"""Exit code when a clip could not be read; the others are done."""

_KILOBYTE = 1000


def extract(
    folder: Annotated[
        Path,
        typer.Argument(
            exists=True, file_okay=False, help="Folder of videos and dive recordings, at any depth."
        ),
    ],
    workers: Annotated[
        int | None,
        typer.Option(
            min=1,
            max=64,
            help="Clips at the same time, each by a process on one core; by default all cores.",
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(help="Folder to copy the recordings to, named as their clips."),
    ] = None,
    turn: TurnOption = 0,
) -> None:
    """Find the landmarks of all clips of a folder, once; what was done before is skipped."""
    settings = settings_of(None)
    from app.api.workers.footage import Footage
    from app.api.workers.worker_processes import Workers

    clips = list(_clips(folder.absolute()))
    if not clips:
        raise OsgError(f"{folder} holds no video and no dive recording; name the folder of clips")
    tell_left_out(folder.absolute(), clips)
    with progress_bar("clips") as advance:

        def show(progress: FootageProgress) -> None:
            stage = f"{progress.clips} of {len(clips)} clips, kB"
            advance(progress.done_bytes // _KILOBYTE, footage.total_bytes // _KILOBYTE, stage)

        # The clips of a batch are files of a folder, even if the studio has an object store.
        processes = Workers(settings.model_copy(update={"storage": None}))
        footage = Footage(clips, recordings_dir(), processes, show, ReadOptions(turn=turn))
        ended = asyncio.run(_work(footage, processes, workers or _cores()))
    _tell(folder.absolute(), ended, output)


async def _work(footage: Footage, processes: Workers, count: int) -> list[Extracted]:
    try:
        return await footage.extract(count)
    finally:
        await processes.close()


def _clips(folder: Path) -> Iterator[Path]:
    """Yield the files, and folders of chapters, that are clips with pictures, in order."""
    for place, folders, names in os.walk(folder):
        if CHAPTERS.accepts(Path(place)):
            yield Path(place)
            continue
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        for name in sorted(names):
            path = Path(place, name)
            if not name.startswith(".") and _shows_diver(path):
                yield path


def _shows_diver(path: Path) -> bool:
    """Return whether a file is a clip with pictures, by its first bytes.

    One that is so by its name alone is read too, and the reader then explains the fault.
    """
    ending = path.suffix.lower()
    if ending == ".zip":
        return is_bag_archive(path)
    pictured = [source for source in SOURCES if source.has_pictures]
    return any(ending in source.endings or source.accepts(path) for source in pictured)


def _tell(folder: Path, ended: Sequence[Extracted], output: Path | None) -> None:
    """Print each clip with its recording, one a line, and the clips that could not be read."""
    failed = 0
    for each in ended:
        if each.recording is None:
            failed += 1
            tell(f"{each.clip}: {each.problem}")
            continue
        place = each.recording
        if output is not None:
            place = output / each.clip.relative_to(folder)
            place = place.with_name(place.name + RECORDING_ENDING)
            place.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(each.recording, place)
        typer.echo(f"{each.clip}\t{place}")
    new = sum(each.new for each in ended)
    tell(f"{new} clips extracted, {len(ended) - new - failed} known from before, {failed} failed")
    if failed:
        raise typer.Exit(SOME_FAILED)


def _cores() -> int:
    """Return the number of processor cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
