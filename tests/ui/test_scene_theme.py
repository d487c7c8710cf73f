"""Colours: told apart, and the same in viser as on the page."""

import re
from pathlib import Path

import numpy as np
import pytest

from app.resources import static_dir
from app.ui.panel_style import PANEL_STYLE
from app.ui.scene import DARK, LIGHT, Theme, map_time_colours, to_linear


def test_time_runs_from_blue_to_orange() -> None:
    first, *_, last = map_time_colours(np.linspace(0, 1, 9)).astype(int)
    assert first[2] > first[0]
    assert last[0] > last[2]


def test_every_moment_has_a_colour_of_its_own() -> None:
    colours = map_time_colours(np.linspace(0, 1, 64))
    assert len(np.unique(colours, axis=0)) == 64


def test_linear_keeps_black_and_white_and_darkens_between() -> None:
    greys = np.array([[0, 0, 0], [128, 128, 128], [255, 255, 255]], np.uint8)
    np.testing.assert_array_equal(to_linear(greys)[:, 0], [0, 56, 255])


@pytest.mark.parametrize(("theme", "section"), [(DARK, 0), (LIGHT, 1)])
def test_the_scenes_background_is_the_pages(theme: Theme, section: int) -> None:
    style = Path(static_dir(), "styles", "tokens.css").read_text(encoding="utf-8")
    background = re.findall(r"--bg: #([0-9a-f]{6})", style)[section]
    assert bytes.fromhex(background) == bytes(theme.background)


def test_the_panels_style_closes_what_it_opens() -> None:
    assert PANEL_STYLE.count("{") == PANEL_STYLE.count("}")
    assert PANEL_STYLE.count("<style>") == PANEL_STYLE.count("</style>") == 1
