"""Wording: identifiers and lists as words in sentences."""

from __future__ import annotations

from collections.abc import Sequence


def humanize(identifier: str) -> str:
    """Return an identifier as words: ``right_wrist`` as "right wrist"."""
    return identifier.replace("_", " ")


def join_words(items: Sequence[str], last: str = "and") -> str:
    """Return items as one list in words: "a, b and c"."""
    if len(items) < 2:
        return "".join(items)
    return f"{', '.join(items[:-1])} {last} {items[-1]}"


def list_some(items: Sequence[str], most: int) -> str:
    """Return at most so many items, and how many more there are: "a, b and 7 more"."""
    more = f" and {len(items) - most} more" if len(items) > most else ""
    return ", ".join(items[:most]) + more


def ask_twins(labels: Sequence[str]) -> str:
    """Return the question whether the hands of two gestures are meant, and what it costs."""
    return (
        f"{join_words(labels)} are nearly the same movement, shown with different hands. "
        "On purpose? Until the switch hand shape of both is on or off, the robot asks back for both"
    )


def ask_which(labels: Sequence[str]) -> str:
    """Return the question which gesture was meant: "circle or square?"."""
    return f"{join_words(labels, last='or')}?"
