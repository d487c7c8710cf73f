"""Active language: the language that a robot recognises, with its checksum."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from typing_extensions import Self

from app.recognition import Language, Recognizer
from app.recognition.language.file import name_file, read_content, seal
from app.recognition.triggers.trigger import Trigger


@dataclass(frozen=True, eq=False)
class ActiveLanguage:
    """A language with its recogniser.

    Attributes
    ----------
    recognizer
        Recogniser of the language.
    sha256
        Id of the language: the checksum of its file, equal to the one in the studio that
        exported it.

    """

    recognizer: Recognizer
    sha256: str

    @property
    def name(self) -> str:
        """The language's name."""
        return self.recognizer.language.name

    @property
    def revision(self) -> int:
        """The language's revision."""
        return self.recognizer.language.revision

    @property
    def trigger(self) -> Trigger:
        """What begins and ends a take."""
        return self.recognizer.language.trigger

    @classmethod
    def load(cls, path: str | Path, profile: str | None = None) -> Self:
        """Read a language file; this takes up to a second for large languages.

        Raises
        ------
        LanguageError
            When the file cannot be read or is invalid, or the language has no gestures.
        OsgError
            When there is no such profile.

        """
        content = read_content(path)
        with name_file(path):
            return cls.from_json(content, profile)

    @classmethod
    def from_json(cls, text: str | bytes, profile: str | None = None) -> Self:
        """Create an active language from the text of a language file; see `load`.

        Raises
        ------
        LanguageError
            When the text is invalid, or the language has no gestures.
        OsgError
            When there is no such profile.

        """
        recognizer = Recognizer(Language.from_json(text), profile)
        return cls(recognizer, seal(json.loads(text)))
