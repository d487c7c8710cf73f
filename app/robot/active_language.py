"""A language that a robot listens for, and by what it can be told from every other."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from typing_extensions import Self

from app.recognition import Language, Recognizer
from app.recognition.language.file import read_content, seal


@dataclass(frozen=True, eq=False)
class SpokenLanguage:
    """A language made ready to be recognised.

    Attributes
    ----------
    recognizer
        Of that language.
    sha256
        The language's id: the seal of its file (see the docs), the same here, in the
        studio that exported it, and in whatever a log is compared with.

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

    @classmethod
    def load(cls, path: str | Path, profile: str | None = None) -> Self:
        """Read a language file and make it ready; up to a second where it brings no thresholds.

        Raises
        ------
        LanguageError
            When the file cannot be read or is invalid, or the language has no gestures.
        OsgError
            When there is no such profile.

        """
        return cls.from_json(read_content(path), profile)

    @classmethod
    def from_json(cls, text: str | bytes, profile: str | None = None) -> Self:
        """Make ready what a language file says; see `load`.

        Raises
        ------
        LanguageError
            When the text is invalid, or the language has no gestures.
        OsgError
            When there is no such profile.

        """
        recognizer = Recognizer(Language.from_json(text), profile)
        return cls(recognizer, seal(json.loads(text)))
