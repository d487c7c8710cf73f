"""Quota store: what each owner keeps, and reserves for uploads under way, on all servers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from datetime import timedelta

from sqlmodel import Session, col, delete, func, select

from app.store.database import Database, moment_of
from app.store.models import Clip, UploadReservation
from app.store.uploads import ACTIVE, Upload

RENEWED = timedelta(minutes=15)
"""Age of a reservation that another part of its upload renews: a part may take seconds, and each
renewal is a write."""


@dataclass(frozen=True)
class Usage:
    """What somebody keeps, with what is reserved for uploads under way."""

    clips: int
    bytes: int


Allowance = Callable[[Usage], None]
"""Raises an error of its own when beside that usage there is no place for what is to come."""


class QuotaStore:
    """Reserves place for uploads; who checks and who reserves holds the database's write lock.

    Parameters
    ----------
    database
        Where the rows are.

    """

    def __init__(self, database: Database) -> None:
        self._database = database

    def usage(self, owner: str) -> Usage:
        """Return what somebody keeps and has reserved at this moment."""
        with self._database.reading() as session:
            return usage_of(session, owner)

    def reserve(self, upload: Upload, allow: Allowance | None) -> None:
        """Count an upload that begins by its owner's quota; what `allow` raises keeps it out."""
        with self._database.writing(counted=False) as session:
            over = moment_of(session) - ACTIVE
            session.execute(delete(UploadReservation).where(col(UploadReservation.touched) < over))
            if allow is not None:
                allow(usage_of(session, upload.owner))
            session.add(_reservation(upload, session))

    def renew(self, upload: Upload) -> None:
        """Go on counting an upload to which bytes come; without them it counts for `ACTIVE`."""
        with self._database.reading() as session:
            kept = session.get(UploadReservation, upload.id)
            if kept is not None and kept.touched > moment_of(session) - RENEWED:
                return
        with self._database.writing(counted=False) as session:
            session.merge(_reservation(upload, session))

    def release(self, upload_id: str) -> None:
        """Count an upload no more; nothing happens when it does not count."""
        with self._database.writing(counted=False) as session:
            release_in(session, upload_id)


def usage_of(session: Session, owner: str, *, without: str | None = None) -> Usage:
    """Return what somebody keeps and has reserved, except for the upload `without`."""
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
    """Count an upload no more, in a transaction that makes a clip of it."""
    session.execute(delete(UploadReservation).where(col(UploadReservation.id) == upload_id))


def _reservation(upload: Upload, session: Session) -> UploadReservation:
    return UploadReservation(
        id=upload.id, owner=upload.owner, size=upload.size, touched=moment_of(session)
    )
