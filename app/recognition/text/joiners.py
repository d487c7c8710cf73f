"""Joiners: zero-width characters that belong to the spelling of a word.

Persian and Urdu keep letters apart by one of them, Hindi and Sinhala choose a ligature by the other
(Unicode Standard Annex 31, section 2.3; RFC 5892, appendix A.1 and A.2).
"""

from __future__ import annotations

import unicodedata

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
