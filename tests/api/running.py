"""A real server on a real port, in a thread of the test."""

from __future__ import annotations

import ssl
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import httpx
import uvicorn
from starlette.types import ASGIApp

from app.api.middleware.shutdown import StudioServer
from app.api.services.running_studio import Studio
from app.server import create_app
from app.settings import Settings
from tests.store.new_database import put_database

PATIENCE_SECONDS = 180.0
"""Seconds that a test waits for a condition: enough for a machine with five times its load."""


@dataclass(frozen=True)
class Running:
    """A running server.

    Attributes
    ----------
    address
        Its ``http://host:port``.
    studio
        State that its requests share.

    """

    address: str
    studio: Studio

    @property
    def port(self) -> int:
        """Port on which it listens."""
        return int(self.address.rsplit(":", 1)[1])


@contextmanager
def running(
    settings: Settings, wrap: Callable[[ASGIApp], ASGIApp] | None = None
) -> Iterator[Running]:
    """Serve on a free port of loopback until the context ends, behind what `wrap` adds."""
    if settings.database_url is None:
        put_database(settings.data_dir / "studio.db")
    app = create_app(settings)
    if wrap:
        # Added inside the app, because the server gets the guard of its connections from the app.
        app.add_middleware(wrap)
    config = uvicorn.Config(
        app, host="127.0.0.1", port=0, log_level="error", timeout_graceful_shutdown=1
    )
    server = StudioServer(config, app)
    thread = threading.Thread(target=server.run, daemon=True)
    thread.start()
    until(lambda: server.started or not thread.is_alive())
    assert server.started
    port = server.servers[0].sockets[0].getsockname()[1]
    try:
        yield Running(f"http://127.0.0.1:{port}", app.state.studio)
    finally:
        server.should_exit = True
        thread.join(PATIENCE_SECONDS)


@contextmanager
def running_two(
    folder: Path, database_url: str, storage: Path | str
) -> Iterator[tuple[Running, Running]]:
    """Serve one database, one storage of clips and one list of tokens, if there is one, twice."""
    tokens = folder / "tokens.json"
    with ExitStack() as stack:
        one, two = (
            stack.enter_context(
                running(
                    Settings(
                        data_dir=folder / name,
                        samples_dir=folder / "none",
                        database_url=database_url,
                        storage=storage,
                        tokens_file=tokens if tokens.exists() else None,
                    )
                )
            )
            for name in ("one", "two")
        )
        yield one, two


@cache
def _certificates() -> ssl.SSLContext:
    # Loading certificates takes longer than most requests, and a client does so even without TLS.
    return ssl.create_default_context()


def client_of(
    address: httpx.URL | str,
    headers: dict[str, str] | None = None,
    timeout: float = PATIENCE_SECONDS,
) -> httpx.Client:
    """Return a client of the server at `address`, as patient as the tests."""
    return httpx.Client(base_url=address, headers=headers, timeout=timeout, verify=_certificates())


def until(condition: Callable[[], object]) -> None:
    """Wait until a condition is true; fail if it does not become true in time.

    It checks less and less often, since a check takes as much processor time as a request.
    """
    end = time.monotonic() + PATIENCE_SECONDS
    pause = 0.02
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(pause)
        pause = min(1.3 * pause, 0.15)


def assert_problem(response: httpx.Response, status: int, code: str) -> dict[str, object]:
    """Check that `response` is a problem document of this kind, and return it."""
    assert response.status_code == status, response.text
    assert response.headers["content-type"] == "application/problem+json"
    problem: dict[str, object] = response.json()
    assert {"type", "title", "status", "detail", "code"} <= set(problem)
    assert problem["status"] == status
    assert problem["code"] == code, problem
    assert problem["detail"]
    return problem
