"""Running studio: the store, job runner and event streams that all parts of a server share."""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import ExitStack, asynccontextmanager, contextmanager
from datetime import datetime, timedelta
from functools import partial
from typing import Annotated, Any, TypeVar

from fastapi import Depends
from starlette.concurrency import run_in_threadpool
from starlette.requests import HTTPConnection

from app import store
from app.api.events.broadcast import Broadcast, Event
from app.api.jobs.extraction_queue import ExtractionQueue
from app.api.jobs.job import JobRunner
from app.api.observation.heap import keep_trimmed
from app.api.observation.metrics import Metrics
from app.api.services.demonstration_sources import Demonstrations
from app.api.services.kept_exports import KeptExports
from app.api.services.limited_routes import Turns
from app.api.services.sample_library import Samples
from app.api.workers.worker_messages import Progress
from app.api.workers.worker_processes import Workers
from app.settings import Settings
from app.store.models import now
from app.store.objects import open_object_store
from app.store.server_messages import open_messages
from app.store.uploads import KEPT

ONE_SERVER = "SQLite serves one server; for several, set OSG_DATABASE_URL=postgresql+psycopg://USER@HOST/NAME"
"""Advice for a second server that is started on the database file of another one."""

ABANDONED = timedelta(days=1)
"""Age at which a file without a row is removed while servers run: longer than an upload or an
export takes."""

CLEANING_SECONDS = 600.0
"""Seconds between two removals of what was deleted; also what is left for an undo after a start
at which the clock was set forward."""

logger = logging.getLogger(__name__)

Part = TypeVar("Part")
Stored = TypeVar("Stored")


class Studio:
    """Parts of one running server; a route that needs one or two of them asks for these alone.

    Parameters
    ----------
    settings
        Settings of the server.
    database
        Database of the store.
    metrics
        Metrics for Prometheus.

    Attributes
    ----------
    clips, uploads, quotas, jobs, languages, recognitions, audit, takes, invitations, sign_ins
        The store.
    demonstrations
        Knows from which clips demonstrations come.
    samples
        The languages and clips that come with the program.
    broadcast
        Publishes changes to the open pages.
    workers
        Starts processes that read clips.
    runner
        Runs jobs of all kinds.
    extractions
        Queues the jobs that extract poses from clips.
    exports
        Written files that wait to be fetched.
    turns
        Limits what is done at the same time.

    """

    def __init__(self, settings: Settings, database: store.Database, metrics: Metrics) -> None:
        self.settings = settings
        self.metrics = metrics
        self.clips = store.ClipStore(
            database,
            settings.clips,
            open_object_store(settings.objects),
            settings.limits.storage_copy_bytes if settings.objects else 0,
        )
        self.uploads = store.UploadStore(settings.data_dir / "uploads")
        self.quotas = store.QuotaStore(database)
        self.jobs = store.JobStore(database, store.identity_of(settings.data_dir))
        self.languages = store.LanguageStore(database)
        self.recognitions = store.RecognitionStore(database)
        self.audit = store.AuditStore(database, settings.data_dir)
        self.takes = store.TakeStore(database)
        self.invitations = store.InvitationStore(database)
        self.sign_ins = store.SignInStore(database)
        self.demonstrations = Demonstrations(self.clips, store.SourceStore(database))
        self.samples = Samples(settings.samples_dir)
        self.broadcast = Broadcast(partial(open_messages, database), self._hear)
        self.workers = Workers(settings, metrics, self.clips.hold)
        self.runner = JobRunner(self.broadcast, metrics)
        self.extractions = ExtractionQueue(
            self.runner,
            self.clips,
            self.jobs,
            self.workers,
            self.broadcast,
            settings,
            self.samples.find_recording,
        )
        self.exports = KeptExports()
        self.turns = Turns()

    def _hear(self, event: Event) -> None:
        """Store the progress of another server's job."""
        if event.kind == "jobs":
            told = event.data.get("progress")
            self.runner.note(event.data["id"], None if told is None else Progress(**told))
            if told is None:
                self.extractions.look()

    def keep_within(self, quota: store.Quota, keep: Callable[[], Stored]) -> Stored:
        """Store something by `keep`; if need be, purge first what its owner deleted.

        Raises
        ------
        QuotaExceeded
            When it does not fit all the same; then nothing is purged.

        """
        try:
            return keep()
        except store.QuotaExceeded as error:
            if not error.deleted_suffice:
                raise
            self.languages.purge_for(quota.owner, self.clips.purge_for(quota.owner, error.excess))
        return keep()


@asynccontextmanager
async def open_studio(settings: Settings, metrics: Metrics | None = None) -> AsyncIterator[Studio]:
    """Open and migrate the store, start the jobs; stop them at the end.

    Raises
    ------
    StoreUnavailable
        When another server uses the data folder, or it cannot be used, or the database is damaged.

    """
    with _opened(settings) as database:
        studio = Studio(settings, database, metrics or Metrics())
        beside = studio.metrics.watch_loop(), keep_trimmed(), _keep_clean(studio)
        watching = [asyncio.create_task(each) for each in beside]
        try:
            await run_in_threadpool(_prepare, studio, database)
            await studio.extractions.start()
            yield studio
        finally:
            for each in watching:
                each.cancel()
            studio.broadcast.close()
            await studio.runner.stop()
            await studio.extractions.stop()
            await studio.workers.close()
            studio.exports.clear()
            await run_in_threadpool(studio.broadcast.leave)


def check_store(settings: Settings) -> None:
    """Raise StoreUnavailable with one line for a person when the store cannot be opened."""
    with _opened(settings) as database:
        database.migrate()
        open_object_store(settings.objects)


@contextmanager
def _opened(settings: Settings) -> Iterator[store.Database]:
    """Open the database; keep other servers out of the data folder, and out of SQLite's file."""
    with ExitStack() as locks:
        locks.enter_context(store.FolderLock(settings.data_dir))
        database = store.Database(settings.database)
        locks.callback(database.close)
        if (file := database.file) is not None and file.parent != settings.data_dir:
            locks.enter_context(store.FolderLock(file.parent, remedy=ONE_SERVER))
        yield database


def _prepare(studio: Studio, database: store.Database) -> None:
    """Migrate, remove leftovers of crashes, add the samples."""
    database.migrate()
    studio.audit.import_journal()
    # A file that another server is writing to the same folder is no orphan.
    if swept := studio.clips.sweep(now() - ABANDONED if database.shared else now()):
        logger.info("removed %d orphaned files", swept)
    studio.samples.seed(studio.languages)


async def _keep_clean(studio: Studio) -> None:
    """Remove from time to time what was deleted or abandoned long ago."""
    # Counted from the start, so that a step of the clock meanwhile ends no undo.
    started, since = now(), time.monotonic()
    while True:
        await asyncio.sleep(CLEANING_SECONDS)
        moment = started + timedelta(seconds=time.monotonic() - since)
        try:
            await run_in_threadpool(clean, studio, moment)
        except (store.StoreError, OSError) as error:
            logger.warning("what was deleted stays for now: %s", error)


def clean(studio: Studio, moment: datetime) -> None:
    """Remove for good what was deleted or abandoned long before `moment`."""
    deleted = moment - timedelta(hours=studio.settings.undo_hours)
    purged = studio.clips.purge(deleted) + studio.languages.purge(deleted)
    purged += studio.uploads.purge(moment - KEPT)
    if (swept := studio.clips.sweep(moment - ABANDONED)) or purged:
        logger.info("removed %d deleted or abandoned objects and %d files", purged, swept)


def _part(choose: Callable[[Studio], Part]) -> Any:
    async def part_of(connection: HTTPConnection) -> Part:
        return choose(connection.app.state.studio)

    return Depends(part_of)


CurrentStudio = Annotated[Studio, _part(lambda studio: studio)]
"""Type of a route's parameter that receives the running studio; those below receive one part."""

Audit = Annotated[store.AuditStore, _part(lambda studio: studio.audit)]
Clips = Annotated[store.ClipStore, _part(lambda studio: studio.clips)]
Invitations = Annotated[store.InvitationStore, _part(lambda studio: studio.invitations)]
Jobs = Annotated[store.JobStore, _part(lambda studio: studio.jobs)]
KnownDemonstrations = Annotated[Demonstrations, _part(lambda studio: studio.demonstrations)]
Languages = Annotated[store.LanguageStore, _part(lambda studio: studio.languages)]
Quotas = Annotated[store.QuotaStore, _part(lambda studio: studio.quotas)]
Recognitions = Annotated[store.RecognitionStore, _part(lambda studio: studio.recognitions)]
Runner = Annotated[JobRunner, _part(lambda studio: studio.runner)]
SampleLibrary = Annotated[Samples, _part(lambda studio: studio.samples)]
ServerSettings = Annotated[Settings, _part(lambda studio: studio.settings)]
SignIns = Annotated[store.SignInStore, _part(lambda studio: studio.sign_ins)]
Uploads = Annotated[store.UploadStore, _part(lambda studio: studio.uploads)]
