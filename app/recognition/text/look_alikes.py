"""Look-alikes: words that are written differently and look the same, on a slate for example.

Two words look alike if their skeletons are the same (Unicode Technical Standard 39, section 4).
Joiners are zero-width characters that belong to the spelling of a word: Persian and Urdu keep
letters apart by one of them, Hindi and Sinhala choose a ligature by the other (Unicode Standard
Annex 31, section 2.3; RFC 5892, appendix A.1 and A.2).
"""

from __future__ import annotations

import unicodedata
from collections.abc import Iterator, Sequence
from functools import lru_cache
from importlib import resources

JOINERS = "\u200c\u200d"
"""Zero width non-joiner and joiner: invisible characters that determine which letters are
joined."""

_REMOVED = str.maketrans(dict.fromkeys(JOINERS))


def is_printable(text: str) -> bool:
    """Return whether every character is printable, or a joiner between two letters of a word."""
    return all(
        _in_word(before) and _in_word(after) if each in JOINERS else each.isprintable()
        for before, each, after in zip(f" {text}", text, f"{text[1:]} ", strict=False)
    )


def without_joiners(text: str) -> str:
    """Return a text to compare by: two that differ in joiners alone look alike."""
    return text.translate(_REMOVED)


def _in_word(character: str) -> bool:
    """Return whether it is a letter or a mark on one."""
    return unicodedata.category(character)[0] in "LM"


MOST_SKELETONS = 4096
"""Number of skeletons cached: the labels of a few large languages."""


def compose(text: str) -> str:
    """Return a text in the one form that is stored: Unicode's composed form (NFC)."""
    return unicodedata.normalize("NFC", text)


@lru_cache(MOST_SKELETONS)
def skeleton(text: str) -> str:
    """Return what a text looks like, to compare by; empty if nothing of it can be seen.

    Compatibility forms, such as full-width letters, count as the letters themselves; white space
    counts as one space, and not at all at the ends.
    """
    known = _confusables()
    decomposed = unicodedata.normalize("NFKD", text)
    seen = "".join(known.get(character, character) for character in decomposed)
    return " ".join(unicodedata.normalize("NFD", seen).split())


def are_confusable(one: str, other: str) -> bool:
    """Return whether two different words look alike by more than letters of a keyboard.

    O and 0, or I and l, can be told apart by those who typed them, and in most fonts.
    """
    if skeleton(one) != skeleton(other):
        return False
    return compose(one) == compose(other) or _beyond_ascii(one) != _beyond_ascii(other)


def find_confusable(label: str, labels: Sequence[str]) -> str | None:
    """Return the first of the `labels` that a new label must not stand beside; None if all may."""
    return next((each for each in labels if are_confusable(label, each)), None)


def list_look_alikes(labels: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Yield the pairs of labels that look alike, those of ASCII letters included."""
    first: dict[str, str] = {}
    for label in labels:
        earlier = first.setdefault(skeleton(label), label)
        if earlier is not label:
            yield earlier, label


def _beyond_ascii(text: str) -> list[str]:
    return [character for character in compose(text) if not character.isascii()]


@lru_cache(1)
def _confusables() -> dict[str, str]:
    lines = (resources.files(__package__) / "confusables.txt").read_text("ascii").splitlines()
    known = {}
    for line in lines:
        if not line.startswith("#"):
            character, *seen = (chr(int(code, 16)) for code in line.split())
            known[character] = "".join(seen)
    return known
