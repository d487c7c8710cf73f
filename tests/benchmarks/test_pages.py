"""Pages: every number that README and the documentation quote is one that was measured."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from benchmarks.figures import PAGES, fill, read_results
from benchmarks.runner import hash_folders, tables
from tests.conftest import ROOT

MEASURED = [ROOT / "README.md", ROOT / "docs" / "results.md", ROOT / "docs" / "model-card.md"]
"""Pages on which each share is a figure."""

QUOTED = re.compile(r"<!--(=|table) .*?<!--/-->", re.DOTALL)

SHARE = re.compile(r"(?<!Wilson's )\b\d+(\.\d+)? %")


def test_every_page_is_written_from_the_figures() -> None:
    results = read_results(trees=hash_folders())
    old = [
        str(page.relative_to(ROOT))
        for page in PAGES
        if fill(page.read_text("utf-8"), results, tables()) != page.read_text("utf-8")
    ]
    assert not old, "written by `python -m benchmarks --pages`"


@pytest.mark.parametrize("page", MEASURED, ids=lambda page: str(page.relative_to(ROOT)))
def test_no_share_stands_there_that_nobody_measured(page: Path) -> None:
    text = QUOTED.sub("", page.read_text("utf-8"))
    assert [found.group() for found in SHARE.finditer(text)] == []


def test_the_page_of_results_is_short() -> None:
    assert len((ROOT / "docs" / "results.md").read_text("utf-8").splitlines()) <= 200
