"""Library: server load with many languages and clips.

The processor time that a server of 200 languages and 1000 clips takes for a page's requests,
relative to a server of 10 and 10. The requests go through the whole app, without a network.
"""

from __future__ import annotations

import asyncio
import tempfile
import time
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import median

import httpx

from app.api.services.language_documents import draft_of
from app.api.services.running_studio import Studio
from app.recognition import Language
from app.resources import samples_dir
from app.server import create_app
from app.settings import Settings
from app.store import Clip

SMALL, LARGE = (10, 10), (200, 1000)
"""Languages and clips."""

REPEATS = 15
"""Runs of an action: odd for the median, which leaves out an occasional garbage collection."""

LISTS = ("/api/v1/languages", "/api/v1/clips")


@dataclass
class Page:
    """State of an open page.

    Attributes
    ----------
    client
        Asks the server.
    language, clip
        Ids of the language that is changed, and of a clip.
    tags
        Per list the ETag of the page's version.

    """

    client: httpx.AsyncClient
    language: str
    clip: str
    tags: dict[str, str]

    async def first_visit(self) -> None:
        """Load both lists."""
        for place in LISTS:
            answer = await self.client.get(place)
            assert answer.status_code == 200
            self.tags[place] = answer.headers["etag"]

    async def visit(self) -> None:
        """Load both lists again, with the ETags of a browser that has them."""
        for place in LISTS:
            answer = await self.client.get(place, headers={"If-None-Match": self.tags[place]})
            assert answer.status_code == 304

    async def change(self) -> None:
        """Rename a language, and load the change as every open page does."""
        place = f"/api/v1/languages/{self.language}"
        name = f"renamed {time.monotonic_ns()}"
        assert (await self.client.patch(place, json={"name": name})).status_code == 200
        assert (await self.client.get(place)).json()["name"] == name
        assert (await self.client.get(f"/api/v1/clips/{self.clip}")).status_code == 200

    async def visit_after_change(self) -> None:
        """Change a language, and load both lists anew."""
        await self.change()
        await self.first_visit()


async def cost(doing: Callable[[], Awaitable[None]]) -> float:
    """Return the median processor time of `doing` in this process, in seconds."""
    spent = []
    for _ in range(REPEATS):
        before = time.process_time()
        await doing()
        spent.append(time.process_time() - before)
    return median(spent)


def fill(studio: Studio, languages: int, clips: int) -> tuple[str, str]:
    """Add languages of eight gestures and finished clips; return the id of one of each."""
    sample = Language.load(samples_dir() / "osg-table-2.json")
    for number in range(languages):
        draft = draft_of(replace(sample, name=f"language {number}"), "Import")
        language = studio.languages.create(draft, sample.revision).record.id
    for number in range(clips):
        partial = studio.clips.new_partial()
        partial.write_bytes(b"video")
        clip = Clip(name=f"{number}.mp4", media_type="video/mp4", size=5, width=640, height=480)
        added = studio.clips.add(clip, partial, "benchmark")
        studio.jobs.start(added.job.id)
        studio.jobs.complete(added.job.id, 90, ())
    return language, clip.id


async def costs(languages: int, clips: int) -> dict[str, float]:
    """Return the cost of every action of a page on a server with so many languages and clips."""
    with tempfile.TemporaryDirectory() as folder:
        app = create_app(Settings(data_dir=Path(folder), samples_dir=Path(folder) / "none"))
        transport = httpx.ASGITransport(app)
        async with (
            app.router.lifespan_context(app),
            httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1") as client,
        ):
            page = Page(client, *fill(app.state.studio, languages, clips), {})
            await page.first_visit()
            return {
                "a page is opened again": await cost(page.visit),
                "a page is opened": await cost(page.first_visit),
                "a language changes": await cost(page.change),
                "a page is opened after a change": await cost(page.visit_after_change),
            }


def main() -> None:
    """Print the ratio of costs between the large and the small library."""
    small, large = (asyncio.run(costs(*size)) for size in (SMALL, LARGE))
    for doing in small:
        ratio = large[doing] / small[doing]
        print(f"library of {LARGE} to one of {SMALL}, when {doing}: {ratio:.2f} times the cost")
