"""The real app on a free port, and Debian's Chromium in front of it."""

from __future__ import annotations

import io
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

import httpx
import pytest
from PIL import Image
from playwright.sync_api import (
    Browser,
    BrowserContext,
    BrowserType,
    Page,
    ViewportSize,
    expect,
    sync_playwright,
)
from starlette.responses import HTMLResponse
from starlette.types import ASGIApp, Receive, Scope, Send

from app.settings import Settings
from tests.api.running import Running, client_of, running
from tests.browser.library import Library, library_of
from tests.conftest import ROOT, UPDATES_IMAGES, WITHOUT_BROWSER

WEBGL = (
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
)
"""Arguments with which Chromium draws WebGL in software, also as root in a container."""

WITHOUT_WINDOW = ("--disable-gpu-compositing",)
"""Composes the page in memory: without a graphics card, a simulated one takes several times as
long."""

WHOLE = ("chromium", "chromium-browser")
"""Names of the full browser."""

ONE_PROCESS = ("--process-per-site",)
"""Lets the pages of one server share a process, instead of starting one for each."""

WITHOUT_NETWORK_PROCESS = ("--enable-features=NetworkServiceInProcess2,CDPScreenshotNewSurface",)
"""Lets the browser's main process load a page's hundred files: a separate network process takes a
twentieth of the processor time. The other feature is Playwright's, whose argument this replaces."""

SHELL = "chromium-headless-shell"
"""Debian's Chromium without a window: it takes a third of the processor time, but has no camera
permission."""

PATIENCE_MS = 90_000
"""Longest wait for an expected element: enough for a loaded machine."""

IMAGES = ROOT / "docs" / "images"

FILM_SIZE = (1080, 675)
"""Width and height of the README's animation, pixels."""

WATCH_POLICY = """
addEventListener("securitypolicyviolation", (event) => {
  throw new Error(`refused by the content security policy: ${event.violatedDirective}`);
});
"""

WITHOUT_SCENE = "without-scene"
"""Name of a cookie by which a page gets an empty frame in place of viser's."""

OpenPage = Callable[..., Page]


def pytest_itemcollected(item: pytest.Item) -> None:
    """Mark the tests of this folder as slow."""
    item.add_marker(pytest.mark.slow)


# Not for the whole session: Playwright keeps an event loop running in this thread, and no test of
# another package could start its own.
@pytest.fixture(scope="package")
def browser() -> Iterator[Browser]:
    """Start Chromium; skip where there is none."""
    expect.set_options(timeout=PATIENCE_MS)
    with sync_playwright() as playwright, started(playwright.chromium) as browser:
        yield browser


@contextmanager
def started(kind: BrowserType, *more: str, whole: bool = False) -> Iterator[Browser]:
    """Run Chromium with further arguments, the full browser if needed; skip where there is none."""
    names = WHOLE if whole else (SHELL, *WHOLE)
    executable = next(filter(None, map(shutil.which, names)), None)
    if executable is None:
        pytest.skip(WITHOUT_BROWSER)
    args = [*WEBGL, *WITHOUT_WINDOW, *ONE_PROCESS, *WITHOUT_NETWORK_PROCESS, *more]
    browser = kind.launch(executable_path=executable, args=args, timeout=PATIENCE_MS)
    yield browser
    browser.close()


@pytest.fixture(scope="module")
def settings(tmp_path_factory: pytest.TempPathFactory) -> Settings:
    """Return the settings of a fresh app with the samples that we ship."""
    return Settings(data_dir=tmp_path_factory.mktemp("studio"))


@pytest.fixture(scope="module")
def server(settings: Settings) -> Iterator[Running]:
    """Serve the app to the tests of one file; each test adds its data under names of its own."""
    with running(settings, EmptyFrames) as server:
        yield server


@pytest.fixture
def client(server: Running) -> Iterator[httpx.Client]:
    """Return a client of the server."""
    with client_of(server.address) as client:
        yield client


@pytest.fixture
def library(server: Running, client: httpx.Client, request: pytest.FixtureRequest) -> Library:
    """Return a clip of a circle, and a language of a circle and a line, named as the test."""
    return library_of(server, client, request.node.name[:40])


class EmptyFrames:
    """ASGI middleware: answers as viser's page does once it draws, where the cookie asks for it.

    A route in the browser could do this, but would disable its cache, so that modules load anew.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request for viser's frame, or pass it on."""
        if scope["type"] == "http" and scope["path"].startswith("/viser/"):
            cookies = dict(scope["headers"]).get(b"cookie", b"").decode("latin-1")
            if WITHOUT_SCENE in cookies:
                await HTMLResponse("<div id=root><canvas></canvas></div>")(scope, receive, send)
                return
        await self._app(scope, receive, send)


@pytest.fixture(scope="module")
def clips(settings: Settings, installed_models: None) -> Path:
    """Return the folder of the sample clips; skip where no pose can be found for want of models."""
    return settings.samples_dir / "clips"


@pytest.fixture(scope="module")
def shared_context(browser: Browser) -> Iterator[BrowserContext]:
    """Return a browser context for the tests of one file: it loads the page's modules once."""
    context = new_context(browser)
    yield context
    context.close()


def new_context(browser: Browser, **options: Any) -> BrowserContext:
    context = browser.new_context(reduced_motion="reduce", **options)
    context.set_default_timeout(PATIENCE_MS)
    return context


def forget_visit(context: BrowserContext, address: str) -> None:
    """Close a context's pages and delete their stored data, except the first page and the cache."""
    context.set_offline(False)
    context.clear_permissions()
    context.clear_cookies()
    lasting, *pages = context.pages
    for page in pages:
        page.close()
    command = {"origin": address, "storageTypes": "local_storage,indexeddb,service_workers"}
    session = context.new_cdp_session(lasting)
    session.send("Storage.clearDataForOrigin", command)
    session.detach()


@pytest.fixture
def open_page(
    browser: Browser, shared_context: BrowserContext, server: Running
) -> Iterator[OpenPage]:
    """Return a function that opens the app in a tab.

    It takes the query of the address as a mapping, the width and height of the window, the colour
    scheme, whether viser's frame is loaded (drawing WebGL in software is what takes longest),
    whether this browser has never been here, and whether it is a browser of its own: six tabs of
    one have no connection left. Those with and without a scene share none.
    No page may raise an error or break its content security policy.
    """
    contexts: dict[object, BrowserContext] = {}
    errors: list[str] = []

    def open_page(
        query: dict[str, str] | None = None,
        *,
        size: tuple[int, int] = (1280, 800),
        scheme: str = "dark",
        scene: bool = True,
        first_visit: bool = False,
        alone: bool = False,
    ) -> Page:
        if not shared_context.pages:
            # Stays open, so that the pages' shared process survives between tests.
            shared_context.new_page().goto(f"{server.address}/api/v1/server")
        kind = object() if alone else scene
        if kind not in contexts:
            contexts[kind] = new_context(browser) if contexts else shared_context
        context = contexts[kind]
        if not scene:
            context.add_cookies([{"name": WITHOUT_SCENE, "value": "1", "url": server.address}])
        page = context.new_page()
        page.set_viewport_size(ViewportSize(width=size[0], height=size[1]))
        page.emulate_media(color_scheme="light" if scheme == "light" else "dark")
        if not first_visit:
            page.add_init_script("localStorage.setItem('osg-studio.tour', 'seen')")
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.add_init_script(WATCH_POLICY)
        page.goto(f"{server.address}/?{urlencode(query or {})}")
        return page

    yield open_page
    if contexts:
        forget_visit(shared_context, server.address)
    for context in contexts.values():
        if context is not shared_context:
            context.close()
    assert errors == []


@pytest.fixture
def picture(tmp_path: Path) -> Callable[[Page, str], Path]:
    """Return a function that keeps a screenshot under a name.

    They go to ``docs/images`` when ``OSG_UPDATE_IMAGES`` is set, so that a plain test run leaves
    the working tree as it is; there they have a palette, which takes a third of the bytes.
    """
    folder = IMAGES if UPDATES_IMAGES else tmp_path

    def take(page: Page, name: str) -> Path:
        folder.mkdir(parents=True, exist_ok=True)
        path = folder / f"{name}.png"
        page.screenshot(path=path)
        if UPDATES_IMAGES:
            with Image.open(path) as taken:
                palette = taken.convert("RGB").quantize(
                    256, method=Image.Quantize.MAXCOVERAGE, kmeans=2
                )
                palette.save(path, optimize=True)
        return path

    return take


Film = Callable[[Page, float], None]
"""``film(page, seconds)``: shows the page as it is for some seconds."""


@pytest.fixture
def film() -> Iterator[Film]:
    """Return a function that adds a picture to the README's animation.

    The animation is written when ``OSG_UPDATE_IMAGES`` is set.
    """
    pictures: list[Image.Image] = []
    durations: list[int] = []

    def show(page: Page, seconds: float) -> None:
        if UPDATES_IMAGES:
            taken = Image.open(io.BytesIO(page.screenshot())).convert("RGB")
            pictures.append(taken.resize(FILM_SIZE, Image.Resampling.LANCZOS))
            durations.append(round(1000 * seconds))

    yield show
    if pictures:
        first, *others = pictures
        first.save(
            IMAGES / "first-minute.webp",
            save_all=True,
            append_images=others,
            duration=durations,
            loop=0,
            quality=80,
            method=6,
        )
