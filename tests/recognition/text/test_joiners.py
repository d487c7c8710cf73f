"""Zero-width joiners, which belong to a word, and all else that is not seen, which does not."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.gestures.demonstration import check_diver
from app.recognition.gestures.gesture import check_label
from app.recognition.language.language import Language
from app.recognition.text.look_alikes import JOINERS, is_printable, without_joiners

WORDS = st.text(st.characters(categories=["L", "M"]), min_size=1)
CHARACTERS = st.one_of(st.characters(), st.sampled_from(f"{JOINERS} a\u0915\u094d\u0645"))


@pytest.mark.parametrize(
    "word",
    [
        "\u0645\u06cc\u200c\u0631\u0648\u0645",  # Persian, I go
        "\u0915\u094d\u200d\u0937",  # Devanagari, a half form after the virama
        "\u0dc1\u0dca\u200d\u0dbb\u0dd3",  # Sinhala, Sri
        "\u09b0\u200d\u09cd\u09af",  # Bengali, before the virama
    ],
)
def test_words_are_spelled_with_joiners(word: str) -> None:
    assert check_label(f" {word} 2 ") == f"{word} 2"
    assert check_diver(word) == word
    assert Language(name=word, author=word).name == word


@pytest.mark.parametrize(
    "text",
    [
        "\u200cup",
        "up\u200d",
        "up \u200cdown",
        "up\u200c down",
        "u\u200c\u200cp",
        "u\u200d\u200cp",
        "1\u200d2",
        "\U0001f468\u200d\U0001f469",  # an emoji of two
        "\u200c",
        "u\u200bp",  # zero width space
        "u\u2060p",  # word joiner
        "u\u00adp",  # soft hyphen
        "u\u202ep",  # right-to-left override
        "u\ufeffp",
        "u\u00a0p",
    ],
)
def test_all_else_that_is_not_seen_is_refused(text: str) -> None:
    assert not is_printable(text)


@given(WORDS, WORDS, st.sampled_from(JOINERS))
def test_a_joiner_between_two_letters_changes_nothing_but_the_spelling(
    before: str, after: str, joiner: str
) -> None:
    spelled = f"{before}{joiner}{after}"
    assert is_printable(spelled) == is_printable(before + after)
    assert without_joiners(spelled) == before + after


@given(st.text(CHARACTERS))
def test_what_is_printable_stays_so_without_its_joiners(text: str) -> None:
    assert not is_printable(text) or without_joiners(text).isprintable()
    if text.isprintable():
        assert is_printable(text)
        assert without_joiners(text) == text
