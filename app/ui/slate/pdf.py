"""Slate as PDF: writes a page with the letters that it needs embedded."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from datetime import UTC, datetime
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from app.recognition.errors import OsgError
from app.recognition.text.look_alikes import JOINERS
from app.ui.slate.primitives import Disc, Page, Part, Shape, Words
from app.ui.slate.primitives import Path as Line

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


if TYPE_CHECKING:
    from fpdf import FPDF

POINTS_PER_MM = 72 / 25.4

EPOCH = datetime(2026, 1, 1, tzinfo=UTC)
"""The date that every file states, so that the same language gives the same file."""

GREY = 68
BLACK = 0
WHITE = 255

BASELINE = 0.3
"""Distance from the middle of a cell of fpdf2 down to the text's baseline, in font sizes."""


def to_pdf(page: Page) -> bytes:
    """Return a page as a PDF document.

    Letters are shaped and ordered as their script requires: Arabic letters are joined, and Arabic
    and Hebrew run from right to left.

    Raises
    ------
    OsgError
        When no font has the letters of a text.

    """
    # The import takes a quarter of a second, and only a printed slate needs it.
    from fpdf import FPDF

    pdf = FPDF(unit="mm", format=(page.width, page.height))
    pdf.set_creation_date(EPOCH)
    pdf.set_title(page.title)
    pdf.set_auto_page_break(auto=False)
    pdf.set_text_shaping(True)
    pdf.add_page()
    pdf.c_margin = 0  # space between a cell's edge and its text
    for part in page.parts:
        _draw(pdf, part)
    return bytes(pdf.output())


def _draw(pdf: FPDF, part: Part) -> None:
    if isinstance(part, Words):
        _write(pdf, part)
        return
    pdf.set_draw_color(BLACK)
    pdf.set_fill_color(BLACK)
    if isinstance(part, Line):
        with pdf.local_context(
            line_width=part.width, stroke_cap_style="ROUND", stroke_join_style="ROUND"
        ):
            pdf.polyline(list(part.points))
    elif isinstance(part, Shape):
        pdf.polygon(list(part.points), style="F")
    elif isinstance(part, Disc):
        pdf.circle(*part.centre, part.radius, style="F")


def _write(pdf: FPDF, words: Words) -> None:
    text = "".join(each for each in words.text if each.isprintable() or each in JOINERS)
    path = find_font(frozenset(text) - {*JOINERS}, bold=words.bold)
    family = path.name.lower()
    if family not in pdf.fonts:
        pdf.add_font(family, fname=path)
    pdf.set_font(family, size=words.size * POINTS_PER_MM)
    pdf.set_text_color(WHITE if words.white else GREY if words.grey else BLACK)
    x, y = words.at
    shift = {"start": 0.0, "middle": 0.5, "end": 1.0}[words.align]
    width = pdf.get_string_width(text)
    # Only cells of fpdf2 shape their text.
    pdf.set_xy(x - shift * width, y - BASELINE * words.size)
    pdf.cell(w=width, h=0, text=text)
