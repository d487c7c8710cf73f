"""Slate as SVG: writes a page whose texts stay text, in the fonts of the reader's machine."""

from __future__ import annotations

from html import escape

from app.recognition.text.look_alikes import JOINERS
from app.ui.slate.primitives import Disc, Page, Part, Path, Point, Shape

FONTS = "DejaVu Sans, Noto Sans, Arial, Helvetica, sans-serif"


def to_svg(page: Page) -> str:
    """Return a page as an SVG document."""
    size = f'width="{page.width:g}mm" height="{page.height:g}mm"'
    drawn = "\n".join(_draw(part) for part in page.parts)
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<svg xmlns="http://www.w3.org/2000/svg" {size} '
        f'viewBox="0 0 {page.width:g} {page.height:g}" font-family="{FONTS}">\n'
        f"<title>{_text(page.title)}</title>\n"
        f'<rect width="{page.width:g}" height="{page.height:g}" fill="#fff"/>\n{drawn}\n</svg>\n'
    )


def _draw(part: Part) -> str:
    if isinstance(part, Path):
        return (
            f'<polyline points="{_points(part.points)}" fill="none" stroke="#000" '
            f'stroke-width="{part.width:.2f}" stroke-linecap="round" stroke-linejoin="round"/>'
        )
    if isinstance(part, Shape):
        return f'<polygon points="{_points(part.points)}"/>'
    if isinstance(part, Disc):
        x, y = part.centre
        return f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{part.radius:.2f}"/>'
    weight = ' font-weight="700"' if part.bold else ""
    colour = "#fff" if part.white else "#444" if part.grey else "#000"
    return (
        f'<text x="{part.at[0]:.2f}" y="{part.at[1]:.2f}" font-size="{part.size:.2f}" '
        f'fill="{colour}" text-anchor="{part.align}"{weight}>{_text(part.text)}</text>'
    )


def _points(points: tuple[Point, ...]) -> str:
    return " ".join(f"{x:.2f},{y:.2f}" for x, y in points)


def _text(text: str) -> str:
    """Escape a text, without the control characters that XML cannot contain."""
    return escape("".join(each for each in text if each.isprintable() or each in JOINERS))
