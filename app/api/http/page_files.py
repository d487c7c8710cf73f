"""Page files: HTML, scripts and styles of the page, at addresses with a digest of their contents.

A browser can keep them without a further request, and never mixes files from before and after an
update. The style sheets are joined into one file, which loads faster than twenty requests. Comments
and indentation stay at home: they are a quarter of the bytes.
"""

from __future__ import annotations

import re
from functools import cached_property, lru_cache
from hashlib import sha256
from pathlib import Path
from posixpath import dirname, normpath

from fastapi.responses import FileResponse, HTMLResponse
from fastapi.staticfiles import StaticFiles
from starlette.concurrency import run_in_threadpool
from starlette.datastructures import Headers
from starlette.exceptions import HTTPException
from starlette.middleware.gzip import GZipMiddleware
from starlette.responses import Response
from starlette.types import Receive, Scope, Send

from app.settings import Settings

ADDRESS = "/static"
"""Path of the files."""

INVITATION_ADDRESS = "/invitation"
"""Path of the page of invited people, and of its files."""

_INVITATION_PAGE = "invitation-page/invitation-page.html"
_NAMED = re.compile(rf'"{INVITATION_ADDRESS.lstrip("/")}/([^"]+)"')
_IMPORT = re.compile(r'(?:^|;)(?:import|export)[^;"]*?from ?"([^"]+)"', re.MULTILINE)

MOST_STRIPPED = 512
"""Most scripts and style sheets that are kept without comments: more than the page has."""

_ALL_SHEETS = "styles/all.css"
"""Path of the joined style sheets, in their folder so that relative addresses in them stay
valid."""
_BESIDE = ADDRESS.lstrip("/")
"""The files as the page names them, relative: a proxy may serve the page at any path."""
_SHEET = re.compile(rf'<link\s+rel="stylesheet"\s+href="{_BESIDE}/([^"]+)"\s*/>\s*')
COMMENT = re.compile(r"^ *(?://.*|/\*(?:(?!\*/)[\s\S])*\*/)$", re.MULTILINE)
"""A comment on lines of its own."""
_INDENT = re.compile("^ +", re.MULTILINE)
_DIGEST = re.compile("[0-9a-f]{16}")
_FOR_A_YEAR = "max-age=31536000, immutable"
_ASK_FIRST = "no-cache"


_PREFIX = re.compile(r"(/(?!\.{1,2}(/|$))[\w.~-]{1,64}){1,8}", re.ASCII)
"""A path without ``.`` and ``..``, which browsers resolve to another one."""


def prefix_of(headers: Headers, settings: Settings) -> str:
    """Return the path under which a reverse proxy serves the studio, such as ``/studio``, or "".

    For the few addresses that are not relative to a page. Who has no proxy does not believe it.
    """
    prefix = headers.get("x-forwarded-prefix", "").rstrip("/")
    return prefix if settings.forwarded_allow_ips and _PREFIX.fullmatch(prefix) else ""


class PageFiles(StaticFiles):
    """Serves the page's files, also at addresses with a digest of all files.

    At an address with the current digest a file may be kept; at one with another digest, or none,
    the browser must ask whether it has changed.

    Parameters
    ----------
    folder
        Folder of ``index.html`` and the files that it refers to as ``static/...``. The style
        sheets are joined in the order of their links.

    """

    def __init__(self, folder: Path) -> None:
        super().__init__(directory=folder)
        self._folder = folder
        self._digest = self._compute_digest()

    def read_page(self) -> HTMLResponse:
        """Return the page, with the current digest in the addresses of its files."""
        self._digest = self._compute_digest()
        page = self._read_index()
        if first := _SHEET.search(page):
            rest = _SHEET.sub("", page)
            link = f'<link rel="stylesheet" href="{_BESIDE}/{_ALL_SHEETS}" />\n    '
            page = rest[: first.start()] + link + rest[first.start() :]
        named = page.replace(f'"{_BESIDE}/', f'"{_BESIDE}/{self._digest}/')
        return HTMLResponse(named, headers={"Cache-Control": _ASK_FIRST})

    async def get_response(self, path: str, scope: Scope) -> Response:
        """Answer with a file, and set how long a browser may keep it."""
        digest, _, below = Path(path).as_posix().partition("/")
        if _DIGEST.fullmatch(digest):
            path = below
        if path == _ALL_SHEETS and scope["method"] in ("GET", "HEAD"):
            response = Response(await run_in_threadpool(self._join_sheets), media_type="text/css")
        else:
            response = await super().get_response(path, scope)
            if isinstance(response, FileResponse) and _is_script(path):
                script = await run_in_threadpool(_read_script, Path(response.path))
                script.headers["ETag"] = response.headers["etag"]
                response = script
        response.headers["Cache-Control"] = _FOR_A_YEAR if digest == self._digest else _ASK_FIRST
        return response

    def _read_index(self) -> str:
        return (self._folder / "index.html").read_text(encoding="utf-8")

    def _join_sheets(self) -> str:
        """Return the contents of the page's style sheets, in the order of their links."""
        paths = _SHEET.findall(self._read_index())
        return "\n".join(_read_bare(self._folder / path) for path in paths)

    def _compute_digest(self) -> str:
        """Return a digest of all files' names and contents."""
        digest = sha256()
        for path in sorted(self._folder.rglob("*")):
            if path.is_file():
                contents = path.read_bytes()
                digest.update(f"{path.relative_to(self._folder)} {len(contents)} ".encode())
                digest.update(contents)
        return digest.hexdigest()[:16]


class CompressedPage(GZipMiddleware):
    """Middleware that compresses the page and its files, but no answer of the API.

    An answer that holds a secret beside text of its reader tells the secret by its compressed size.
    """

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Compress texts, of a browser that takes them so."""
        if scope["type"] == "http" and not scope["path"].startswith("/api/"):
            await super().__call__(scope, receive, send)
        else:
            await self.app(scope, receive, send)


class InvitationFiles:
    """Serves the page of invited people, who may not fetch the page's other files.

    Parameters
    ----------
    folder
        Folder of its HTML and of its files.

    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    @cached_property
    def files(self) -> frozenset[str]:
        """Files that anybody may fetch: those that the page names, and what they import."""
        needed: set[str] = set()
        queue = _NAMED.findall((self._folder / _INVITATION_PAGE).read_text(encoding="utf-8"))
        while queue:
            if (path := queue.pop()) not in needed:
                needed.add(path)
                imports = _IMPORT.findall((self._folder / path).read_text(encoding="utf-8"))
                queue += [normpath(f"{dirname(path)}/{each}") for each in imports]
        return frozenset(needed)

    def read_page(self) -> Response:
        """Return the page."""
        return self._answer(_INVITATION_PAGE)

    def read_file(self, path: str) -> Response:
        """Return one of its files.

        Raises
        ------
        HTTPException
            404 for any other path.

        """
        if path not in self.files:
            raise HTTPException(404)
        return self._answer(path)

    def _answer(self, path: str) -> Response:
        file = self._folder / path
        response = _read_script(file) if _is_script(path) else FileResponse(file)
        response.headers["Cache-Control"] = _ASK_FIRST
        return response


def _is_script(path: str) -> bool:
    """Return whether a path is that of a script of ours: what others wrote keeps its licence."""
    return path.startswith("js/") and path.endswith(".js")


def _read_script(file: Path) -> Response:
    return Response(_read_bare(file), media_type="text/javascript")


def _read_bare(file: Path) -> str:
    """Return the text of a file without indentation, with empty lines in place of comments."""
    return _strip(file, file.stat().st_mtime_ns)


@lru_cache(MOST_STRIPPED)
def _strip(file: Path, _written: int) -> str:
    text = file.read_text(encoding="utf-8")
    return _INDENT.sub("", COMMENT.sub(lambda found: "\n" * found[0].count("\n"), text))
