"""What all requests of one running server share: the store, the workers, the news."""

from __future__ import annotations

import logging
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from datetime import timedelta
from functools import lru_cache
from threading import Event
from typing import Annotated

from fastapi import Depends
from starlette.concurrency import run_in_threadpool
from starlette.requests import HTTPConnection

from app.api.events.broadcast import Broadcast
from app.api.extraction.runner import ExtractionRunner
from app.api.http.problems import ProblemError
from app.api.services.sample_library import Samples
from app.recognition import Language, Recognizer
from app.recognition.recording.recording import Recording
from app.settings import Settings
from app.store import (
    ClipStore,
    Database,
    FolderLock,
    JobStatus,
    JobStore,
    LanguageState,
    LanguageStore,
    RecognitionStore,
    SourceStore,
    UploadStore,
)
from app.store.models import now

CACHED_LANGUAGES = 16
"""Languages and recognisers kept ready; each takes a few megabytes."""

CACHED_RECORDINGS = 4
"""Recordings kept in memory: the clip on screen and those it is compared with."""

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Studio:
    """One running server's parts.

    Attributes
    ----------
    settings
        How it was started.
    clips, uploads, jobs, languages, sources, recognitions
        The store.
    runner
        Extracts poses from clips.
    broadcast
        Tells the open pages what changed.
    samples
        The languages and clips we bring.
    stopping
        Set when the server is about to stop: what takes long is given up.

    """

    settings: Settings
    clips: ClipStore
    uploads: UploadStore
    jobs: JobStore
    languages: LanguageStore
    sources: SourceStore
    recognitions: RecognitionStore
    runner: ExtractionRunner
    broadcast: Broadcast
    samples: Samples
    stopping: Event = field(default_factory=Event)

    def stop_soon(self) -> None:
        """Give up what takes long, and end the event streams."""
        self.stopping.set()
        self.broadcast.close()

    def recording(self, clip_id: str) -> Recording:
        """Return what was found in a clip.

        Raises
        ------
        NotFound
            When there is no such clip.
        ProblemError
            409 while its poses are not extracted.

        """
        found = self.clips.get(clip_id)
        if found.job.status != JobStatus.DONE:
            reason = f"{found.job.status}: {found.job.error}" if found.job.error else None
            raise ProblemError(
                409,
                "clip_not_ready",
                f"the poses of this clip are not extracted ({reason or found.job.status}); "
                "wait for its job, or start it again",
                job_id=found.job.id,
            )
        return _recording(str(self.clips.recording(clip_id)))

    def language(self, state: LanguageState) -> Language:
        """Return the language that a revision holds."""
        return _language(state.revision.document)

    def recognizer(self, state: LanguageState, profile: str | None = None) -> Recognizer:
        """Return a recogniser of a revision, by default with the language's own profile.

        Raises
        ------
        OsgError
            When there is no such profile.

        """
        return _recognizer(state.revision.document, profile)


@lru_cache(CACHED_RECORDINGS)
def _recording(path: str) -> Recording:
    return Recording.load(path)


@lru_cache(CACHED_LANGUAGES)
def _language(document: str) -> Language:
    return Language.from_json(document)


@lru_cache(CACHED_LANGUAGES)
def _recognizer(document: str, profile: str | None) -> Recognizer:
    return Recognizer(_language(document), profile)


@asynccontextmanager
async def running_studio(settings: Settings) -> AsyncIterator[Studio]:
    """Open the store, bring it in order, start the workers; stop them at the end.

    Raises
    ------
    StoreUnavailable
        When the data folder is another server's or cannot be used, or the database is damaged.

    """
    with FolderLock(settings.data_dir):
        async with _studio(settings) as studio:
            yield studio


def check_store(settings: Settings) -> None:
    """Raise StoreUnavailable with one line for a person when the store cannot be opened."""
    with FolderLock(settings.data_dir):
        database = Database(settings.database)
        try:
            database.migrate()
        finally:
            database.close()


@asynccontextmanager
async def _studio(settings: Settings) -> AsyncIterator[Studio]:
    database = Database(settings.database)
    clips = ClipStore(database, settings.data_dir / "clips")
    jobs, languages = JobStore(database), LanguageStore(database)
    broadcast = Broadcast()
    studio = Studio(
        settings=settings,
        clips=clips,
        uploads=UploadStore(settings.data_dir / "uploads"),
        jobs=jobs,
        languages=languages,
        sources=SourceStore(database),
        recognitions=RecognitionStore(database),
        runner=ExtractionRunner(settings, clips, jobs, broadcast),
        broadcast=broadcast,
        samples=Samples(settings.samples_dir),
    )
    try:
        await run_in_threadpool(_bring_in_order, studio, database)
        await studio.runner.start()
        yield studio
    finally:
        broadcast.close()
        await studio.runner.stop()
        database.close()


def _bring_in_order(studio: Studio, database: Database) -> None:
    """Migrate, remove what crashes left and what was deleted long ago, bring the samples."""
    database.migrate()
    before = now() - timedelta(hours=studio.settings.undo_hours)
    purged = studio.clips.purge(before) + studio.languages.purge(before)
    purged += studio.uploads.purge(before)
    if (swept := studio.clips.sweep()) or purged:
        logger.info("removed %d orphaned files and %d deleted or abandoned objects", swept, purged)
    studio.samples.seed(studio.languages)


def _studio_of(connection: HTTPConnection) -> Studio:
    studio: Studio = connection.app.state.studio
    return studio


CurrentStudio = Annotated[Studio, Depends(_studio_of)]
"""A route's parameter of this type receives the running studio."""
