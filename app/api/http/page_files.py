"""Page files: what the browser loads the page from, at addresses that carry the contents' digest.

A browser keeps them without asking again, and none from before an update stands beside newer ones.
"""

from __future__ import annotations

import re
from hashlib import sha256
from pathlib import Path

from fastapi.responses import HTMLResponse
from fastapi.staticfiles import StaticFiles
from starlette.responses import Response
from starlette.types import Scope

ADDRESS = "/static"
"""Where the files are."""

_DIGEST = re.compile("[0-9a-f]{16}")
_FOR_A_YEAR = "max-age=31536000, immutable"
_ASK_FIRST = "no-cache"


class PageFiles(StaticFiles):
    """Serves the page's files, below a digest of all of them too.

    Below the digest of what is there now a file may be kept; below another one, or none, the
    browser asks whether it has changed.

    Parameters
    ----------
    folder
        Holds ``index.html`` and the files that it names as ``/static/...``.

    """

    def __init__(self, folder: Path) -> None:
        super().__init__(directory=folder)
        self._folder = folder
        self._digest = self._compute_digest()

    def read_page(self) -> HTMLResponse:
        """Return the page, its files named below their digest as they are now."""
        self._digest = self._compute_digest()
        page = (self._folder / "index.html").read_text(encoding="utf-8")
        named = page.replace(f'"{ADDRESS}/', f'"{ADDRESS}/{self._digest}/')
        return HTMLResponse(named, headers={"Cache-Control": _ASK_FIRST})

    async def get_response(self, path: str, scope: Scope) -> Response:
        """Answer with a file, and how long a browser may keep it."""
        digest, _, below = Path(path).as_posix().partition("/")
        if _DIGEST.fullmatch(digest):
            path = below
        response = await super().get_response(path, scope)
        response.headers["Cache-Control"] = _FOR_A_YEAR if digest == self._digest else _ASK_FIRST
        return response

    def _compute_digest(self) -> str:
        """Return a digest of all files' names and contents."""
        digest = sha256()
        for path in sorted(self._folder.rglob("*")):
            if path.is_file():
                contents = path.read_bytes()
                digest.update(f"{path.relative_to(self._folder)} {len(contents)} ".encode())
                digest.update(contents)
        return digest.hexdigest()[:16]
