"""Panel style: CSS of our HTML inside viser, and of the parts of viser that it restyles."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from app.ui.palette import load_palette

CHART_COLOURS: Final = {
    "ink": "ink",
    "dim": "dim",
    "line": "line",
    "tile": "raised",
    "accent": "accent",
    "chosen": "accent-text",
    "expected": "expected",
    "x": "accent-text",
    "y": "expected",
    "picture": "picture",
}
"""Name in the palette of each custom property ``--osg-*`` that the charts use."""

_VISER_COLOURS: Final = {
    "color-body": "panel",
    "color-dark-7": "panel",
    "color-dark-6": "raised",
    "color-dark-5": "line",
    "color-dark-4": "line",
    "color-text": "ink",
}
"""Name in the palette of each custom property ``--mantine-*`` of viser's dark scheme."""


def alias_chart_colours() -> str:
    """Return CSS that defines ``--osg-*`` from the palette of the same page."""
    names = (f"--osg-{name}: var(--{token})" for name, token in CHART_COLOURS.items())
    return f":root {{ {'; '.join(names)}; }}"


def _define(prefix: str, names: Mapping[str, str], colours: Mapping[str, str]) -> str:
    return " ".join(f"--{prefix}-{name}: {colours[token]};" for name, token in names.items())


def _define_schemes() -> str:
    """Return CSS that defines the colours for viser's light and dark scheme."""
    palette = load_palette()
    dark = _define("osg", CHART_COLOURS, palette.dark)
    viser = _define("mantine", _VISER_COLOURS, palette.dark)
    return (
        f":root {{ {_define('osg', CHART_COLOURS, palette.light)} }}\n"
        f':root[data-mantine-color-scheme="dark"] {{ {dark} {viser} }}\n'
    )


_RULES: Final = """
:root, body { --mantine-font-family: ui-sans-serif, system-ui, "Noto Sans", "DejaVu Sans",
  sans-serif; font-family: var(--mantine-font-family); }
.osg { padding: 4px 12px 10px; color: var(--osg-ink); font: 12px/1.45 var(--mantine-font-family); }
.osg h3 { margin: 14px 0 6px; font-size: 12px; font-weight: 600; color: var(--osg-dim); }
.osg p { margin: 0; }
.osg .dim { color: var(--osg-dim); }
.osg .num { font-variant-numeric: tabular-nums; }
.osg .card { padding: 12px 14px; border-radius: 10px; background: var(--osg-tile);
  border: 1px solid var(--osg-line); }
.osg .verdict { display: flex; gap: 12px; align-items: flex-start; }
.osg .verdict b { font-size: 15px; }
.osg .badge { flex: none; width: 28px; height: 28px; border-radius: 50%; display: grid;
  place-items: center; font-weight: 700; font-size: 15px; border: 2px solid currentColor; }
.osg .chosen { color: var(--osg-chosen); }
.osg .expected { color: var(--osg-expected); }
.osg .tag { font-size: 10px; font-weight: 600; padding: 0 5px; border-radius: 99px;
  border: 1px solid currentColor; white-space: nowrap; display: table;
  margin-top: 2px; }
.osg thead .tag { writing-mode: vertical-rl; padding: 5px 0; display: inline-block;
  margin: 5px 0 0; }
.osg .tag.expected { border-style: dashed; }
.osg .scroll { overflow-x: auto; }
.osg table { border-collapse: separate; border-spacing: 2px; width: 100%; }
.osg thead th { vertical-align: bottom; font-weight: 500; color: var(--osg-dim); padding: 0 0 4px; }
.osg table { table-layout: fixed; }
.osg thead th:nth-child(1) { width: 112px; text-align: left; }
.osg thead th:nth-child(2) { width: 36px; }
.osg thead th.gesture { width: 36px; }
.osg thead th.chosen, .osg thead th.expected { font-weight: 700; color: var(--osg-ink); }
.osg thead th.gesture span { writing-mode: vertical-rl; transform: rotate(180deg);
  white-space: nowrap;
  margin: 0 auto; display: block; }
.osg tbody th { text-align: left; font-weight: 500; padding: 3px 6px 3px 0; line-height: 1.25;
  overflow: hidden; text-overflow: ellipsis; }
.osg td { text-align: center; padding: 5px 0 8px; border-radius: 6px; font-size: 10.5px;
  font-variant-numeric: tabular-nums; color: var(--osg-dim); }
.osg td.choice { font-weight: 700; color: var(--osg-ink);
  box-shadow: inset 0 0 0 2px var(--osg-chosen); }
.osg td.choice { position: relative; }
.osg td.choice::after { content: ""; position: absolute; left: calc(50% - 3px); bottom: 3px;
  width: 6px; height: 6px; border-radius: 50%; background: var(--osg-chosen); }
.osg .mute { opacity: .45; }
.osg td.share { background: none; padding-right: 4px; text-align: right; }
.osg tfoot th { text-align: left; font-weight: 500; color: var(--osg-dim); }
.osg td.votes { font-weight: 700; color: var(--osg-ink); font-size: 11px; }
.osg .images { display: grid; grid-template-columns: repeat(3, minmax(0, 120px)); gap: 8px; }
.osg figure { margin: 0; }
.osg figure img { width: 100%; display: block; border-radius: 8px; background: var(--osg-picture); }
.osg figcaption { padding-top: 4px; text-align: center; }
.osg .chart { position: relative; }
.osg .chart svg { display: block; width: 100%; height: auto; overflow: visible; }
.osg .chart .cursor { position: absolute; top: 0; bottom: 0; left: 34px; right: 6px;
  pointer-events: none; }
.osg .chart .cursor i { position: absolute; top: 0; bottom: 18px; width: 0; opacity: .75;
  left: var(--osg-now, 0%); border-left: 1.5px solid var(--osg-ink); }
.osg .legend { display: flex; flex-wrap: wrap; gap: 4px 14px; margin: 4px 0 0; padding: 0;
  list-style: none; color: var(--osg-dim); }
.osg .legend svg { vertical-align: middle; margin-right: 5px; }

/* viser's second grip has no function here, and its title bar opens developer settings. */
[data-dock-griphandle], [data-testid="floating-panel-handle"], #webgl-software-rendering,
[data-dock-region-handle] > div:first-child { display: none !important; }
[data-dock-strip] { padding-left: 4px; }
/* The page has the playback bar; an empty panel would float over the video. */
[data-testid="floating-panel"] { display: none !important; }
/* The sheet that takes the panels' place on a phone is as wide as the phone. */
div[style*="width: 20em"] { width: 100% !important; }
"""

EMBEDDED: Final = """<style>
[data-embedded] [data-dock-region],
[data-embedded] [data-dock-root] > div:not(:first-child),
[data-embedded] .mantine-Paper-root[style*='position: fixed'] { display: none !important; }
[data-embedded] [data-dock-root] > div:first-child { inset: 0 !important; width: auto !important; }
</style>"""
"""Leaves the whole frame to the picture, without panel and without a phone's sheet, where the page
has marked viser's document as its frame."""

PANEL_STYLE: Final = f"<style>\n{_define_schemes()}{_RULES}</style>"
"""Markup for viser's `add_html`, whose style sheet applies to the whole page of viser.

The rules for viser itself use attributes of that client; if a later version renames them, its own
look returns and nothing breaks.
"""
