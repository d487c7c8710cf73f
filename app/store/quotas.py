"""Quotas: what each owner keeps, reserves for uploads under way, and may keep, on all servers."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import timedelta

from sqlalchemy import Function, exists, or_
from sqlalchemy.orm import aliased
from sqlmodel import Session, col, delete, func, select

from app.store.database import DatabaseStore, StoreError, moment_of
from app.store.models import (
    Clip,
    LanguageRecord,
    LanguageRevision,
    RecognitionRecord,
    UploadReservation,
)
from app.store.uploads import KEPT, Upload

RENEWED = timedelta(minutes=15)
"""Age from which the next part of an upload renews its reservation; not every part does, because
each renewal is a write."""


@dataclass(frozen=True)
class Usage:
    """Clips, and bytes in all, that an owner takes of the disk.

    Deleted clips and languages count until they are purged, uploads under way with all their
    bytes, and each revision of a language and each recognition with its document.
    """

    clips: int
    bytes: int


class QuotaExceeded(StoreError):
    """Raised when something new exceeds its owner's quota; nothing was stored.

    Parameters
    ----------
    message
        What is kept, how much is allowed, and what to do, in one line.
    usage
        What the owner keeps already.
    limit
        Most clips, or bytes, allowed.
    excess
        Clips and bytes that must go before it fits.
    alone
        Whether it exceeds the quota even alone.

    Attributes
    ----------
    deleted_suffice
        Whether it fits once deleted clips and languages are purged.

    """

    def __init__(
        self, message: str, usage: Usage, *, limit: int, excess: Usage, alone: bool = False
    ) -> None:
        super().__init__(message)
        self.usage = usage
        self.limit = limit
        self.excess = excess
        self.alone = alone
        self.deleted_suffice = False


@dataclass(frozen=True)
class Quota:
    """What one owner may keep.

    Attributes
    ----------
    owner
        Name of the owner's token; empty if no token is needed.
    bytes, clips
        Most bytes and clips; 0 is no limit.

    """

    owner: str = ""
    bytes: int = 0
    clips: int = 0

    def require(self, usage: Usage, size: int, clips: int = 0) -> None:
        """Refuse what exceeds the quota together with the present `usage`.

        Parameters
        ----------
        usage
            What the owner keeps already.
        size, clips
            Bytes and clips that are to be added.

        Raises
        ------
        QuotaExceeded
            When they do not fit.

        """
        more = self._excess(usage, size, clips)
        if more == Usage(0, 0):
            return
        limit, alone = self.bytes, not more.clips and size > self.bytes
        left = max(0, self.bytes - usage.bytes)
        detail = (
            f"{self.owner!r} keeps {_megabytes(usage.bytes)}, so {_megabytes(left)} are left for "
            f"this of {_megabytes(size)}; delete clips or languages, or ask an administrator for "
            "a larger quota"
        )
        if more.clips:
            limit = self.clips
            detail = (
                f"{self.owner!r} keeps {usage.clips} clips, and {self.clips} are allowed; "
                "delete some, or ask an administrator for a larger quota"
            )
        elif alone:
            detail = (
                f"this takes {_megabytes(size)}, and {self.owner!r} may keep "
                f"{_megabytes(self.bytes)} in all; send something shorter or smaller"
            )
        raise QuotaExceeded(detail, usage, limit=limit, excess=more, alone=alone)

    def require_in(
        self, session: Session, size: int, clips: int = 0, *, without: str | None = None
    ) -> None:
        """Refuse, in a transaction, what exceeds the quota, apart from the upload `without`.

        Raises
        ------
        QuotaExceeded
            As `require`.

        """
        if not (self.bytes or self.clips):
            return
        try:
            self.require(usage_of(session, self.owner, without=without), size, clips)
        except QuotaExceeded as error:
            kept = usage_of(session, self.owner, without=without, deleted=False)
            error.deleted_suffice = self._excess(kept, size, clips) == Usage(0, 0)
            raise

    def _excess(self, usage: Usage, size: int, clips: int) -> Usage:
        return Usage(
            max(0, usage.clips + clips - self.clips) if self.clips and clips else 0,
            max(0, usage.bytes + size - self.bytes) if self.bytes else 0,
        )


NO_QUOTA = Quota()
"""Quota of a sender whom nothing limits."""


class QuotaStore(DatabaseStore):
    """Reserves quota for uploads; checks and reservations hold the database's write lock.

    Parameters
    ----------
    database
        Where the rows are.

    """

    def usage(self, owner: str, *, deleted: bool = True) -> Usage:
        """Return the present usage of an owner, with or without deleted clips and languages."""
        with self._database.reading() as session:
            return usage_of(session, owner, deleted=deleted)

    def reserve(self, upload: Upload, quota: Quota) -> None:
        """Reserve quota for a new upload; if it is exceeded, nothing is reserved.

        Raises
        ------
        QuotaExceeded
            As `Quota.require`.

        """
        with self._database.writing(counted=False) as session:
            over = moment_of(session) - KEPT
            session.execute(delete(UploadReservation).where(col(UploadReservation.touched) < over))
            quota.require_in(session, upload.room, clips=1)
            session.add(_reservation(upload, session))

    def renew(self, upload: Upload) -> None:
        """Renew the reservation of an upload; without new bytes it expires after `KEPT`."""
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


def usage_of(
    session: Session, owner: str, *, without: str | None = None, deleted: bool = True
) -> Usage:
    """Return the usage of an owner.

    Parameters
    ----------
    session
        Open session.
    owner
        Name of the owner.
    without
        Id of an upload that does not count.
    deleted
        Whether deleted clips and languages count, which still take place on the disk. A language in
        which others made revisions too counts in any case: it is not purged for one of them.

    """
    kept = select(func.count(), _sum(Clip.size)).where(Clip.owner == owner)
    documents = select(_sum(LanguageRevision.size)).where(LanguageRevision.owner == owner)
    if not deleted:
        kept = kept.where(col(Clip.deleted).is_(None))
        other = aliased(LanguageRevision)
        shared = exists().where(
            col(other.language_id) == LanguageRevision.language_id, col(other.owner) != owner
        )
        kept_record = or_(col(LanguageRecord.deleted).is_(None), shared)
        documents = documents.join(LanguageRecord).where(kept_record)
    results = select(_sum(RecognitionRecord.size)).where(RecognitionRecord.owner == owner)
    reserved = select(func.count(), _sum(UploadReservation.size)).where(
        UploadReservation.owner == owner,
        col(UploadReservation.id) != (without or ""),
        col(UploadReservation.touched) >= moment_of(session) - KEPT,
    )
    clips, size = session.exec(kept).one()
    uploads, coming = session.exec(reserved).one()
    texts = int(session.exec(documents).one()) + int(session.exec(results).one())
    return Usage(int(clips) + int(uploads), int(size) + int(coming) + texts)


def release_in(session: Session, upload_id: str) -> None:
    """Release the reservation of an upload, in the transaction that makes a clip of it."""
    session.execute(delete(UploadReservation).where(col(UploadReservation.id) == upload_id))


def _reservation(upload: Upload, session: Session) -> UploadReservation:
    return UploadReservation(
        id=upload.id, owner=upload.owner, size=upload.room, touched=moment_of(session)
    )


def _sum(column: int) -> Function[int]:
    return func.coalesce(func.sum(column), 0)


def _megabytes(size: int) -> str:
    return f"{size / 1e6:.1f} MB"
