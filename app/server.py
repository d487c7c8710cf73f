"""Server: one process and one port for the page, the API and the viser workspaces."""

from __future__ import annotations

import asyncio
import contextlib
import os
import sys
import threading
import webbrowser
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from functools import cache
from typing import Any
from urllib.parse import quote

import uvicorn
from fastapi import APIRouter, FastAPI
from starlette.routing import BaseRoute

from app import __version__, resources
from app.api.http import problems
from app.api.http.page_files import (
    ADDRESS,
    INVITATION_ADDRESS,
    CompressedPage,
    InvitationFiles,
    PageFiles,
)
from app.api.http.schemas.invitations import MOST_TAKE_BYTES
from app.api.ingest.multipart import FRAME_BYTES
from app.api.live import socket as live
from app.api.middleware.access import SameOrigin, TokenRequired
from app.api.middleware.audit import Audit
from app.api.middleware.connections import ConnectionGuard
from app.api.middleware.headers import SecurityHeaders
from app.api.middleware.request_bodies import (
    AnswerAfterBody,
    BodyLimit,
    BodyPace,
    KnownKeys,
    StrictBodies,
)
from app.api.middleware.request_log import RequestLog
from app.api.middleware.roles import RoleRequired
from app.api.middleware.safe_paths import SafePaths
from app.api.middleware.shutdown import OpenRequests, StudioServer
from app.api.observation.heap import share_arenas
from app.api.observation.logs import set_up
from app.api.observation.metrics import Metrics
from app.api.routes import events, invited, samples, server_state
from app.api.routes.administration import administration
from app.api.routes.clips import (
    clip_lists,
    clips,
    extraction_jobs,
    mcap_exports,
    resumable_uploads,
)
from app.api.routes.gestures import gestures, previews
from app.api.routes.languages import (
    checks,
    choices,
    invitations,
    language_files,
    languages,
    revisions,
    takes,
)
from app.api.routes.recognitions import recognitions
from app.api.services.identities import Identities, check_tokens
from app.api.services.invited_takes import settle_takes
from app.api.services.running_studio import check_store, open_studio
from app.api.viser_workspaces import relay
from app.api.viser_workspaces import routes as workspaces
from app.settings import Settings
from app.store import StoreUnavailable
from app.system.service_manager import ServiceManager
from app.ui.workspace_registry import WorkspaceRegistry

API = "/api/v1"

BAD_STORE = 2
"""Exit code for an unusable data folder, the same as the command line's for bad input."""

GRACEFUL_SECONDS = 3
"""Seconds for connections to close at shutdown, after the `ENDING_SECONDS` for open responses; the
whole shutdown must take less than ten seconds."""


def create_app(settings: Settings | None = None) -> FastAPI:
    """Create the app; its store is opened when it starts to serve.

    Parameters
    ----------
    settings
        Settings of the server; by default those of the environment.

    """
    settings = settings or Settings()
    registry, metrics = WorkspaceRegistry(), Metrics()

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        async with open_studio(settings, metrics) as studio:
            app.state.studio = studio
            judging = settle_takes(studio, Identities(settings))
            tasks = [asyncio.create_task(each) for each in (registry.sweep(), judging)]
            try:
                yield
            finally:
                for each in tasks:
                    each.cancel()
                await asyncio.to_thread(registry.close)

    app = _DescribedApp(
        title="OSG Studio",
        version=__version__,
        summary="Gesture languages for divers and underwater robots",
        lifespan=lifespan,
        # FastAPI's documentation pages load scripts from other hosts; openapi.json is still served.
        docs_url=None,
        redoc_url=None,
    )
    app.state.requests = OpenRequests()
    limits = settings.limits
    app.state.connections = ConnectionGuard(limits.idle_seconds, limits.max_connections)
    app.state.workspaces = registry
    app.state.live_places = asyncio.Semaphore(live.MOST_VIEWS)
    app.state.invited_places = asyncio.Semaphore(live.MOST_INVITED)
    app.router.routes.extend(_build_routes())
    _serve_page(app)
    problems.install(app)
    _guard(app, settings, metrics)
    return app


@cache
def _build_routes() -> tuple[BaseRoute, ...]:
    """Return the API's routes, built once because FastAPI inspects the parameters of each.

    They keep no state of an app, so all apps of a process share them.
    """
    every, api = APIRouter(), APIRouter(prefix=API)
    for router in (
        server_state.router,
        clip_lists.router,
        clips.router,
        resumable_uploads.router,
        mcap_exports.router,
        extraction_jobs.router,
        languages.router,
        language_files.router,
        revisions.router,
        checks.router,
        takes.router,
        invitations.router,
        invited.router,
        choices.router,
        gestures.router,
        previews.router,
        recognitions.router,
        samples.router,
        events.router,
        administration.router,
        workspaces.router,
        live.router,
    ):
        api.include_router(router)
    every.include_router(api)
    every.include_router(server_state.router, include_in_schema=False)
    every.include_router(administration.scraped)
    every.include_router(relay.router)
    return tuple(every.routes)


def run(settings: Settings, *, open_browser: bool) -> None:
    """Serve until interrupted.

    Parameters
    ----------
    settings
        Settings of the server.
    open_browser
        Whether to open the page in this machine's browser once the server is up.

    """
    share_arenas()
    set_up(settings.log_format, settings.log_level)
    app = create_app(settings)
    server = _AnnouncedServer(
        uvicorn.Config(
            app,
            host=settings.host,
            port=settings.port,
            log_level="warning",
            # viser compresses its messages itself; compressing them twice halves the frame rate.
            ws_per_message_deflate=False,
            timeout_graceful_shutdown=GRACEFUL_SECONDS,
            # Take address and scheme from a trusted proxy, but never the host, which it passes on.
            proxy_headers=bool(settings.forwarded_allow_ips),
            forwarded_allow_ips=settings.forwarded_allow_ips or None,
            log_config=None,
            server_header=False,
        ),
        app,
        settings,
        open_browser=open_browser,
    )
    try:
        # Checked before uvicorn starts, which would print a traceback around the error message.
        check_store(settings)
        if advice := check_tokens(settings):
            print(f"osg-studio: {advice}", file=sys.stderr)
    except StoreUnavailable as error:
        print(f"osg-studio: {error}", file=sys.stderr)
        raise SystemExit(BAD_STORE) from error
    with contextlib.suppress(KeyboardInterrupt):
        server.run()
    if any(thread.ident != threading.get_ident() for thread in threading.enumerate()):
        # A running computation cannot be interrupted and may take a minute. Its result is no longer
        # needed, and everything is stored and closed.
        sys.stdout.flush()
        os._exit(0)


class _AnnouncedServer(StudioServer):
    """Server that prints its address once it listens, and opens a browser if requested.

    It reports the same to the service manager, and a sign of life at every tick of the event loop.
    """

    def __init__(
        self, config: uvicorn.Config, app: FastAPI, settings: Settings, *, open_browser: bool
    ) -> None:
        super().__init__(config, app)
        self._settings = settings
        self._open_browser = open_browser
        self._manager = ServiceManager()

    async def on_tick(self, counter: int) -> bool:
        self._manager.tell_alive()
        return await super().on_tick(counter)

    async def shutdown(self, sockets: Any = None) -> None:
        self._manager.tell_stopping()
        await super().shutdown(sockets)

    async def startup(self, sockets: Any = None) -> None:
        await super().startup(sockets)
        if not self.started:
            return
        port = self.servers[0].sockets[0].getsockname()[1]
        host = "127.0.0.1" if self._settings.host in {"0.0.0.0", "::"} else self._settings.host
        address = f"http://[{host}]:{port}/" if ":" in host else f"http://{host}:{port}/"
        print(f"OSG Studio is at {address} (Ctrl+C ends it)", flush=True)
        self._manager.tell_ready()
        self._manager.tell_status(f"at {address}")
        if self._open_browser:
            if token := self._settings.token:
                address += f"?token={quote(token.get_secret_value(), safe='')}"
            threading.Thread(target=webbrowser.open, args=[address], daemon=True).start()


def _serve_page(app: FastAPI) -> None:
    """Serve the page and that of invited people; nothing where `static` is not installed."""
    folder = resources.static_dir()
    if not folder.is_dir():
        return

    files = PageFiles(folder)
    app.get("/", include_in_schema=False)(files.read_page)
    app.mount(ADDRESS, files, name="static")
    invited_page = InvitationFiles(folder)
    app.get(INVITATION_ADDRESS, include_in_schema=False)(invited_page.read_page)
    app.get(f"{INVITATION_ADDRESS}/{{path:path}}", include_in_schema=False)(invited_page.read_file)


class _DescribedApp(FastAPI):
    """App whose ``/openapi.json`` has the schemas of problem documents too."""

    def openapi(self) -> dict[str, Any]:
        schema = super().openapi()
        schema["components"]["schemas"].update(problems.schemas())
        return schema


def _guard(app: FastAPI, settings: Settings, metrics: Metrics) -> None:
    """Add the middleware that checks every request, the outermost last."""
    limits = {
        f"{API}/clips": settings.max_clip_bytes + FRAME_BYTES,
        f"{API}/invited/takes": min(settings.max_clip_bytes, MOST_TAKE_BYTES) + FRAME_BYTES,
        f"{API}/uploads/*": settings.max_clip_bytes,
        f"{API}/languages/import": settings.limits.max_language_bytes,
    }
    app.add_middleware(StrictBodies, most_bytes=settings.limits.max_body_bytes, exceptions=limits)
    app.add_middleware(KnownKeys, understood=[f"{API}/clips"])
    app.add_middleware(Audit)
    app.add_middleware(SafePaths)
    app.add_middleware(
        BodyPace,
        grace_seconds=settings.limits.upload_grace_seconds,
        bytes_per_second=settings.limits.upload_bytes_per_second,
    )
    app.add_middleware(BodyLimit, default=settings.limits.max_body_bytes, exceptions=limits)
    app.add_middleware(RoleRequired)
    app.add_middleware(TokenRequired, settings=settings)
    app.add_middleware(SameOrigin, settings=settings)
    app.add_middleware(AnswerAfterBody)
    app.add_middleware(app.state.requests.guard)
    app.add_middleware(CompressedPage)
    app.add_middleware(SecurityHeaders)
    app.add_middleware(RequestLog, metrics=metrics)
