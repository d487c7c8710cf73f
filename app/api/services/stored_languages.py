"""Stored languages: those of revisions in memory, and their recognisers, which are cached."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from threading import Lock
from typing import Generic, TypeVar

from app.recognition import Language, Recognizer
from app.recognition.triggers.trigger import SALUTE, Trigger
from app.store import LanguageState, LanguageStore

MOST_CACHED = 16
"""Number of languages, and of recognisers, cached; each takes a few megabytes."""

MOST_CACHED_CHARACTERS = 32_000_000
"""Characters of their documents together: a cached language takes five times its document, and one
of a thousand gestures has 27 million."""

Made = TypeVar("Made")


class DocumentCache(Generic[Made]):
    """What was made of documents, the least recently used of which go when they are too long.

    The newest stays, however long it is.
    """

    def __init__(self, make: Callable[..., Made]) -> None:
        self._make = make
        self._made: OrderedDict[tuple[str, str | None], Made] = OrderedDict()
        self._changing = Lock()

    def __len__(self) -> int:
        """Return how many documents something is kept of."""
        return len(self._made)

    def get(self, document: str, profile: str | None = None) -> Made:
        """Return what was made of a document, and of a profile if it matters, or make it."""
        key = document, profile
        with self._changing:
            if key in self._made:
                self._made.move_to_end(key)
                return self._made[key]
        made = self._make(document) if profile is None else self._make(document, profile)
        with self._changing:
            self._made[key] = made
            while len(self._made) > 1 and (
                len(self._made) > MOST_CACHED
                or sum(len(text) for text, _ in self._made) > MOST_CACHED_CHARACTERS
            ):
                self._made.popitem(last=False)
        return made


_languages = DocumentCache(Language.from_json)
_recognizers = DocumentCache(
    lambda document, profile=None: Recognizer(_languages.get(document), profile)
)


def language_of(state: LanguageState) -> Language:
    """Return the language that a revision holds."""
    return _languages.get(state.revision.document)


def recognizer_of(state: LanguageState, profile: str | None = None) -> Recognizer:
    """Return a recogniser of a revision, by default with the language's own profile.

    Raises
    ------
    OsgError
        When there is no such profile.

    """
    return _recognizers.get(state.revision.document, profile)


def trigger_of(languages: LanguageStore, language_id: str | None) -> Trigger:
    """Return the trigger of a language's newest revision; without a language, the salute.

    Raises
    ------
    NotFound
        When there is no such language.

    """
    return SALUTE if language_id is None else language_of(languages.get(language_id)).trigger
