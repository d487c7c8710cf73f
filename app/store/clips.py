"""Clip store: one row per clip, and a folder of files named by its id."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Collection, Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Final

from sqlalchemy import exists, or_
from sqlalchemy.exc import IntegrityError
from sqlmodel import Session, col, func, select

from app.recognition.text.atomic_files import sync_directory
from app.store.atomic_files import PARTIAL_SUFFIX, publish_copy
from app.store.clip_folder import ClipFolder
from app.store.database import Database, DatabaseStore, NotFound
from app.store.models import UPRIGHT, VIDEO, Clip, Job, JobStatus, new_id, now
from app.store.objects import ObjectStore, SharedFolder
from app.store.objects.clip_copies import ClipCopies
from app.store.quotas import NO_QUOTA, Quota, Usage, release_in

RECORDING, POSTER, FILMSTRIP = "recording.npz", "poster.jpg", "filmstrip.jpg"
"""Files of a clip beside the video and the received file, which its source names."""

SO_FAR = "so-far.npz"
"""A recording of the first frames, on the machine whose job finds the others."""

_FOUND = RECORDING, POSTER, FILMSTRIP

TOPIC_NEEDED = "topic_needed"
"""Error code of the job of a dive recording until somebody chooses a topic."""


@dataclass(frozen=True)
class ClipWithJob:
    """A clip and the job that extracts its poses."""

    clip: Clip
    job: Job


@dataclass(frozen=True)
class ClipQuery:
    """Query for a page of clips: the filter, and where the page begins.

    Attributes
    ----------
    limit
        Most clips of the page.
    after
        Id of the last clip of the previous page; None for the first page.
    name
        Text that the clips' names contain, case-insensitive; empty for any name.
    statuses
        Allowed statuses of each clip's newest job; empty for any.
    ids
        Only clips with these ids; empty for all.

    """

    limit: int
    after: str | None = None
    name: str = ""
    statuses: tuple[JobStatus, ...] = ()
    ids: tuple[str, ...] = ()


@dataclass(frozen=True)
class ClipPage:
    """Page of clips, newest first.

    Attributes
    ----------
    clips
        Clips of this page.
    more
        Whether another page follows.

    """

    clips: list[ClipWithJob]
    more: bool


class ClipStore(DatabaseStore):
    """Keeps clips.

    Parameters
    ----------
    database
        Database of the rows.
    folder
        Folder of the files: ``<folder>/<clip id>/video``, ``recording.npz`` and pictures, and
        uploads under way as ``<folder>/<id>.part``.
    objects
        Object store that keeps the files for all servers; by default they share the folder.
    most_copied
        Most bytes of the copies in `folder` of files in `objects`, see `ClipCopies`; 0 is no limit.

    """

    def __init__(
        self,
        database: Database,
        folder: Path,
        objects: ObjectStore | None = None,
        most_copied: int = 0,
    ) -> None:
        super().__init__(database)
        objects = objects or SharedFolder()
        self._copies = ClipCopies(folder, objects, most_copied, self._at_rest)
        self._files = ClipFolder(folder, objects, self._copies)
        self.folder = folder

    def new_partial(self) -> Path:
        """Return a fresh path for a file that is still being received."""
        return self.folder / f"{new_id()}{PARTIAL_SUFFIX}"

    @contextmanager
    def receiving(self) -> Iterator[Path]:
        """Yield a path, in a folder of its own, for a file that is received or joined meanwhile.

        What is left there goes.
        """
        with tempfile.TemporaryDirectory(PARTIAL_SUFFIX, dir=self.folder) as folder:
            yield Path(folder, "received")

    def add(
        self,
        clip: Clip,
        partial: Path,
        client: str,
        quota: Quota = NO_QUOTA,
        *,
        upload_id: str | None = None,
        picture: bytes | None = None,
    ) -> ClipWithJob:
        """Take over the received file `partial` as `clip` and queue its extraction.

        The job of a dive recording with several topics fails at once and is retried after
        `choose_topic`. The file is stored before the row, in the object store too, because a row
        never refers to a missing file; `partial` is removed after the row is committed, so that
        adding it can be repeated after a failure or a crash in between. When two uploads with one
        idempotency key race, the second one returns the first one's clip.

        The quota is checked in the same transaction, so that no other server adds a clip in
        between. What the resumable upload `upload_id` has reserved of it passes to the clip.

        `picture` is a JPEG, the clip's still picture until its job writes another.

        Raises
        ------
        QuotaExceeded
            When the clip exceeds its owner's quota.
        StoreUnavailable
            When the object store or the database does not answer.

        """
        target = self.place(clip.id, clip.source)
        target.parent.mkdir(exist_ok=True)
        job = Job(clip_id=clip.id, client=client)
        clip.job_id = job.id
        if clip.needs_topic:
            job.status, job.finished = JobStatus.FAILED.value, now()
            job.error_code = TOPIC_NEEDED
            job.error = "the recording holds several topics; choose one of them"
        try:
            publish_copy(partial, target)
            if picture is not None:
                # No clip is lost for want of room for its picture.
                with suppress(OSError):
                    self.place(clip.id, POSTER).write_bytes(picture)
            sync_directory(self.folder)
            self._files.keep(clip.id, [clip.source, POSTER])
            with self._database.writing() as session:
                quota.require_in(session, clip.size, clips=1, without=upload_id)
                if upload_id is not None:
                    release_in(session, upload_id)
                session.add(clip)
                session.flush()
                session.add(job)
        except Exception as error:
            added = self._after_failure(clip, error)
        else:
            added = ClipWithJob(clip, job)
        partial.unlink(missing_ok=True)
        return added

    def get(self, clip_id: str) -> ClipWithJob:
        """Return a clip that is not deleted.

        Raises
        ------
        NotFound
            When there is none.

        """
        with self._database.reading() as session:
            found = session.exec(_WITH_JOB.where(Clip.id == clip_id, _KEPT)).first()
            if found is None:
                raise NotFound(f"there is no clip {clip_id!r}")
            return ClipWithJob(*found)

    def all(self) -> list[ClipWithJob]:
        """Return the clips that are not deleted, newest first."""
        with self._database.reading() as session:
            query = _WITH_JOB.where(_KEPT).order_by(*_NEWEST_FIRST)
            return [ClipWithJob(*found) for found in session.exec(query)]

    def page(self, query: ClipQuery) -> ClipPage:
        """Return a page of the clips that are not deleted, newest first.

        Pages have neither gaps nor repetitions when clips come and go between them.

        Raises
        ------
        NotFound
            When the last clip of the previous page is purged, or never existed.

        """
        with self._database.reading() as session:
            wanted = _WITH_JOB.where(_KEPT)
            if query.after is not None:
                if (last := session.get(Clip, query.after)) is None:
                    raise NotFound(f"there is no clip {query.after!r} to go on after")
                # Not one row comparison: a database uses its index for the first condition.
                wanted = wanted.where(
                    col(Clip.created) <= last.created,
                    or_(col(Clip.created) < last.created, col(Clip.id) > last.id),
                )
            if query.name:
                wanted = wanted.where(col(Clip.name).icontains(query.name, autoescape=True))
            if query.statuses:
                wanted = wanted.where(col(Job.status).in_([each.value for each in query.statuses]))
            if query.ids:
                wanted = wanted.where(col(Clip.id).in_(query.ids))
            wanted = wanted.order_by(*_NEWEST_FIRST)
            found = [ClipWithJob(*each) for each in session.exec(wanted.limit(query.limit + 1))]
            return ClipPage(found[: query.limit], len(found) > query.limit)

    def count(self) -> int:
        """Return the number of clips that are not deleted."""
        with self._database.reading() as session:
            return session.exec(select(func.count()).where(_KEPT)).one()

    def by_idempotency_key(self, key: str) -> ClipWithJob | None:
        """Return the clip of the upload with this key, even if it has been deleted."""
        with self._database.reading() as session:
            found = session.exec(_WITH_JOB.where(Clip.idempotency_key == key)).first()
            return None if found is None else ClipWithJob(*found)

    def delete(self, clip_id: str) -> None:
        """Hide a clip; its files stay until `purge`.

        Raises
        ------
        NotFound
            When there is no such clip, or it is deleted already.

        """
        with self._database.writing() as session:
            clip = _load(session, clip_id)
            clip.deleted = now()

    def restore(self, clip_id: str) -> None:
        """Bring a deleted clip back; nothing happens to one that is not deleted.

        `Settings.undo_hours` says how long deleted clips are kept.

        Raises
        ------
        NotFound
            When it never existed or is purged.

        """
        with self._database.writing() as session:
            if (clip := session.get(Clip, clip_id)) is None:
                raise NotFound(f"there is no clip {clip_id!r} to restore")
            clip.deleted = None

    def choose_topic(self, clip_id: str, topic: str) -> None:
        """Store the topic that a clip is made of, with its frame count, frame size and duration.

        Raises
        ------
        NotFound
            When there is no such clip, or its recording has no such usable topic.

        """
        with self._database.writing() as session:
            clip = _load(session, clip_id)
            known = {each["name"]: each for each in clip.topics}
            if topic not in known:
                raise NotFound(f"clip {clip_id!r} has no topic {topic!r} to choose")
            chosen = known[topic]
            clip.topic, clip.frames = topic, chosen["messages"]
            clip.width, clip.height = chosen["width"], chosen["height"]
            clip.duration = chosen["duration"]

    def turn(self, clip_id: str, degrees: int) -> None:
        """Store that a clip's pictures are turned clockwise by so much more than before.

        Raises
        ------
        NotFound
            When there is no such clip.

        """
        with self._database.writing() as session:
            clip = _load(session, clip_id)
            options = (clip.options or {}) | {"turn": (clip.turn + degrees) % 360}
            # As at intake, defaults are left out; of the stored values only a default is false.
            clip.options = {name: each for name, each in options.items() if each}
            if degrees % 180:
                clip.width, clip.height = clip.height, clip.width
        self.forget_pictures(clip_id)

    def forget_pictures(self, clip_id: str) -> None:
        """Delete this machine's pictures of a clip, made before it was turned."""
        for picture in (POSTER, FILMSTRIP):
            self.place(clip_id, picture).unlink(missing_ok=True)

    def purge(self, before: datetime) -> int:
        """Remove for good the clips deleted before a given time; return their number."""
        with self._database.writing() as session:
            gone = session.exec(select(Clip).where(col(Clip.deleted) < before)).all()
            for clip in gone:
                self._files.note(clip.id)
                session.delete(clip)
        self._files.remove(clip.id for clip in gone)
        return len(gone)

    def purge_for(self, owner: str, excess: Usage) -> Usage:
        """Purge the clips that an owner deleted first, until so much is free.

        Parameters
        ----------
        owner
            Whose deleted clips are purged.
        excess
            Clips and bytes that must go.

        Returns
        -------
        Clips and bytes that still must go.

        """
        gone = []
        with self._database.writing() as session:
            deleted = select(Clip).where(Clip.owner == owner, col(Clip.deleted).is_not(None))
            for clip in session.exec(deleted.order_by(col(Clip.deleted))):
                if excess == Usage(0, 0):
                    break
                excess = Usage(max(0, excess.clips - 1), max(0, excess.bytes - clip.size))
                gone.append(clip.id)
                self._files.note(clip.id)
                session.delete(clip)
        self._files.remove(gone)
        return excess

    def sweep(self, before: datetime) -> int:
        """Remove files that a crash left without a row; return their number.

        Files changed since the time `before` stay.
        """
        with self._database.reading() as session:
            sources = dict(session.exec(select(Clip.id, Clip.source)).all())
        orphans = [path for path in self.folder.iterdir() if path.name not in sources]
        orphans += [
            path
            for path in self.folder.glob("*/*")
            if path.parent.name in sources
            and path.name not in (sources[path.parent.name], VIDEO, *UPRIGHT.values(), *_FOUND)
        ]
        removed, homes = 0, []
        for path in orphans:
            with suppress(OSError):
                if path.stat().st_mtime > before.timestamp():
                    continue
                if path.is_dir() and path.parent == self.folder:
                    homes.append(path.name)
                    continue
                if path.is_dir():
                    shutil.rmtree(path)
                else:
                    path.unlink()
                removed += 1
        return removed + self._files.remove(homes)

    def place(self, clip_id: str, name: str) -> Path:
        """Return where a file of a clip is to be written, on this machine."""
        return self._files.home(clip_id) / name

    def keep_found(self, clip: Clip) -> None:
        """Put the files that a job has written for a clip into the object store.

        Raises
        ------
        StoreUnavailable
            When the object store does not answer; the call can be repeated.

        """
        made = (clip.video_name,) if clip.video_is_made else ()
        self._files.keep(clip.id, (*made, *_FOUND))

    def received(self, clip: Clip) -> Path:
        """Return the path of the received file of a clip."""
        return self._files.find(clip.id, clip.source)

    def video(self, clip_id: str) -> Path:
        """Return the path of the clip's video: the received file, or one that its job made."""
        with self._database.reading() as session:
            clip = session.get(Clip, clip_id)
        return self._files.find(clip_id, VIDEO if clip is None else clip.video_name)

    def recording(self, clip_id: str) -> Path:
        """Return the path of the clip's recording, which exists once its job is done."""
        return self._files.find(clip_id, RECORDING)

    def poster(self, clip_id: str) -> Path:
        """Return the path of the clip's still picture, which all have once their job is done."""
        return self._files.find(clip_id, POSTER)

    def filmstrip(self, clip_id: str) -> Path:
        """Return the path of the clip's thumbnails, which exist once its job is done."""
        return self._files.find(clip_id, FILMSTRIP)

    def hold(self, files: Collection[Path]) -> AbstractContextManager[None]:
        """Keep files on this machine until the context ends, because a process opens them later."""
        return self._copies.hold(files)

    def make_room(self) -> int:
        """Remove copies until they are within the limit; return the number removed."""
        return self._copies.make_room()

    def _after_failure(self, clip: Clip, error: Exception) -> ClipWithJob:
        """Return the stored clip if there is one after all; else remove its files and raise."""
        # The answer to a commit can be lost. While the database does not tell, the files stay, and
        # `sweep` decides later.
        with self._database.reading() as session:
            stored = session.get(Clip, clip.id)
        if stored is not None:
            return self.get(clip.id)
        self._files.remove([clip.id])
        key = clip.idempotency_key if isinstance(error, IntegrityError) else None
        earlier = None if key is None else self.by_idempotency_key(key)
        if earlier is None:
            raise error
        return earlier

    def _at_rest(self, clip_ids: Collection[str]) -> set[str]:
        """Return the clips that have a row and no waiting or running job."""
        opened = (JobStatus.QUEUED.value, JobStatus.RUNNING.value)
        busy = exists().where(col(Job.clip_id) == Clip.id, col(Job.status).in_(opened))
        with self._database.reading() as session:
            return set(session.exec(select(Clip.id).where(col(Clip.id).in_(clip_ids), ~busy)))


def _load(session: Session, clip_id: str) -> Clip:
    """Return a clip that is not deleted."""
    clip = session.get(Clip, clip_id)
    if clip is None or clip.deleted is not None:
        raise NotFound(f"there is no clip {clip_id!r}")
    return clip


_WITH_JOB: Final = select(Clip, Job).join(Job, col(Job.id) == col(Clip.job_id))
"""Selects clips with their newest jobs."""

_KEPT: Final = col(Clip.deleted).is_(None)

_NEWEST_FIRST: Final = (col(Clip.created).desc(), col(Clip.id))
