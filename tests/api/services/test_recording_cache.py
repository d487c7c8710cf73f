"""Recordings of clips: those in use and those used lately are limited together."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from app.api.http.problems import ProblemError
from app.api.services import recording_cache
from app.api.services.recording_cache import CACHED_RECORDINGS, RecordingCache, whole_recording
from app.recognition.errors import PoseError
from app.recognition.recording.recording import unpacked_bytes
from tests.api.recordings import recording_of


@pytest.fixture
def files(tmp_path: Path) -> list[Path]:
    """Return files of recordings of the same size."""
    made = [tmp_path / f"{number}.npz" for number in range(2 * CACHED_RECORDINGS)]
    for file in made:
        recording_of("circle").save(file)
    return made


def test_a_recording_is_loaded_once(files: list[Path]) -> None:
    cache, file = RecordingCache(), whole_recording(files[0])
    with ThreadPoolExecutor(4) as threads:
        loaded = list(threads.map(cache.get, [file] * 4))
    assert len(set(map(id, loaded))) == 1


def test_what_all_readers_hold_together_is_limited(
    files: list[Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    size = unpacked_bytes(files[0])
    monkeypatch.setattr(recording_cache, "MOST_RECORDED_BYTES", 3 * size)
    cache = RecordingCache()
    # Those that nobody uses make room.
    for file in files:
        cache.get(whole_recording(file))
    held = [cache.get(whole_recording(file)) for file in files[:3]]
    with pytest.raises(ProblemError) as refused:
        cache.get(whole_recording(files[3]))
    assert refused.value.status_code == 503
    assert cache.get(whole_recording(files[2])) is held[2]
    held.pop()
    assert len(cache.get(whole_recording(files[3])).poses) > 0


def test_no_more_are_kept_ready_than_are_looked_at(files: list[Path]) -> None:
    cache = RecordingCache()
    for file in files:
        cache.get(whole_recording(file))
    assert len(cache._sizes) == CACHED_RECORDINGS


def test_a_missing_recording_is_named(tmp_path: Path) -> None:
    with pytest.raises(PoseError, match=r"none\.npz"):
        RecordingCache().get(whole_recording(tmp_path / "none.npz"))
