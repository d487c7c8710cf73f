"""What is promised of reliability and security: each promise names a test that is there."""

import re
from pathlib import Path

import pytest

from tests.conftest import ROOT

PAGE = ROOT / "docs" / "reliability.md"
SECURITY = ROOT / "SECURITY.md"


def marked() -> dict[str, list[str]]:
    """Return the tests that carry the mark of each row."""
    found: dict[str, list[str]] = {}
    mark = re.compile(
        # Other decorators, also of several lines, may stand between.
        r'^@pytest\.mark\.withstands\(row="(\w+)"\)\n'
        r"(?:@.*\n|[ )\]].*\n)*(?:async )?def (test_\w+)",
        re.MULTILINE,
    )
    for file in sorted((ROOT / "tests").rglob("test_*.py")):
        for row, test in mark.findall(file.read_text(encoding="utf-8")):
            found.setdefault(row, []).append(f"{file.relative_to(ROOT)}::{test}")
    return found


def test_every_row_of_bad_input_has_a_test_and_every_mark_a_row() -> None:
    rows = re.findall(r"^\| (H\d\d) \|", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    assert rows == [f"H{number:02d}" for number in range(1, 37)]
    assert sorted(marked()) == rows


def test_every_mark_stands_before_a_test() -> None:
    used = sum(
        file.read_text(encoding="utf-8").count("@pytest.mark.withstands(row=")
        for file in (ROOT / "tests").rglob("test_*.py")
        if file != Path(__file__)
    )
    assert sum(map(len, marked().values())) == used


@pytest.mark.parametrize("page", [PAGE, SECURITY], ids=lambda page: page.name)
def test_every_test_named_on_a_page_is_there(page: Path) -> None:
    named = re.findall(r"`(tests/[\w/]+(?:\.py)?)`", page.read_text(encoding="utf-8"))
    assert len(named) > 10
    assert [name for name in named if not (ROOT / name).exists()] == []


def test_every_promise_of_security_names_a_test() -> None:
    _, promises = SECURITY.read_text(encoding="utf-8").split("| --- | --- | --- |\n")
    rows = promises.split("\n\n")[0].splitlines()
    assert len(rows) > 10
    assert [row for row in rows if "`tests/" not in row.split("|")[3]] == []
