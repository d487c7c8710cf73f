"""A language file that may be replaced while the robot listens."""

from __future__ import annotations

import threading
from collections import deque
from pathlib import Path
from typing import Final

from typing_extensions import Self

from app.recognition import OsgError
from app.robot.active_language import SpokenLanguage

LOOK_EVERY: Final = 0.5
"""Seconds between two looks at the file: sooner than a person who copied it wonders, and one call
of the system each."""

MOST_NEWS: Final = 8
"""That wait while a frame is looked at; of more edits within one frame the last ones count."""

FileState = tuple[int, int, int] | None
"""Inode, size in bytes and time of the last write in nanoseconds; None: there is no such file."""


class WatchedLanguage:
    """Reads a language file, and again whenever it was replaced or somebody asks.

    A thread of its own looks and reads, so that no frame waits for it. A file that still changes
    is left alone until it rests.

    Parameters
    ----------
    path
        The language file.
    profile
        The recogniser's profile; each language's own when not given.

    Attributes
    ----------
    first
        The language as it was at the beginning.

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
        self.first = SpokenLanguage.load(path, profile)
        self._spoken = self.first.sha256
        self._news: deque[SpokenLanguage | OsgError] = deque(maxlen=MOST_NEWS)
        self._asked = False
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._watch, name="language", daemon=True)
        self._thread.start()

    def changes(self) -> SpokenLanguage | OsgError | None:
        """Return the language to speak from now on, or why the new file cannot be; once each."""
        return self._news.popleft() if self._news else None

    def reload(self) -> None:
        """Read the file again soon, also when it looks the same; may be called by a signal."""
        self._asked = True

    def close(self) -> None:
        """Stop looking."""
        self._closing.set()
        self._thread.join()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _watch(self) -> None:
        before = self._read_state
        while not self._closing.wait(LOOK_EVERY):
            state = self._state()
            if self._asked or (state == before and state != self._read_state):
                asked, self._asked = self._asked, False
                self._read_state = state
                self._read(asked)
            before = state

    def _read(self, asked: bool) -> None:
        """Read the file; what says the same as before is told only to who asked."""
        try:
            language = SpokenLanguage.load(self._path, self._profile)
        except OsgError as error:
            self._news.append(error)
            return
        if asked or language.sha256 != self._spoken:
            self._spoken = language.sha256
            self._news.append(language)

    def _state(self) -> FileState:
        try:
            found = self._path.stat()
        except OSError:
            return None
        return found.st_ino, found.st_size, found.st_mtime_ns
