"""Look-alikes: words that nobody can tell apart on a slate are one word."""

import unicodedata

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.text.look_alikes import (
    are_confusable,
    compose,
    find_confusable,
    list_look_alikes,
    skeleton,
)

TEXTS = st.text(st.characters(categories=["L", "M", "N", "P", "S"]))


@pytest.mark.withstands(row="H34")
@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("\u00e9", "e\u0301"),  # composed and decomposed
        ("K", "\u212a"),  # the Kelvin sign
        ("fi", "\ufb01"),  # a ligature
        ("A", "\uff21"),  # full width
        ("0", "\uff10"),
        ("A", "\u0410"),  # Cyrillic
        ("down", "d\u043ewn"),
        ("x", "\u00d7"),
        ("up", "up\ufe0f"),  # a variation selector
        ("up", "u\u034fp"),  # a grapheme joiner
        ("ab", "a\u200db"),
        ("\u00df", "\u03b2"),
    ],
)
def test_words_that_look_the_same_are_confusable(one: str, other: str) -> None:
    assert are_confusable(one, other)
    assert are_confusable(other, one)
    assert find_confusable(one, ["left", other]) == other


@pytest.mark.parametrize(
    ("one", "other"),
    [("O", "0"), ("rn", "m"), ("I", "l"), ("\u00fcber1", "\u00fcberl")],
)
def test_letters_of_a_keyboard_are_only_listed(one: str, other: str) -> None:
    assert not are_confusable(one, other)
    assert list(list_look_alikes([one, "left", other])) == [(one, other)]


@pytest.mark.parametrize(("one", "other"), [("up", "down"), ("Up", "up"), ("o", "\u00f6")])
def test_other_words_stay_apart(one: str, other: str) -> None:
    assert not are_confusable(one, other)
    assert list(list_look_alikes([one, other])) == []


@pytest.mark.parametrize("unseen", ["\u3164", "\u115f\u1160", "\ufe0f"])
def test_what_nobody_sees_has_no_skeleton(unseen: str) -> None:
    assert skeleton(unseen) == ""


@given(TEXTS)
def test_every_form_of_a_word_has_its_skeleton(text: str) -> None:
    for form in ("NFC", "NFD", "NFKC", "NFKD"):
        assert skeleton(unicodedata.normalize(form, text)) == skeleton(text)
    assert skeleton(compose(text)) == skeleton(text)
