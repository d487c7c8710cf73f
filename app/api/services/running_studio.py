"""Running studio: the store, job runner and event streams that all parts of a server share."""

from __future__ import annotations

import asyncio
import logging
import time
from collections import OrderedDict
from collections.abc import AsyncIterator, Callable, Coroutine, Iterator
from contextlib import ExitStack, asynccontextmanager, contextmanager, suppress
from datetime import datetime, timedelta
from functools import partial, wraps
from inspect import Parameter, signature
from threading import Event, Lock
from typing import Annotated, Any, Generic, TypeVar

from fastapi import Depends
from starlette.concurrency import run_in_threadpool
from starlette.requests import HTTPConnection, Request

from app import store
from app.api.events.broadcast import Broadcast
from app.api.events.broadcast import Event as BroadcastEvent
from app.api.http.connection import compute_while_connected
from app.api.http.problems import ProblemError
from app.api.jobs.extraction_queue import ExtractionQueue
from app.api.jobs.job import JobRunner, compute_in_place
from app.api.observation.heap import keep_trimmed
from app.api.observation.metrics import Metrics
from app.api.services.kept_exports import KeptExports
from app.api.services.recording_cache import RecordingFile, load_recording, whole_recording
from app.api.services.sample_library import Samples
from app.api.workers.worker_messages import Progress
from app.api.workers.worker_processes import Workers
from app.recognition import Language, Recognizer
from app.recognition.recording.recording import Recording
from app.settings import Settings
from app.store.clips import SO_FAR
from app.store.models import now
from app.store.objects import open_object_store
from app.store.server_messages import open_messages
from app.store.uploads import KEPT

MOST_CACHED = 16
"""Number of languages, and of recognisers, cached; each takes a few megabytes."""

MOST_CACHED_CHARACTERS = 32_000_000
"""Characters of their documents together: a cached language takes five times its document, and one
of a thousand gestures has 27 million."""

MOST_COMPUTATIONS = 2
"""Most explanations, previews, pages and the like computed at the same time: one takes seconds with
a large language, and threads must be left for all other requests."""

MOST_EDITS = 2
"""Most edits of languages made at the same time: one of a large language takes seconds, and is made
again if another one of that language came first."""

ONE_SERVER = "SQLite serves one server; for several, set OSG_DATABASE_URL=postgresql+psycopg://USER@HOST/NAME"
"""Advice for a second server that is started on the database file of another one."""

ABANDONED = timedelta(days=1)
"""Age at which a file without a row is removed while servers run: longer than an upload or an
export takes."""

CLEANING_SECONDS = 600.0
"""Seconds between two removals of what was deleted; also what is left for an undo after a start
at which the clock was set forward."""

logger = logging.getLogger(__name__)

Made = TypeVar("Made")
Stored = TypeVar("Stored")


class Studio:
    """Parts of one running server.

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
    clips, uploads, quotas, jobs, languages, sources, recognitions, audit, labelled, practice,
    invitations, sign_ins
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
    computations
        Limits the computations in threads at the same time, see `computed`.
    brief_computations
        Limits those that never take seconds, see `computed_briefly`.
    edits
        Limits the edits of languages at the same time, see `edited`.
    joining
        Lets one upload of chapters be joined at a time.
    exports
        Written files that wait to be fetched.

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
        self.sources = store.SourceStore(database)
        self.recognitions = store.RecognitionStore(database)
        self.audit = store.AuditStore(database, settings.data_dir)
        self.labelled = store.LabelledTakeStore(database)
        self.practice = store.PracticeStore(database)
        self.invitations = store.InvitationStore(database)
        self.sign_ins = store.SignInStore(database)
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
        self.stopping = Event()
        self.computations = asyncio.Semaphore(MOST_COMPUTATIONS)
        self.brief_computations = asyncio.Semaphore(MOST_COMPUTATIONS)
        self.edits = asyncio.Semaphore(MOST_EDITS)
        self.joining = asyncio.Semaphore()
        self.exports = KeptExports()

    def _hear(self, event: BroadcastEvent) -> None:
        """Store the progress of another server's job."""
        if event.kind == "jobs":
            told = event.data.get("progress")
            self.runner.note(event.data["id"], None if told is None else Progress(**told))
            if told is None:
                self.extractions.look()

    async def stop_soon(self) -> None:
        """Cancel the jobs that somebody waits for, and end the event streams."""
        self.stopping.set()
        await self.runner.stop()
        self.broadcast.close()

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

    def recording(self, clip_id: str, *, so_far: bool = False) -> Recording:
        """Return the recording of a clip; see `recording_file`."""
        return load_recording(self.recording_file(clip_id, so_far=so_far))

    def recording_file(self, clip_id: str, *, so_far: bool = False) -> RecordingFile:
        """Return the file of a clip's recording.

        Parameters
        ----------
        clip_id
            The clip's.
        so_far
            Whether the first frames suffice while the others are being read.

        Raises
        ------
        NotFound
            When there is no such clip.
        ProblemError
            409 while its poses are not extracted.

        """
        found = self.clips.get(clip_id)
        if so_far and found.job.status == store.JobStatus.RUNNING:
            with suppress(OSError):
                file = self.clips.place(clip_id, SO_FAR)
                return RecordingFile(file, file.stat().st_mtime_ns, whole=False)
        if found.job.status != store.JobStatus.DONE:
            reason = f"{found.job.status}: {found.job.error}" if found.job.error else None
            raise ProblemError(
                409,
                "clip_not_ready",
                f"the poses of this clip are not extracted ({reason or found.job.status}); "
                "wait for its job, or start it again",
                job_id=found.job.id,
            )
        return whole_recording(self.clips.recording(clip_id))

    def language(self, state: store.LanguageState) -> Language:
        """Return the language that a revision holds."""
        return _languages.get(state.revision.document)

    def recognizer(self, state: store.LanguageState, profile: str | None = None) -> Recognizer:
        """Return a recogniser of a revision, by default with the language's own profile.

        Raises
        ------
        OsgError
            When there is no such profile.

        """
        return _recognizers.get(state.revision.document, profile)


class DocumentCache(Generic[Made]):
    """What was made of documents, the least recently used of which go when they are too long.

    The newest stays, however long it is.
    """

    def __init__(self, make: Callable[..., Made]) -> None:
        self._make = make
        self._made: OrderedDict[tuple[str, str | None], Made] = OrderedDict()
        self._changing = Lock()

    def __len__(self) -> int:
        """Return how many documents something is kept of."""
        return len(self._made)

    def get(self, document: str, profile: str | None = None) -> Made:
        """Return what was made of a document, or make it."""
        key = document, profile
        with self._changing:
            if key in self._made:
                self._made.move_to_end(key)
                return self._made[key]
        made = self._make(document) if profile is None else self._make(document, profile)
        with self._changing:
            self._made[key] = made
            while len(self._made) > 1 and (
                len(self._made) > MOST_CACHED
                or sum(len(text) for text, _ in self._made) > MOST_CACHED_CHARACTERS
            ):
                self._made.popitem(last=False)
        return made


def _make_recognizer(document: str, profile: str | None = None) -> Recognizer:
    return Recognizer(_languages.get(document), profile)


_languages = DocumentCache(Language.from_json)
_recognizers = DocumentCache(_make_recognizer)


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


def _studio_of(connection: HTTPConnection) -> Studio:
    studio: Studio = connection.app.state.studio
    return studio


CurrentStudio = Annotated[Studio, Depends(_studio_of)]
"""Type of a route's parameter that receives the running studio."""


def computed(route: Callable[..., Made]) -> Callable[..., Coroutine[Any, Any, Made]]:
    """Decorate a route that computes for seconds: few run at a time, while their clients wait.

    A route with the parameter ``advance`` calls it between its steps, and is ended there once its
    client has left.
    """
    return _limited(route, lambda studio: studio.computations)


def computed_briefly(route: Callable[..., Made]) -> Callable[..., Coroutine[Any, Any, Made]]:
    """Decorate a route as `computed`, whose turn does not wait for what takes seconds."""
    return _limited(route, lambda studio: studio.brief_computations)


def edited(route: Callable[..., Made]) -> Callable[..., Coroutine[Any, Any, Made]]:
    """Decorate a route that computes a change: few run at a time, and waiting takes no thread.

    It goes on when its client leaves, so that the change is in the audit log.
    """
    return _limited(route, lambda studio: studio.edits, goes_on=True)


def _limited(
    route: Callable[..., Made],
    places_of: Callable[[Studio], asyncio.Semaphore],
    *,
    goes_on: bool = False,
) -> Callable[..., Coroutine[Any, Any, Made]]:
    parameters = dict(signature(route).parameters)
    has_steps = parameters.pop("advance", None) is not None

    @wraps(route)
    async def limited(*, connection: Request, **given: Any) -> Made:
        def compute(advance: Callable[[], None]) -> Made:
            return route(**given, **({"advance": advance} if has_steps else {}))

        places = places_of(_studio_of(connection))
        if goes_on:
            return await compute_in_place(places, partial(route, **given))
        return await compute_while_connected(connection, places, compute)

    asked = Parameter("connection", Parameter.KEYWORD_ONLY, annotation=Request)
    limited.__signature__ = signature(route).replace(  # type: ignore[attr-defined]
        parameters=[*parameters.values(), asked]
    )
    return limited
