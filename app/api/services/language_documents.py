"""Language documents: a language in memory as a revision to store, and the name of a copy."""

from __future__ import annotations

from collections.abc import Container
from itertools import chain, count

from app.recognition import Language
from app.recognition.language.language import MAX_NAME_LENGTH
from app.store import Draft

LONGEST_NAME = 200
"""Most characters of a language's name in lists."""

LONGEST_CHANGE = 300
"""Most characters of a revision's change."""


def draft_of(language: Language, change: str) -> Draft:
    """Return the revision that holds `language`.

    Parameters
    ----------
    language
        The language, with the number of the revision.
    change
        Change made by this revision, for the history.

    """
    return Draft(
        name=language.name[:LONGEST_NAME],
        labels=[gesture.label for gesture in language.gestures],
        change=change[:LONGEST_CHANGE],
        document=language.to_json(),
        author=language.author,
    )


def name_of_copy(name: str, taken: Container[str]) -> str:
    """Return a name for a copy of a language that is not among the `taken` ones."""
    endings = chain([" (copy)"], (f" (copy {number})" for number in count(2)))
    names = (name[: MAX_NAME_LENGTH - len(ending)] + ending for ending in endings)
    return next(proposed for proposed in names if proposed not in taken)
