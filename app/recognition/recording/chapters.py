"""Chapters: the files into which a camera splits one recording, by their names."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Final

GOPRO: Final = re.compile(r"(G[HXLP])(\d\d)(\d{4}\.\w+)|GOPR(\d{4}\.\w+)", re.IGNORECASE)
"""GoPro's names: kind, chapter and number, which the chapters share. Until 2017 the first chapter
was called ``GOPR``, and the next one ``GP01``."""


def tell_chapters(name: str) -> Iterator[str]:
    """Return a sentence where a clip's name says that a take may begin or end in another file."""
    match = GOPRO.fullmatch(name)
    if match is None:
        return
    kind, chapter, rest = match[1] or "GP", int(match[2] or 0), match[3] or match[4]
    is_old = kind.upper() == "GP"
    if chapter > (0 if is_old else 1):
        before = f"GOPR{rest}" if is_old and chapter == 1 else f"{kind}{chapter - 1:02d}{rest}"
        where = f"begins in {before}"
    else:
        where = f"may go on in {kind}{chapter + 1:02d}{rest}"
    yield (
        f"{name} is a chapter of a recording that {where}; a take across them is read once they "
        "are joined into one file, as by ffmpeg -f concat"
    )
