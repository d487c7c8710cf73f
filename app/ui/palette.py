"""Palette: reads the colours of the page from its style sheet ``static/styles/tokens.css``.

The page, the viser workspace and the exported page share them, so a colour changes in one file.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache

from app.resources import static_dir

Rgb = tuple[int, int, int]
"""sRGB, 0 to 255."""

_DECLARATION = re.compile(r"--([\w-]+):\s*([^;]+);")
_LIGHT = "@media (prefers-color-scheme: light)"
_SUN = ':root[data-look="sun"]'


@dataclass(frozen=True)
class Palette:
    """Custom properties of the style sheet for the dark and the light scheme.

    Attributes
    ----------
    dark, light
        CSS values by name without the dashes, such as ``{"ink": "#e2ecf6"}``.

    """

    dark: dict[str, str]
    light: dict[str, str]


def read_tokens() -> str:
    """Read the style sheet that defines the colours."""
    return (static_dir() / "styles" / "tokens.css").read_text(encoding="utf-8")


@cache
def load_palette() -> Palette:
    """Load the colours of both schemes; the light scheme inherits what it does not define."""
    dark, _, light = read_tokens().partition(_SUN)[0].partition(_LIGHT)
    base = dict(_DECLARATION.findall(dark))
    return Palette(base, base | dict(_DECLARATION.findall(light)))


def parse_colour(value: str) -> Rgb:
    """Parse ``#rrggbb``.

    Raises
    ------
    ValueError
        When the value is not of this form.

    """
    if not re.fullmatch("#[0-9a-fA-F]{6}", value):
        raise ValueError(f"colour {value!r} is not of the form #rrggbb")
    red, green, blue = bytes.fromhex(value[1:])
    return red, green, blue
