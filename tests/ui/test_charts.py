"""Charts: what they say, and that nothing a user wrote becomes markup."""

from __future__ import annotations

from html.parser import HTMLParser

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition import Recognition
from app.ui import charts

VOTERS = ("hu", "aspect_ratio", "solidity")
MARKUP = "<img src=x onerror=alert(1)>'\"&"


class Elements(HTMLParser):
    """Collects a document's tags, its text, and its cells by row."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text = ""
        self.rows: list[list[str]] = []
        self._in_cell = False
        self.feed(html)

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attributes)))
        if tag == "tr":
            self.rows.append([])
        if tag in {"td", "th"}:
            self.rows[-1].append("")
            self._in_cell = True

    def handle_endtag(self, tag: str) -> None:
        if tag in {"td", "th"}:
            self._in_cell = False

    def handle_data(self, data: str) -> None:
        self.text += data
        if self._in_cell:
            self.rows[-1][-1] += data

    def named(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.tags if name == tag]


def recognition(
    *, label: str | None = "wedge", gestures: tuple[str, ...] = ("circle", "wedge", "line")
) -> Recognition:
    """Return a recognition in which two voters of three take the second gesture."""
    distances = np.full((3, len(gestures)), 1.0)
    distances[0, 1], distances[1, 1], distances[2, 0] = 0.25, 0.004, 0.5
    return Recognition(
        label=label,
        nearest=gestures[1],
        confidence=0.62,
        profile="paper",
        voters=VOTERS,
        gestures=gestures,
        distances=distances,
        votes={"hu": gestures[1], "aspect_ratio": gestures[1], "solidity": gestures[0]},
    )


@pytest.mark.parametrize(
    ("label", "expected", "words"),
    [
        ("wedge", None, "Recognised as wedge"),
        ("wedge", "wedge", "Recognised as wedge, as expected"),
        ("wedge", "circle", "Taken for wedge, expected circle"),
        (None, "circle", "Not recognised. Nearest is wedge"),
    ],
)
def test_the_verdict_says_in_words_what_came_out(
    label: str | None, expected: str | None, words: str
) -> None:
    text = Elements(charts.verdict(recognition(label=label), expected)).text
    assert words in text
    assert "confidence 62 %, voters with 67 % of the weight" in text


def test_a_pair_is_a_question_and_both_gestures_are_marked() -> None:
    asked = recognition(label=None).model_copy(update={"pair": ("wedge", MARKUP)})
    words = Elements(charts.verdict(asked, "circle"))
    assert f"Between two: wedge or {MARKUP}?" in words.text
    assert "img" not in [tag for tag, _ in words.tags]
    asked = asked.model_copy(update={"pair": ("wedge", "line")})
    table = Elements(charts.vote_table(asked, "line"))
    tagged = [cell for cell in table.rows[0] if "one of two" in cell]
    assert sorted(tagged) == ["lineone of two, expected", "wedgeone of two"]


def test_the_vote_table_has_a_row_per_voter_and_the_largest_weight_comes_first() -> None:
    head, *rows = Elements(charts.vote_table(recognition(), "circle")).rows
    assert head == ["voter", "weight", "wedgechosen", "circleexpected", "line"]
    assert rows == [
        ["hu", "33 %", ".25", "1.00", "1.00"],
        ["aspect ratio", "33 %", ".004", "1.00", "1.00"],
        ["solidity", "33 %", "1.00", ".50", "1.00"],
        ["weight of its voters", "67 %", "33 %", "0 %"],
    ]


def test_voters_of_weight_zero_come_last_and_do_not_count() -> None:
    weights = {"hu": 0.0, "aspect_ratio": 0.3, "solidity": 0.7}
    voted = recognition().model_copy(update={"weights": weights})
    table = Elements(charts.vote_table(voted, None))
    assert [row[:2] for row in table.rows[1:]] == [
        ["solidity", "70 %"],
        ["aspect ratio", "30 %"],
        ["hu", "0 %"],
        ["weight of its voters", "30 %"],
    ]
    assert [row.get("class") for row in table.named("tr")].count("mute") == 1


def test_each_voters_choice_is_marked_once_and_not_by_colour_alone() -> None:
    cells = Elements(charts.vote_table(recognition(), None)).named("td")
    chosen = [cell for cell in cells if cell.get("class") == "choice"]
    assert len(chosen) == len(VOTERS)
    assert "a voter\N{RIGHT SINGLE QUOTATION MARK}s choice" in charts.vote_table(recognition(), "x")


def test_what_cannot_be_compared_is_shown_as_infinitely_far() -> None:
    plain = recognition()
    distances = plain.distances.copy()
    distances[:, 2] = np.inf
    uncomparable = plain.model_copy(update={"distances": distances})
    rows = Elements(charts.vote_table(uncomparable, None)).rows
    assert [row[-1] for row in rows] == ["line", *["\N{INFINITY}"] * 3, "0 %"]


def test_a_large_language_shows_its_nearest_gestures_and_counts_the_rest() -> None:
    gestures = tuple(f"gesture {number}" for number in range(200))
    html = charts.vote_table(recognition(label="gesture 1", gestures=gestures), None)
    assert len(Elements(html).rows[0]) == charts.MAX_COLUMNS + 2
    assert f"{200 - charts.MAX_COLUMNS} farther gestures are not shown" in html


@given(st.text(min_size=1))
def test_no_text_of_a_user_becomes_markup(name: str) -> None:
    plain = recognition()
    named = recognition(label=name, gestures=("circle", name, "line"))
    for draw in (charts.verdict, charts.vote_table):
        expected = [tag for tag, _ in Elements(draw(plain, "circle")).tags]
        assert [tag for tag, _ in Elements(draw(named, "circle")).tags] == expected


def test_captions_hints_and_legends_are_escaped() -> None:
    moments = np.arange(3.0)
    for html in (
        charts.hint(MARKUP, MARKUP),
        charts.image_row([(MARKUP, np.zeros((4, 4), np.uint8))]),
        charts.line_chart(MARKUP, moments, [charts.Curve(MARKUP, moments, "red")]),
    ):
        elements = Elements(html)
        assert MARKUP in elements.text
        assert not [image for image in elements.named("img") if image.get("src") == "x"]


def test_a_curve_is_interrupted_where_it_is_not_known() -> None:
    moments = np.arange(5.0)
    values = np.array([0.0, 1.0, np.nan, 1.0, 0.0])
    html = charts.line_chart("height", moments, [charts.Curve("y", values, "red")])
    (path,) = Elements(html).named("path")
    assert (path["d"] or "").count("M") == 2
    assert "nan" not in html


def test_a_chart_draws_no_more_points_than_it_has_pixels() -> None:
    moments = np.arange(10_000.0)
    html = charts.line_chart("height", moments, [charts.Curve("y", moments, "red")])
    (path,) = Elements(html).named("path")
    assert (path["d"] or "").count("L") <= charts.MAX_CHART_POINTS + 1


@pytest.mark.parametrize("values", [np.zeros(2), np.full(2, np.nan)])
def test_a_flat_or_unknown_curve_is_still_a_chart(values: np.ndarray) -> None:
    html = charts.line_chart("height", np.arange(2.0), [charts.Curve("y", values, "red")])
    assert "<svg" in html
    assert "nan" not in html


def test_a_single_moment_is_no_chart() -> None:
    assert charts.line_chart("height", np.zeros(1), [charts.Curve("y", np.zeros(1), "red")]) == ""


@pytest.mark.parametrize(("share", "shown"), [(0.25, "25.00%"), (-1.0, "0.00%"), (2.0, "100.00%")])
def test_the_cursor_stays_inside_the_chart(share: float, shown: str) -> None:
    assert f"--osg-now: {shown}" in charts.cursor(share)


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0"), (0.0004, "4e-4"), (0.016, ".016"), (0.25, ".25"), (1.07, "1.07"), (12.345, "12.3"),
     (250.4, "250"), (float("inf"), "\N{INFINITY}")],
)  # fmt: skip
def test_distances_are_written_short(value: float, text: str) -> None:
    assert charts.short_number(value) == text
