"""The palette: one style sheet, read by the page, the workspace and the exported page."""

from __future__ import annotations

import re

import pytest

from app.resources import static_dir
from app.ui.palette import load_palette, parse_colour, read_tokens
from app.ui.panel_style import CHART_COLOURS, PANEL_STYLE, alias_chart_colours


def test_a_colour_of_the_style_sheet_is_red_green_blue() -> None:
    assert parse_colour("#3a86ff") == (58, 134, 255)


@pytest.mark.parametrize("value", ["#fff", "#ffffff80", "red", "var(--ink)"])
def test_other_forms_are_refused(value: str) -> None:
    with pytest.raises(ValueError, match="#rrggbb"):
        parse_colour(value)


def test_the_light_scheme_inherits_what_it_does_not_define() -> None:
    palette = load_palette()
    assert palette.light.keys() == palette.dark.keys()
    assert palette.light["picture"] == palette.dark["picture"]
    assert palette.light["ink"] != palette.dark["ink"]


def test_the_look_for_sunlight_is_no_scheme_of_the_workspace() -> None:
    palette = load_palette()
    assert palette.light["bg"] == "#f3f6f9"
    assert "#7a2e00" not in palette.light.values()


def test_the_panels_have_no_colour_of_their_own() -> None:
    known = {*load_palette().dark.values(), *load_palette().light.values()}
    assert set(re.findall(r"#[0-9a-f]{3,8}\b", PANEL_STYLE)) <= known


def test_the_exported_page_defines_every_property_that_it_uses() -> None:
    sheet = (static_dir() / "recognition-page" / "recognition-page.css").read_text("utf-8")
    text = read_tokens() + alias_chart_colours() + sheet
    used = set(re.findall(r"var\(--([\w-]+)", text))
    assert used <= {*load_palette().dark, *(f"osg-{name}" for name in CHART_COLOURS)}
