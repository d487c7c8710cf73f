"""Slate: every gesture of a language on one page, in any script, with what divers must do."""

from __future__ import annotations

import re
import struct
import zlib
from dataclasses import replace
from xml.etree import ElementTree

import pytest

from app.recognition import Gesture, Language
from app.recognition.errors import OsgError
from app.recognition.triggers.trigger import NO_TRIGGER
from app.ui.slate.layout import ARROWS, HEAD, MARGIN, lay_out
from app.ui.slate.pdf import find_font, to_pdf
from app.ui.slate.primitives import Disc, Page, Path, Shape, Words, estimate_width, wrap
from app.ui.slate.svg import to_svg
from tests.conftest import ROOT
from tests.posed import BY_BELLY, BY_BELLY_AND_HEAD
from tests.recognition.held_takes import FIST, FLAT, follow, hold

TABLE_2 = Language.load(ROOT / "languages" / "osg-table-2.json")


def words_of(page: Page) -> list[str]:
    return [part.text for part in page.parts if isinstance(part, Words)]


def many(count: int, label: str = "{}") -> Language:
    """Return a language of so many gestures."""
    gestures = [
        replace(TABLE_2.gestures[index % 8], label=label.format(index)) for index in range(count)
    ]
    return Language("pool", gestures)


def test_names_meanings_salute_and_roles_are_on_the_page() -> None:
    texts = words_of(lay_out(TABLE_2))
    assert {*TABLE_2.labels} <= {*texts}
    assert "Go to the waypoint" in texts
    assert "Vulcan salute" in texts
    assert any(text.startswith("A message: circle begins") for text in texts)


def test_another_trigger_stands_in_the_place_of_the_salute() -> None:
    posed, both, bare = (
        lay_out(replace(TABLE_2, trigger=trigger))
        for trigger in (BY_BELLY, BY_BELLY_AND_HEAD, NO_TRIGGER)
    )
    assert "left hand before the body" in words_of(posed)
    assert "left hand before the body; left hand at the head" in words_of(both)
    assert "Without a trigger" in words_of(bare)
    discs = [sum(isinstance(part, Disc) for part in page.parts) for page in (bare, posed, both)]
    assert [after - discs[0] for after in discs] == [0, 3, 6]
    assert not any("salute" in text for page in (posed, both, bare) for text in words_of(page))
    width, height = posed.width, posed.height
    for part in both.parts:
        if isinstance(part, Disc):
            assert MARGIN <= part.centre[0] <= width - MARGIN
            assert 0 < part.centre[1] < height


def test_a_held_hand_is_drawn_with_its_fingers_within_its_square() -> None:
    signs = Language.load(ROOT / "languages" / "signs-of-divers.json")
    (two_hands,) = (each for each in signs.gestures if each.label == "cold")
    page = lay_out(Language("pool", [two_hands]))
    paths = [part for part in page.parts if isinstance(part, Path)]
    (frame,) = (part for part in paths if len(part.points) == 5)
    fingers = [part for part in paths if len(part.points) == 4]
    assert len(fingers) == 10
    left, top = frame.points[0]
    right, bottom = frame.points[2]
    for finger in fingers:
        assert all(left < x < right and top < y < bottom for x, y in finger.points)
    assert [part.text for part in page.parts if isinstance(part, Words) and part.white] == [
        "R",
        "L",
    ]
    assert any("held still" in text for text in words_of(page))
    assert not any("held still" in text for text in words_of(lay_out(TABLE_2)))


def test_two_shapes_in_sequence_are_drawn_with_an_arrow_from_the_first() -> None:
    go = Gesture.from_demonstration("go", follow(hold(FLAT), hold(FIST)))
    page = lay_out(Language("pool", [go]))
    paths = [part for part in page.parts if isinstance(part, Path)]
    fingers = [part for part in paths if len(part.points) == 4]
    assert len(fingers) == 10
    (arrow,) = (
        part for part in paths if len(part.points) == 2 and part.points[0][1] > MARGIN + HEAD
    )
    (head,) = (part for part in page.parts if isinstance(part, Shape) and len(part.points) == 3)
    (tail, tip) = arrow.points
    assert all(x < tail[0] for finger in fingers[:5] for x, _ in finger.points)
    assert all(x > max(corner[0] for corner in head.points) for x, _ in fingers[5].points)
    assert tail[0] < tip[0]
    assert any("An arrow leads to its next shape" in text for text in words_of(page))
    alone = lay_out(Language("pool", [Gesture.from_demonstration("flat", hold(FLAT))]))
    assert not any("An arrow leads" in text for text in words_of(alone))


def test_every_stroke_has_a_start_dot_with_its_hand_and_arrows() -> None:
    (sweep,) = (each for each in TABLE_2.gestures if each.label == "sweep")
    page = lay_out(Language("pool", [sweep]))
    discs = [part for part in page.parts if isinstance(part, Disc)]
    initials = [part.text for part in page.parts if isinstance(part, Words) and part.white]
    arrows = [part for part in page.parts if isinstance(part, Shape) and len(part.points) == 3]
    assert len(discs) == 2
    assert sorted(initials) == ["L", "R"]
    assert len(arrows) == 2 * len(ARROWS)


@pytest.mark.parametrize("count", [1, 2, 8, 24, 64])
def test_everything_lies_on_one_page_and_no_name_leaves_its_column(count: int) -> None:
    page = lay_out(many(count, "a rather long name {}"))
    points = [
        point for part in page.parts if isinstance(part, Path | Shape) for point in part.points
    ]
    for x, y in points:
        assert 0 <= x <= page.width
        assert 0 <= y <= page.height
    for part in page.parts:
        if isinstance(part, Words) and part.align == "start":
            right = part.at[0] + estimate_width(part.text, part.size, bold=part.bold)
            assert right <= page.width - MARGIN + 0.1
            assert part.at[1] <= page.height


def test_a_gesture_without_movement_shows_its_outline() -> None:
    known = TABLE_2.gestures[0]
    drawn = Gesture(label="old", salient=known.salient, image=known.image)
    page = lay_out(Language("pool", [drawn]))
    assert not [part for part in page.parts if isinstance(part, Disc)]
    assert len([part for part in page.parts if isinstance(part, Path)]) > 7


def test_svg_is_well_formed_whatever_the_labels_say() -> None:
    gesture = replace(TABLE_2.gestures[0], label="<b>&\u0444 \u4e0a\u6d6e", command='"</svg>')
    text = to_svg(lay_out(Language("pool & sea", [gesture])))
    root = ElementTree.fromstring(text)
    shown = ["".join(each.itertext()) for each in root.iter("{http://www.w3.org/2000/svg}text")]
    assert "<b>&\u0444 \u4e0a\u6d6e" in shown


def test_pdf_of_other_scripts_is_one_page_and_the_same_each_time() -> None:
    gesture = replace(
        TABLE_2.gestures[0], label="\u0432\u0432\u0435\u0440\u0445 \u03b1\u03bd\u03c9"
    )
    page = lay_out(Language("\u042f\u0437\u044b\u043a", [gesture]))
    content = to_pdf(page)
    assert content.startswith(b"%PDF-")
    assert content.count(b"/Type /Page\n") == 1
    assert content == to_pdf(page)


def test_letters_that_no_font_has_are_named() -> None:
    with pytest.raises(OsgError, match="no font on this computer has the letters"):
        find_font(frozenset("\U0010fffd"))


def test_lines_are_broken_at_words_and_within_words_that_are_too_wide() -> None:
    assert wrap("go to the waypoint", 1.0, 7.0, 3) == ["go to the", "waypoint"]
    assert wrap("go to the waypoint", 1.0, 7.0, 1) == ["go to the\u2026"]
    assert wrap("\u4e0a\u6d6e\u4e0b\u6f5c", 1.0, 2.0, 2) == ["\u4e0a\u6d6e", "\u4e0b\u6f5c"]


SHOWN = re.compile(rb"\(((?:[^()\\]|\\.)*)\) Tj", re.DOTALL)
"""A string of glyphs in a PDF's page, two bytes each."""

STANDS_FOR = re.compile(rb"<([0-9A-F]{4})> <([0-9A-F]{4})>")
"""A glyph's number, and the letter that it is a form of."""


def drawn(text: str) -> list[tuple[int, str]]:
    """Return the glyphs of a line in a PDF, from left to right, and the letters they stand for."""
    content = to_pdf(Page("slate", 210.0, 297.0, (Words(text, (20.0, 20.0), 5.0),)))
    found = [
        zlib.decompress(each) if each.startswith(b"x") else each
        for each in re.findall(rb"stream\n(.*?)\nendstream", content, re.DOTALL)
    ]
    (page,) = (each for each in found if b" Tj" in each)
    (letters,) = (each for each in found if b"beginbfchar" in each)
    known = {int(glyph, 16): chr(int(code, 16)) for glyph, code in STANDS_FOR.findall(letters)}
    shown = b"".join(
        re.sub(rb"\\(.)", lambda it: it[1].replace(b"r", b"\r"), each)
        for each in SHOWN.findall(page)
    )
    glyphs = struct.unpack(f">{len(shown) // 2}H", shown)
    return [(glyph, known[glyph]) for glyph in glyphs]


def test_hebrew_runs_from_right_to_left_in_a_pdf() -> None:
    assert "".join(letter for _, letter in drawn("\u05e9\u05dc\u05d5\u05dd")) == (
        "\u05dd\u05d5\u05dc\u05e9"
    )
    # Numbers and Latin words within it keep their own order.
    mixed = "".join(letter for _, letter in drawn("\u05d0\u05d1 OK 12"))
    assert mixed == "OK 12 \u05d1\u05d0"


def test_arabic_letters_are_joined_in_a_pdf() -> None:
    glyphs = drawn("\u0628\u0628\u0628")
    assert [letter for _, letter in glyphs] == ["\u0628"] * 3
    # The end, the middle and the beginning of a word are three forms of one letter.
    assert len({glyph for glyph, _ in glyphs}) == 3
    apart = drawn("\u0628\u200c\u0628")
    assert len({glyph for glyph, letter in apart if letter == "\u0628"}) == 1


def test_the_robots_answers_are_counted_in_dots_below_the_gestures() -> None:
    page = lay_out(TABLE_2, [(1, "listening"), (3, "which of two?")])
    dots = [part for part in page.parts if isinstance(part, Disc)]
    lowest = max(dot.centre[1] for dot in dots)
    assert [dot.centre[1] for dot in dots].count(lowest) == 4
    assert {"listening", "which of two?"} <= {*words_of(page)}
