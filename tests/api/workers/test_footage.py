"""The landmarks of many clips: found once per content, and never stored incomplete."""

from __future__ import annotations

import asyncio
import shutil
from pathlib import Path

import pytest

from app.api.workers.footage import Extracted, Footage, FootageProgress
from app.api.workers.worker_processes import Workers
from app.recognition import Recording
from app.settings import Settings
from tests.api.running import until
from tests.recognition.damaged_clips import write_clip

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("installed_models")]


def footage(folder: Path, seen: list[FootageProgress] | None = None) -> Footage:
    """Return the clips of a folder, whose recordings go beside it."""
    told = [] if seen is None else seen
    workers = Workers(Settings(data_dir=folder))
    return Footage(
        sorted(folder.glob("*.mp4")), folder.with_name("recordings"), workers, told.append
    )


def test_every_content_is_read_once_and_a_second_run_reads_nothing(tmp_path: Path) -> None:
    folder = tmp_path / "season"
    folder.mkdir()
    write_clip(folder / "one.mp4", frames=3)
    write_clip(folder / "two.mp4", frames=5)
    shutil.copy(folder / "one.mp4", folder / "same as one.mp4")
    (folder / "broken.mp4").write_bytes(b"\0\0\0\x18ftypmp42")
    seen: list[FootageProgress] = []
    first = footage(folder, seen)
    broken, one, same, two = asyncio.run(first.extract(2))
    assert broken.recording is None
    assert "the clip" in broken.problem
    assert one.recording == same.recording
    assert sorted([one.new, same.new]) == [False, True]
    assert [len(Recording.load(each.recording).poses) for each in (one, two) if each.recording] == [
        3,
        5,
    ]
    assert (seen[-1].clips, seen[-1].done_bytes) == (4, first.total_bytes)
    assert [each.done_bytes for each in seen] == sorted(each.done_bytes for each in seen)
    again = asyncio.run(footage(folder).extract(2))
    assert [each for each in again if each.new] == []
    assert [each.recording for each in again] == [None, one.recording, one.recording, two.recording]


def test_what_is_broken_off_leaves_whole_recordings_alone(tmp_path: Path) -> None:
    folder = tmp_path / "season"
    folder.mkdir()
    write_clip(folder / "a short one.mp4", frames=2)
    write_clip(folder / "long.mp4", frames=2000)
    seen: list[FootageProgress] = []

    async def break_off() -> None:
        work = asyncio.create_task(footage(folder, seen).extract(1))
        await asyncio.to_thread(until, lambda: seen and seen[-1].clips == 1)
        work.cancel()
        await asyncio.wait([work])

    asyncio.run(break_off())
    (kept,) = folder.with_name("recordings").iterdir()
    assert len(Recording.load(kept).poses) == 2
    (folder / "long.mp4").unlink()
    (known,) = asyncio.run(footage(folder).extract(1))
    assert known == Extracted(folder / "a short one.mp4", kept)
