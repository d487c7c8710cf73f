"""Slate primitives: lines, shapes and texts of the page in millimetres, for any file format."""

from __future__ import annotations

import unicodedata
from dataclasses import dataclass

from app.recognition.text.look_alikes import JOINERS

Point = tuple[float, float]

WIDE = ("W", "F")
"""East Asian widths of characters as wide as they are high."""

AVERAGE_WIDTH = 0.58
"""Width of other characters, in font sizes: DejaVu Sans's in running text."""


@dataclass(frozen=True)
class Path:
    """A line through points, with round ends; x to the right, y down."""

    points: tuple[Point, ...]
    width: float


@dataclass(frozen=True)
class Shape:
    """A filled polygon."""

    points: tuple[Point, ...]


@dataclass(frozen=True)
class Disc:
    """A filled circle."""

    centre: Point
    radius: float


@dataclass(frozen=True)
class Words:
    """One line of text.

    Attributes
    ----------
    at
        Left, middle or right end of the base line, by `align`.
    size
        Font size.
    white
        White instead of black.

    """

    text: str
    at: Point
    size: float
    bold: bool = False
    grey: bool = False
    white: bool = False
    align: str = "start"


Part = Path | Shape | Disc | Words


@dataclass(frozen=True)
class Page:
    """A page with its parts, from back to front."""

    title: str
    width: float
    height: float
    parts: tuple[Part, ...]


BOLD = 1.2
"""Width of a bold letter relative to a plain one."""


def estimate_width(text: str, size: float, *, bold: bool = False) -> float:
    """Return the estimated width of a line of text."""
    units = sum(
        1.0
        if unicodedata.east_asian_width(letter) in WIDE
        else 0.0
        if letter in JOINERS or unicodedata.combining(letter)
        else AVERAGE_WIDTH
        for letter in text
    )
    return units * size * (BOLD if bold else 1.0)


def fit_size(text: str, size: float, width: float, *, bold: bool = False) -> float:
    """Return the font size, at most `size`, at which a text is no wider than `width`."""
    needed = estimate_width(text, size, bold=bold)
    return size if needed <= width else size * width / needed


def wrap(text: str, size: float, width: float, most: int) -> list[str]:
    """Break a text into at most `most` lines; a longer text ends in an ellipsis."""
    lines: list[str] = []
    line = ""
    for word in _split(text, size, width):
        longer = f"{line} {word}".strip()
        if line and estimate_width(longer, size) > width:
            lines.append(line)
            line = word
        else:
            line = longer
    lines.append(line)
    if len(lines) > most:
        last = lines[most - 1]
        while last and estimate_width(last + "\u2026", size) > width:
            last = last[:-1]
        lines = [*lines[: most - 1], last.rstrip() + "\u2026"]
    return [each for each in lines if each]


def _split(text: str, size: float, width: float) -> list[str]:
    """Return the words of a text; those wider than a line, such as Chinese, in pieces."""
    pieces = []
    for word in text.split():
        piece = ""
        for letter in word:
            if piece and estimate_width(piece + letter, size) > width:
                pieces.append(piece)
                piece = ""
            piece += letter
        pieces.append(piece)
    return pieces
