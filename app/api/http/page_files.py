"""Page files: HTML, scripts and styles of the page, at addresses with a digest of their contents.

A browser keeps them without asking again, and none from before an update stands beside newer ones.
The style sheets come as one file: twenty requests over a slow link take longer than it.
"""

from __future__ import annotations

import re
from hashlib import sha256
from pathlib import Path

from fastapi.responses import HTMLResponse
from fastapi.staticfiles import StaticFiles
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response
from starlette.types import Scope

ADDRESS = "/static"
"""Where the files are."""

_ALL_SHEETS = "styles/all.css"
"""Among the sheets that it holds: what they name by relative addresses is found."""
_SHEET = re.compile(rf'<link\s+rel="stylesheet"\s+href="{ADDRESS}/([^"]+)"\s*/>\s*')
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
        Holds ``index.html`` and the files that it names as ``/static/...``. Its style sheets are
        joined in the order of their links.

    """

    def __init__(self, folder: Path) -> None:
        super().__init__(directory=folder)
        self._folder = folder
        self._digest = self._compute_digest()

    def read_page(self) -> HTMLResponse:
        """Return the page, its files named below their digest as they are now."""
        self._digest = self._compute_digest()
        page = self._read_index()
        if first := _SHEET.search(page):
            rest = _SHEET.sub("", page)
            link = f'<link rel="stylesheet" href="{ADDRESS}/{_ALL_SHEETS}" />\n    '
            page = rest[: first.start()] + link + rest[first.start() :]
        named = page.replace(f'"{ADDRESS}/', f'"{ADDRESS}/{self._digest}/')
        return HTMLResponse(named, headers={"Cache-Control": _ASK_FIRST})

    async def get_response(self, path: str, scope: Scope) -> Response:
        """Answer with a file, and how long a browser may keep it."""
        digest, _, below = Path(path).as_posix().partition("/")
        if _DIGEST.fullmatch(digest):
            path = below
        if path == _ALL_SHEETS and scope["method"] in ("GET", "HEAD"):
            response = Response(await run_in_threadpool(self._join_sheets), media_type="text/css")
        else:
            response = await super().get_response(path, scope)
        response.headers["Cache-Control"] = _FOR_A_YEAR if digest == self._digest else _ASK_FIRST
        return response

    def _read_index(self) -> str:
        return (self._folder / "index.html").read_text(encoding="utf-8")

    def _join_sheets(self) -> str:
        """Return what the page's style sheets hold, in the order of their links."""
        paths = _SHEET.findall(self._read_index())
        return "\n".join((self._folder / path).read_text(encoding="utf-8") for path in paths)

    def _compute_digest(self) -> str:
        """Return a digest of all files' names and contents."""
        digest = sha256()
        for path in sorted(self._folder.rglob("*")):
            if path.is_file():
                contents = path.read_bytes()
                digest.update(f"{path.relative_to(self._folder)} {len(contents)} ".encode())
                digest.update(contents)
        return digest.hexdigest()[:16]
