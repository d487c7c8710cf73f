"""Fonts of printed texts: finds the studio's own font, or one of the system."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

from app.recognition.errors import OsgError

FOLDER = Path(__file__).parent / "fonts"

MOST_FONTS = 3000
"""Most font files that are searched; a system with all of Noto has half as many."""

CACHED_FONTS = 64
"""Number of fonts whose letters are cached."""


@lru_cache(CACHED_FONTS)
def find_font(letters: frozenset[str], *, bold: bool = False) -> Path:
    """Return a font file that has all of these letters.

    DejaVu Sans, which comes with the studio, covers Latin, Greek, Cyrillic, Armenian, Georgian,
    Hebrew and Arabic; for others the system's fonts are searched.

    Raises
    ------
    OsgError
        When no font has all letters.

    """
    needed = {ord(letter) for letter in letters if not letter.isspace()}
    own = FOLDER / ("DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf")
    for path in (own, *_system_fonts()):
        if needed <= _letters_of(path):
            return path
    missing = "".join(sorted(chr(code) for code in needed - _letters_of(own)))
    raise OsgError(
        f"no font on this computer has the letters {missing[:20]!r}; install one, such as Noto "
        "Sans, or print the slate as SVG, which takes the fonts of the browser"
    )


@lru_cache(CACHED_FONTS)
def _letters_of(path: Path) -> frozenset[int]:
    """Return the code points of a font; none if it cannot be read."""
    # Imported here, like the library that writes the PDF, because it takes as long.
    from fontTools.ttLib import TTFont, TTLibError

    try:
        with TTFont(path, fontNumber=0, lazy=True) as font:
            return frozenset(font.getBestCmap() or ())
    except (TTLibError, OSError, AssertionError, KeyError, ValueError):
        return frozenset()


@lru_cache(1)
def _system_fonts() -> tuple[Path, ...]:
    return tuple(path for path, _ in zip(_search(), range(MOST_FONTS), strict=False))


def _search() -> Iterator[Path]:
    for folder in _folders():
        for root, _, names in os.walk(folder):
            for name in sorted(names):
                if name.lower().endswith((".ttf", ".otf", ".ttc")):
                    yield Path(root, name)


def _folders() -> list[Path]:
    home = Path.home()
    if sys.platform == "win32":
        windows = Path(os.environ.get("WINDIR", r"C:\Windows"))
        return [windows / "Fonts", home / "AppData/Local/Microsoft/Windows/Fonts"]
    if sys.platform == "darwin":
        return [Path("/System/Library/Fonts"), Path("/Library/Fonts"), home / "Library/Fonts"]
    return [Path("/usr/share/fonts"), Path("/usr/local/share/fonts"), home / ".local/share/fonts"]
