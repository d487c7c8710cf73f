"""Running studio: the store, job runner and event streams that all parts of a server share."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import AsyncIterator, Iterator
from contextlib import ExitStack, asynccontextmanager, contextmanager
from dataclasses import dataclass, field
from datetime import timedelta
from functools import lru_cache, partial
from pathlib import Path
from threading import Event
from typing import Annotated

from fastapi import Depends
from starlette.concurrency import run_in_threadpool
from starlette.requests import HTTPConnection

from app.api.events.broadcast import Broadcast
from app.api.events.broadcast import Event as BroadcastEvent
from app.api.http.problems import ProblemError
from app.api.jobs.extraction_queue import ExtractionQueue
from app.api.jobs.job import progress_of
from app.api.jobs.runner import JobRunner
from app.api.observation.heap import keep_trimmed
from app.api.observation.metrics import Metrics
from app.api.services.kept_exports import KeptExports
from app.api.services.sample_library import Samples
from app.api.workers.worker_processes import Workers
from app.recognition import Language, Recognizer
from app.recognition.recording.recording import Recording
from app.settings import Settings
from app.store import (
    AuditStore,
    ClipStore,
    Database,
    FolderLock,
    JobStatus,
    JobStore,
    LabelledTakeStore,
    LanguageState,
    LanguageStore,
    PracticeStore,
    QuotaStore,
    RecognitionStore,
    SourceStore,
    UploadStore,
    identity_of,
)
from app.store.models import now
from app.store.objects import open_object_store
from app.store.server_messages import open_messages

CACHED_LANGUAGES = 16
"""Number of languages and recognisers cached; each takes a few megabytes."""

CACHED_RECORDINGS = 4
"""Number of recordings cached: the clip on screen and those it is compared with."""

MOST_COMPUTATIONS = 2
"""Most previews and pair differences computed at the same time: one takes seconds with a large
language, and threads must be left for all other requests."""

ONE_SERVER = "SQLite serves one server; for several, set OSG_DATABASE_URL=postgresql+psycopg://USER@HOST/NAME"
"""Advice for a second server that is started on the database file of another one."""

ABANDONED = timedelta(days=1)
"""Age at which a file without a row is removed from a folder that several servers share: longer
than an upload or an export takes."""

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Studio:
    """Parts of one running server.

    Attributes
    ----------
    settings
        Settings of the server.
    clips, uploads, quotas, jobs, languages, sources, recognitions, audit, labelled, practice
        The store.
    workers
        Starts processes that read clips.
    runner
        Runs jobs of all kinds.
    extractions
        Queues the jobs that extract poses from clips.
    broadcast
        Publishes changes to the open pages.
    samples
        The languages and clips that come with the program.
    stopping
        Event that is set when the server is about to stop.
    metrics
        Metrics for Prometheus.
    computations
        Limits the previews and pair differences that compute in threads at the same time.
    exports
        Written files that wait to be fetched.

    """

    settings: Settings
    clips: ClipStore
    uploads: UploadStore
    quotas: QuotaStore
    jobs: JobStore
    languages: LanguageStore
    sources: SourceStore
    recognitions: RecognitionStore
    audit: AuditStore
    labelled: LabelledTakeStore
    practice: PracticeStore
    workers: Workers
    runner: JobRunner
    extractions: ExtractionQueue
    broadcast: Broadcast
    samples: Samples
    stopping: Event = field(default_factory=Event)
    metrics: Metrics = field(default_factory=Metrics)
    computations: asyncio.Semaphore = field(
        default_factory=lambda: asyncio.Semaphore(MOST_COMPUTATIONS)
    )
    exports: KeptExports = field(default_factory=KeptExports)

    async def stop_soon(self) -> None:
        """Cancel the jobs that somebody waits for, and end the event streams."""
        self.stopping.set()
        await self.runner.stop()
        self.broadcast.close()

    def recording(self, clip_id: str) -> Recording:
        """Return the recording of a clip; errors as in `recording_file`."""
        return load_recording(str(self.recording_file(clip_id)))

    def recording_file(self, clip_id: str) -> Path:
        """Return the file of a clip's recording.

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
        return self.clips.recording(clip_id)

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
def load_recording(path: str) -> Recording:
    """Load a recording, or return it from the cache."""
    return Recording.load(path)


@lru_cache(CACHED_LANGUAGES)
def _language(document: str) -> Language:
    return Language.from_json(document)


@lru_cache(CACHED_LANGUAGES)
def _recognizer(document: str, profile: str | None) -> Recognizer:
    return Recognizer(_language(document), profile)


@asynccontextmanager
async def open_studio(settings: Settings, metrics: Metrics | None = None) -> AsyncIterator[Studio]:
    """Open and migrate the store, start the jobs; stop them at the end.

    Raises
    ------
    StoreUnavailable
        When another server uses the data folder, or it cannot be used, or the database is damaged.

    """
    with _opened(settings) as database:
        async with _studio(settings, database, metrics or Metrics()) as studio:
            yield studio


def check_store(settings: Settings) -> None:
    """Raise StoreUnavailable with one line for a person when the store cannot be opened."""
    with _opened(settings) as database:
        database.migrate()
        open_object_store(settings.objects)


@contextmanager
def _opened(settings: Settings) -> Iterator[Database]:
    """Open the database; keep other servers out of the data folder, and out of SQLite's file."""
    with ExitStack() as locks:
        locks.enter_context(FolderLock(settings.data_dir))
        database = Database(settings.database)
        locks.callback(database.close)
        if (file := database.file) is not None and file.parent != settings.data_dir:
            locks.enter_context(FolderLock(file.parent, remedy=ONE_SERVER))
        yield database


@asynccontextmanager
async def _studio(
    settings: Settings, database: Database, metrics: Metrics
) -> AsyncIterator[Studio]:
    clips = ClipStore(
        database,
        settings.clips,
        open_object_store(settings.objects),
        settings.storage_copy_bytes if settings.objects else 0,
    )
    jobs = JobStore(database, identity_of(settings.data_dir))
    languages = LanguageStore(database)

    def hear(event: BroadcastEvent) -> None:
        """Store the progress of another server's job."""
        if event.kind == "jobs":
            progress = progress_of(event)
            runner.note(event.data["id"], progress)
            if progress is None:
                extractions.look()

    broadcast = Broadcast(partial(open_messages, database), hear)
    workers, runner = Workers(settings, metrics, clips.hold), JobRunner(broadcast, metrics)
    extractions = ExtractionQueue(runner, clips, jobs, workers, broadcast, count=settings.workers)
    watching = [asyncio.create_task(each) for each in (metrics.watch_loop(), keep_trimmed())]
    studio = Studio(
        settings=settings,
        clips=clips,
        uploads=UploadStore(settings.data_dir / "uploads"),
        quotas=QuotaStore(database),
        jobs=jobs,
        languages=languages,
        sources=SourceStore(database),
        recognitions=RecognitionStore(database),
        audit=AuditStore(database),
        labelled=LabelledTakeStore(database),
        practice=PracticeStore(database),
        workers=workers,
        runner=runner,
        extractions=extractions,
        broadcast=broadcast,
        samples=Samples(settings.samples_dir),
        metrics=metrics,
    )
    try:
        await run_in_threadpool(_prepare, studio, database)
        await studio.extractions.start()
        yield studio
    finally:
        for each in watching:
            each.cancel()
        broadcast.close()
        await studio.runner.stop()
        await studio.extractions.stop()
        await workers.close()
        studio.exports.clear()
        await run_in_threadpool(broadcast.leave)


def _prepare(studio: Studio, database: Database) -> None:
    """Migrate, remove leftovers of crashes and old deletions, add the samples."""
    database.migrate()
    before = now() - timedelta(hours=studio.settings.undo_hours)
    purged = studio.clips.purge(before) + studio.languages.purge(before)
    purged += studio.uploads.purge(before)
    # A file that another server is writing to the same folder is no orphan.
    abandoned = now() - ABANDONED if database.shared else now()
    if (swept := studio.clips.sweep(abandoned)) or purged:
        logger.info("removed %d orphaned files and %d deleted or abandoned objects", swept, purged)
    studio.samples.seed(studio.languages)


def _studio_of(connection: HTTPConnection) -> Studio:
    studio: Studio = connection.app.state.studio
    return studio


CurrentStudio = Annotated[Studio, Depends(_studio_of)]
"""Type of a route's parameter that receives the running studio."""
