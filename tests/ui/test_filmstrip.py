"""Frames on display: decoded in the background, small, and few."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from threading import Event, Thread

import numpy as np
import pytest

from app.ui import filmstrip as module
from app.ui.filmstrip import Filmstrip
from tests.recognition.damaged_clips import write_clip

PATIENCE = 60.0
"""Seconds that decoding a handful of frames may take on a loaded machine."""


@pytest.fixture
def clip(tmp_path: Path) -> Path:
    """Return a clip of twelve frames."""
    return write_clip(tmp_path / "clip.mp4")


def decoded(strip: Filmstrip) -> Iterator[int]:
    """Decode, and give the indices of the frames that are nearest to 0 .. 11."""
    strip.start()
    assert strip.wait(PATIENCE)
    for frame in range(12):
        found = strip.nearest(frame)
        assert found is not None
        yield found[0]


def test_every_frame_of_a_short_range_can_be_shown(clip: Path) -> None:
    arrived: list[int] = []
    assert list(decoded(Filmstrip(clip, 0, 11, arrived.append))) == list(range(12))
    assert arrived == list(range(12))


def test_only_the_range_is_kept(clip: Path) -> None:
    strip = Filmstrip(clip, 4, 6)
    assert sorted(set(decoded(strip))) == [4, 5, 6]
    assert len(strip) == 3


def test_of_a_long_range_every_nth_frame_is_kept(
    clip: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "MAX_FRAMES", 4)
    strip = Filmstrip(clip, 0, 11)
    assert sorted(set(decoded(strip))) == [0, 3, 6, 9]
    for frame in range(-1, 13):
        nearest = strip.nearest(frame)
        assert nearest is not None
        assert strip.kept(frame) == nearest[0]


def test_frames_are_upright_rgb_and_no_wider_than_shown(
    clip: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "MAX_WIDTH", 16)
    strip = Filmstrip(clip, 0, 0)
    list(decoded(strip))
    found = strip.nearest(0)
    assert found is not None
    assert found[1].shape[1:] == (16, 3)
    assert found[1].dtype == np.uint8


def test_before_anything_is_decoded_there_is_nothing_to_show(clip: Path) -> None:
    assert Filmstrip(clip, 0, 11).nearest(0) is None


def test_an_unreadable_clip_is_an_error_to_read_not_a_crash(tmp_path: Path) -> None:
    broken = tmp_path / "broken.mp4"
    broken.write_bytes(b"no video at all")
    strip = Filmstrip(broken, 0, 10)
    strip.start()
    assert strip.wait(PATIENCE)
    assert strip.nearest(0) is None
    assert "broken.mp4" in (strip.error or "")


def test_closing_ends_the_decoding(clip: Path) -> None:
    held = Event()

    def hold(_index: int) -> None:
        held.wait(PATIENCE)

    strip = Filmstrip(clip, 0, 11, hold)
    strip.start()
    closing = Thread(target=strip.close)
    closing.start()
    held.set()
    closing.join(PATIENCE)
    assert not closing.is_alive()
    assert strip.wait(0)
