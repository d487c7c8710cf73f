"""Quota store: space that each owner uses, and reserves for uploads under way, on all servers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from datetime import timedelta

from sqlmodel import Session, col, delete, func, select

from app.store.database import Database, moment_of
from app.store.models import Clip, UploadReservation
from app.store.uploads import ACTIVE, Upload

RENEWED = timedelta(minutes=15)
"""Age from which the next part of an upload renews its reservation; not every part does, because
each renewal is a write."""


@dataclass(frozen=True)
class Usage:
    """Clips and bytes that an owner keeps, including reservations for uploads under way."""

    clips: int
    bytes: int


Allowance = Callable[[Usage], None]
"""Raises its own error if the quota, with this usage, has no place for the new clip."""


class QuotaStore:
    """Reserves quota for uploads; checks and reservations hold the database's write lock.

    Parameters
    ----------
    database
        Where the rows are.

    """

    def __init__(self, database: Database) -> None:
        self._database = database

    def usage(self, owner: str) -> Usage:
        """Return the present usage of an owner."""
        with self._database.reading() as session:
            return usage_of(session, owner)

    def reserve(self, upload: Upload, allow: Allowance | None) -> None:
        """Reserve quota for a new upload; if `allow` raises, nothing is reserved."""
        with self._database.writing(counted=False) as session:
            over = moment_of(session) - ACTIVE
            session.execute(delete(UploadReservation).where(col(UploadReservation.touched) < over))
            if allow is not None:
                allow(usage_of(session, upload.owner))
            session.add(_reservation(upload, session))

    def renew(self, upload: Upload) -> None:
        """Renew the reservation of an upload; without new bytes it expires after `ACTIVE`."""
        with self._database.reading() as session:
            kept = session.get(UploadReservation, upload.id)
            if kept is not None and kept.touched > moment_of(session) - RENEWED:
                return
        with self._database.writing(counted=False) as session:
            session.merge(_reservation(upload, session))

    def release(self, upload_id: str) -> None:
        """Release the reservation of an upload; do nothing if it has none."""
        with self._database.writing(counted=False) as session:
            release_in(session, upload_id)


def usage_of(session: Session, owner: str, *, without: str | None = None) -> Usage:
    """Return the usage of an owner, except for the upload `without`."""
    kept = select(func.count(), func.coalesce(func.sum(Clip.size), 0)).where(
        Clip.owner == owner, col(Clip.deleted).is_(None)
    )
    reserved = select(func.count(), func.coalesce(func.sum(UploadReservation.size), 0)).where(
        UploadReservation.owner == owner,
        col(UploadReservation.id) != (without or ""),
        col(UploadReservation.touched) >= moment_of(session) - ACTIVE,
    )
    clips, size = session.exec(kept).one()
    uploads, coming = session.exec(reserved).one()
    return Usage(int(clips) + int(uploads), int(size) + int(coming))


def release_in(session: Session, upload_id: str) -> None:
    """Release the reservation of an upload, in the transaction that makes a clip of it."""
    session.execute(delete(UploadReservation).where(col(UploadReservation.id) == upload_id))


def _reservation(upload: Upload, session: Session) -> UploadReservation:
    return UploadReservation(
        id=upload.id, owner=upload.owner, size=upload.size, touched=moment_of(session)
    )
