"""Library of the sample languages and clips that come with the program."""

from __future__ import annotations

import filecmp
import logging
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

from app.api.services.language_documents import draft_of
from app.evaluation.kept_recordings import RECORDING_ENDING
from app.recognition import Language
from app.recognition.errors import LanguageError
from app.store import LanguageStore

SEEDED = "Sample language"
"""Change of the first revision of a sample, for its history."""

STROKES = "strokes"
"""Name of the palette of single strokes, which is no sample language of its own."""

CLIP_ENDINGS = frozenset({".mp4", ".webm"})

logger = logging.getLogger(__name__)


class Samples:
    """The content of the samples' folder, which may be absent.

    Parameters
    ----------
    folder
        Holds languages as ``*.json``, their clips in ``clips/``, and a palette of strokes in
        ``palette/``.

    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def clips(self) -> dict[str, Path]:
        """Return the clips by file name, by which requests select them, in order."""
        files = sorted((self._folder / "clips").glob("**/*"))
        return {path.name: path for path in files if path.suffix in CLIP_ENDINGS}

    def find_recording(self, file: Path) -> Path | None:
        """Return the recording that comes with a sample clip; None for any other file."""
        for path in (self._folder / "clips").glob(f"*{RECORDING_ENDING}"):
            clip = path.with_suffix(".mp4")
            if clip.is_file() and filecmp.cmp(clip, file, shallow=False):
                return path
        return None

    def languages(self) -> dict[str, Language]:
        """Return the languages by name, in order; one that cannot be read is left out."""
        return self._read(sorted(self._folder.glob("*.json")))

    def movements(self) -> dict[str, Language]:
        """Return the languages and the palette of strokes by name."""
        palette = self._folder / "palette" / f"{STROKES}.json"
        return self.languages() | self._read([palette] if palette.is_file() else [])

    @staticmethod
    def _read(paths: Sequence[Path]) -> dict[str, Language]:
        found = {}
        for path in paths:
            try:
                found[path.stem] = _read_language(path, path.stat().st_mtime_ns)
            except (LanguageError, OSError):
                # A server works without one of its samples.
                logger.exception("the sample language %s cannot be read", path.name)
        return found

    def seed(self, languages: LanguageStore) -> None:
        """Add the sample languages that were never added before; deleted ones stay deleted."""
        seeded = languages.seeded()
        for name, language in self.languages().items():
            if name not in seeded:
                draft = draft_of(language, SEEDED)
                languages.create(draft, language.revision, sample=name)


# Cached, because every page requests the samples, and reading them takes a second.
@lru_cache(maxsize=64)
def _read_language(path: Path, modified: int) -> Language:
    """Read a language file; `modified`, in nanoseconds, distinguishes its versions in the cache."""
    del modified
    return Language.from_json(path.read_bytes())
