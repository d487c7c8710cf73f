"""Chapters of one recording are known by their names."""

from __future__ import annotations

import pytest

from app.recognition.recording.chapters import list_neighbours, tell_chapters


@pytest.mark.parametrize(
    ("name", "before", "after"),
    [
        ("GX010042.MP4", None, "GX020042.MP4"),
        ("gh120042.mp4", "gh110042.mp4", "gh130042.mp4"),
        ("GOPR0042.MP4", None, "GP010042.MP4"),
        ("GP010042.MP4", "GOPR0042.MP4", "GP020042.MP4"),
        ("GP020042.MP4", "GP010042.MP4", "GP030042.MP4"),
        ("DSC_0042.MP4", None, None),
        ("dive GX010042.MP4", None, None),
    ],
)
def test_the_next_chapter_has_the_same_number(
    name: str, before: str | None, after: str | None
) -> None:
    assert list_neighbours(name) == (before, after)
    assert [(before or after or "") in told for told in tell_chapters(name)] == [True] * bool(after)
