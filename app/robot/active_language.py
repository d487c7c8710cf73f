"""Active language of a robot, with its checksum, and the watcher that reloads its file."""

from __future__ import annotations

import json
import threading
from collections import deque
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from typing_extensions import Self

from app.recognition import Language, OsgError, Recognizer
from app.recognition.language.file import name_file, read_content, seal
from app.recognition.triggers.trigger import Trigger

POLL_INTERVAL: Final = 0.5
"""Seconds between two checks of the file; each check is one system call."""

MAX_PENDING: Final = 8
"""Changes that wait while a frame is processed; of more changes the last ones are kept."""

FileState = tuple[int, int, int] | None
"""Inode, size in bytes and time of the last write in nanoseconds; None for a missing file."""


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


class LanguageWatcher:
    """Watcher of a language file: reads it again when it is replaced or `reload` is called.

    A separate thread polls and reads, so that no frame waits for it. A file is read once its size
    and time are the same in two polls.

    Parameters
    ----------
    path
        The language file.
    profile
        The recogniser's profile; by default each language's own.

    Attributes
    ----------
    first
        The language at the start.

    Raises
    ------
    LanguageError
        When the file cannot be read or is invalid.
    OsgError
        When there is no such profile.

    """

    def __init__(self, path: str | Path, profile: str | None = None) -> None:
        self._path = Path(path)
        self._profile = profile
        self._read_state = self._state()
        self.first = ActiveLanguage.load(path, profile)
        self._active = self.first.sha256
        self._pending: deque[ActiveLanguage | OsgError] = deque(maxlen=MAX_PENDING)
        self._reload_requested = False
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._watch, name="language", daemon=True)
        self._thread.start()

    def next_change(self) -> ActiveLanguage | OsgError | None:
        """Return the next new language, or the error of an unusable file; each only once."""
        return self._pending.popleft() if self._pending else None

    def reload(self) -> None:
        """Read the file at the next poll, also when unchanged; a signal handler may call this."""
        self._reload_requested = True

    def close(self) -> None:
        """Stop watching."""
        self._closing.set()
        self._thread.join()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _watch(self) -> None:
        before = self._read_state
        while not self._closing.wait(POLL_INTERVAL):
            state = self._state()
            if self._reload_requested or (state == before and state != self._read_state):
                requested, self._reload_requested = self._reload_requested, False
                self._read_state = state
                self._read(requested)
            before = state

    def _read(self, requested: bool) -> None:
        """Read the file; an unchanged language counts as a change only when `requested`."""
        try:
            language = ActiveLanguage.load(self._path, self._profile)
        except OsgError as error:
            self._pending.append(error)
            return
        if requested or language.sha256 != self._active:
            self._active = language.sha256
            self._pending.append(language)

    def _state(self) -> FileState:
        try:
            found = self._path.stat()
        except OSError:
            return None
        return found.st_ino, found.st_size, found.st_mtime_ns
