"""Finished exports: kept until they are fetched or expire."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from pathlib import Path
from typing import Final

KEEP_SECONDS: Final = 600.0
"""Seconds for which an export is kept: a browser fetches it at once, but may first ask where to
save it."""

MOST_KEPT: Final = 8
"""Most exports kept at the same time, so that they cannot fill the disk; the oldest is removed."""


class KeptExports:
    """Files by the ids that their clients chose; each can be taken once."""

    def __init__(self) -> None:
        # Each with the timer that removes it.
        self._kept: dict[tuple[str, str], tuple[Path, asyncio.TimerHandle]] = {}

    def keep(self, clip_id: str, export_id: str, path: Path) -> None:
        """Keep the export of a clip for `KEEP_SECONDS`, in place of an older one with that id."""
        place = (clip_id, export_id)
        self._remove(place)
        while len(self._kept) >= MOST_KEPT:
            self._remove(next(iter(self._kept)))
        removal = asyncio.get_running_loop().call_later(KEEP_SECONDS, self._remove, place)
        self._kept[place] = path, removal

    def take(self, clip_id: str, export_id: str) -> Path | None:
        """Return the file of an export, which the caller must remove; None if there is none."""
        kept = self._kept.pop((clip_id, export_id), None)
        if kept is None:
            return None
        path, removal = kept
        removal.cancel()
        return path

    def clear(self) -> None:
        """Remove all."""
        for place in [*self._kept]:
            self._remove(place)

    def _remove(self, place: tuple[str, str]) -> None:
        path = self.take(*place)
        if path is not None:
            with suppress(OSError):  # Leftovers are removed at the next start.
                path.unlink(missing_ok=True)
