"""Chapters: the files into which a camera splits one recording, by their names."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Final

GOPRO: Final = re.compile(
    r"(?P<kind>G[HXL])(?P<chapter>\d\d)(?P<number>\d{4})(?P<ending>\.\w+)", re.IGNORECASE
)
"""Names since 2017: the chapters of one recording share the number."""

OLD_GOPRO: Final = re.compile(
    r"G(?:OPR|P(?P<chapter>\d\d))(?P<number>\d{4})(?P<ending>\.\w+)", re.IGNORECASE
)


def list_neighbours(name: str) -> tuple[str | None, str | None]:
    """Return the names of the chapters before and after a file, None where there is none."""
    before, after = None, None
    if match := GOPRO.fullmatch(name):
        chapter = int(match["chapter"])
        kind, rest = match["kind"], f"{match['number']}{match['ending']}"
        before = f"{kind}{chapter - 1:02d}{rest}" if chapter > 1 else None
        after = f"{kind}{chapter + 1:02d}{rest}"
    elif match := OLD_GOPRO.fullmatch(name):
        chapter, rest = int(match["chapter"] or 0), f"{match['number']}{match['ending']}"
        if chapter:
            before = f"GP{chapter - 1:02d}{rest}" if chapter > 1 else f"GOPR{rest}"
        after = f"GP{chapter + 1:02d}{rest}"
    return before, after


def tell_chapters(name: str) -> Iterator[str]:
    """Return a sentence where a clip's name says that a take may begin or end in another file."""
    before, after = list_neighbours(name)
    if after is None:
        return
    parts = f"begins in {before}" if before else f"may go on in {after}"
    yield (
        f"{name} is a chapter of a recording that {parts}; a take across them is read once they "
        "are joined into one file, as by ffmpeg -f concat"
    )
