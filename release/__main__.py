"""Builds a release: ``python -m release [FOLDER]``, ``dist`` if left out."""

from __future__ import annotations

import sys
from pathlib import Path

from app.recognition.errors import ModelError
from benchmarks.figures import read_results
from benchmarks.runner import hash_folders
from release.build import build_release
from release.checkout import ROOT, ReleaseError

if __name__ == "__main__":
    try:
        if old := read_results(trees=hash_folders()).old():
            raise ReleaseError(f"measured before the last change, measure again: {', '.join(old)}")
        for file in build_release(Path(sys.argv[1]) if sys.argv[1:] else ROOT / "dist"):
            print(f"{file.stat().st_size:>10,}  {file}")
    except (ReleaseError, ModelError) as error:
        sys.exit(f"release: {error}")
