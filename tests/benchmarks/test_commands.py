"""Benchmarks that a page cites: every command starts, and says what it measures."""

import importlib
import re
import sys

import pytest

from tests.conftest import ROOT

PAGES = [
    *({*ROOT.glob("*.md")} - {ROOT / "CHANGELOG.md"}),  # it cites commands of its time
    *(ROOT / "docs").rglob("*.md"),
    *(ROOT / "benchmarks").rglob("*.md"),
]

CITED = sorted(
    {
        name
        for page in PAGES
        for name in re.findall(r"python -m (benchmarks(?:\.\w+)*)", page.read_text("utf-8"))
    }
)


@pytest.mark.parametrize("name", CITED)
def test_a_cited_benchmark_starts(
    name: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    module = importlib.import_module(name if "." in name else f"{name}.__main__")
    monkeypatch.setattr(sys, "argv", [name, "--help"])
    with pytest.raises(SystemExit) as ended:
        module.main()
    assert ended.value.code == 0
    assert len(capsys.readouterr().out.splitlines()) > 5
