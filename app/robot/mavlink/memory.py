"""Memory of the bridge: small files that outlive a restart of the robot or a loss of its power."""

from __future__ import annotations

import json
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Final

from pydantic import FiniteFloat, TypeAdapter

from app.recognition.text.atomic_files import write_atomically

MOST_BYTES: Final = 4096
"""Largest size in bytes of a file that is read: a few numbers."""


NUMBERS: Final = TypeAdapter(dict[str, list[FiniteFloat]])
"""Numbers under names."""


class Memory:
    """Numbers under names, kept in a file; without one, for this run alone.

    A file that cannot be read, or holds anything but finite numbers, counts as empty. One that
    cannot be written is told once, already at the start, and the bridge goes on without it.

    Parameters
    ----------
    file
        The file; it exists only while there is something to keep. None: there is none.
    tell
        Called with a line for people.

    """

    def __init__(self, file: Path | None, tell: Callable[[str], None]) -> None:
        self._file, self._tell, self._told = file, tell, False
        self._kept: dict[str, list[float]] = {}
        if file is not None:
            with suppress(OSError, ValueError), file.open("rb") as opened:
                self._kept = NUMBERS.validate_json(opened.read(MOST_BYTES), strict=True)
        self._save()

    def find(self, name: str) -> list[float]:
        """Return the numbers that were kept under a name; none where there are none."""
        return self._kept.get(name, [])

    def keep(self, name: str, *numbers: float) -> None:
        """Keep numbers under a name, also through a loss of power; none to forget it."""
        if self._kept.pop(name, []) == [*numbers] == []:
            return
        if numbers:
            self._kept[name] = [*map(float, numbers)]
        self._save()

    def _save(self) -> None:
        if self._file is None:
            return
        try:
            write_atomically(self._file, json.dumps(self._kept, allow_nan=False).encode())
            if not self._kept:
                self._file.unlink()
        except OSError as error:
            if not self._told:
                self._tell(f"{self._file} cannot be written ({error.strerror}): a restart forgets")
            self._told = True
