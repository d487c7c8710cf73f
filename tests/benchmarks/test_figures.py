"""Figures: how they are written, kept and quoted."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from benchmarks.figures import (
    OLD,
    Figure,
    FigureError,
    Measured,
    Measurement,
    Results,
    fill,
    mean,
    ratio,
    read_results,
    share,
    table,
)
from tests.benchmarks.small_topic import TABLES, draw_numbers

FIGURES = (
    share("right", 566, 600),
    share("none", 0, 0),
    ratio("speed", [0.081, 0.2, 0.05]),
    ratio("once", [1.5]),
    mean("growth", [-3.0, 1.0, 2.0]),
    Figure("clips", 18_014, 1, unit=""),
)


def measured(*figures: Figure, tree: str = "same") -> Measured:
    return Measured(
        data="digits",
        protocol="one",
        people=10,
        command="python -m benchmarks --only topic/part",
        commit="c" * 40,
        trees={"app/recognition": tree},
        seconds=1.0,
        data_hash=None,
        figures={each.name: each for each in figures},
    )


@pytest.fixture
def results() -> Results:
    numbers = measured(*draw_numbers(quick=True))
    return Results({"topic/part": measured(*FIGURES), "small/numbers": numbers})


@pytest.mark.parametrize(
    ("figure", "style", "text"),
    [
        ("right", "", "94.3 % (92-96)"),
        ("right", "cell", "94.3 (92-96)"),
        ("right", "bare", "94.3"),
        ("right", "whole", "94"),
        ("right", "n", "600"),
        ("right", "hits", "566"),
        ("none", "", "0.0 %"),
        ("speed", "", "0.08 (0.05-0.20)"),
        ("once", "", "1.50"),
        ("growth", "", "0 (-2.99 to 2.99)"),
        ("clips", "", "18014"),
        ("right", "cell?", "94.3 (92-96)"),
        ("wrong", "cell?", "-"),
    ],
)
def test_a_figure_is_written_in_the_style_that_a_page_asks_for(
    results: Results, figure: str, style: str, text: str
) -> None:
    assert results.show("topic/part", figure, style) == text


def test_pages_are_filled_again_and_again(results: Results) -> None:
    page = (
        "Right <!--= topic/part right whole-->?<!--/--> of 100.\n\n"
        "<!--table numbers--><!--/-->\n\nNothing <!-- else --> changes.\n"
    )
    filled = fill(page, results, TABLES)
    assert "Right <!--= topic/part right whole-->94<!--/--> of 100." in filled
    assert "<!--table numbers-->\n\n| draws above a half |\n| --- |\n" in filled
    assert filled.endswith("|\n\n<!--/-->\n\nNothing <!-- else --> changes.\n")
    assert fill(filled, results, TABLES) == filled


@pytest.mark.parametrize(
    ("quoted", "words"),
    [
        ("<!--= topic/part wrong--><!--/-->", "nobody measured topic/part wrong"),
        ("<!--= topic/other right--><!--/-->", "nobody measured topic/other right"),
        ("<!--table others--><!--/-->", "no table is called others"),
    ],
)
def test_a_page_cannot_quote_what_nobody_measured(
    results: Results, quoted: str, words: str
) -> None:
    with pytest.raises(FigureError, match=words):
        fill(quoted, results, TABLES)


def test_a_figure_is_marked_that_was_measured_before_the_last_change(results: Results) -> None:
    changed = replace(results, trees={"app/recognition": "other", "benchmarks": "any"})
    assert changed.show("topic/part", "right", "whole") == f"94{OLD}"
    same = replace(results, trees={"app/recognition": "same", "benchmarks": "any"})
    assert same.show("topic/part", "right", "whole") == "94"


def test_what_is_kept_is_read_again(tmp_path: Path) -> None:
    file = tmp_path / "results.json"
    content = {"measurements": {"topic/part": measured(*FIGURES).to_dict()}}
    file.write_text(json.dumps(content), encoding="utf-8")
    (name,) = read_results(file).names("topic")
    assert name == "part"
    again = read_results(file)
    for figure in FIGURES:
        found = again.find("topic/part", figure.name)
        assert found.value == pytest.approx(figure.value, rel=1e-3)
        assert (found.n, found.unit) == (figure.n, figure.unit)
    assert read_results(tmp_path / "nothing.json").measured == {}


def test_figures_of_a_method_stand_beside_those_of_the_others() -> None:
    before, mine = measured(share("full", 9, 10)), measured(share("mine", 1, 10))
    assert [*mine.beside(before).figures] == ["full", "mine"]
    assert mine.beside(None) == mine


def test_the_hash_of_the_data_is_that_of_every_file_in_it(tmp_path: Path) -> None:
    def hash_data() -> str | None:
        reads = (tmp_path / "clips",)
        return Measurement("a/b", draw_numbers, "clips", "read", reads=reads).hash_data()

    (tmp_path / "clips" / "more").mkdir(parents=True)
    (tmp_path / "clips" / "more" / "dive.mp4").write_bytes(b"one")
    first = hash_data()
    assert first == hash_data()
    (tmp_path / "clips" / "more" / "dive.mp4").write_bytes(b"two")
    assert first != hash_data()
    assert Measurement("a/b", draw_numbers, "none", "reads none").hash_data() is None


def test_a_table_is_markdown() -> None:
    written = table(("set", "right"), [["digits", "1"]])
    assert written == "| set | right |\n| --- | --- |\n| digits | 1 |"


@pytest.mark.parametrize("text", ["{", "{}", '{"measurements": {"a/b": {}}}'])
def test_a_damaged_file_of_results_is_named_and_told_how_to_come_back(
    tmp_path: Path, text: str
) -> None:
    path = tmp_path / "results.json"
    path.write_text(text, "utf-8")
    with pytest.raises(FigureError, match=r"is damaged .* git checkout"):
        read_results(path)
