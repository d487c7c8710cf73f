"""How identifiers and lists are worded in sentences for people."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


def humanize(identifier: str) -> str:
    """Return the name of a landmark or voter as people say it: ``right_wrist`` is right wrist."""
    return identifier.replace("_", " ")


def humanize_all(identifiers: Iterable[str]) -> list[str]:
    """Return each of the names as people say it."""
    return [humanize(identifier) for identifier in identifiers]


def join_words(items: Sequence[str], last: str = "and") -> str:
    """Say several things in a row: a, b and c."""
    if len(items) < 2:
        return "".join(items)
    return f"{', '.join(items[:-1])} {last} {items[-1]}"
