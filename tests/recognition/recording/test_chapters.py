"""Chapters of one recording are known by their names."""

from __future__ import annotations

import pytest

from app.recognition.recording.chapters import tell_chapters


@pytest.mark.parametrize(
    ("name", "where"),
    [
        ("GX010042.MP4", "may go on in GX020042.MP4"),
        ("gh120042.mp4", "begins in gh110042.mp4"),
        ("GOPR0042.MP4", "may go on in GP010042.MP4"),
        ("GP010042.MP4", "begins in GOPR0042.MP4"),
        ("GP020042.MP4", "begins in GP010042.MP4"),
        ("DSC_0042.MP4", None),
        ("dive GX010042.MP4", None),
    ],
)
def test_the_other_chapter_has_the_same_number(name: str, where: str | None) -> None:
    assert [f"that {where};" in told for told in tell_chapters(name)] == [True] * bool(where)
