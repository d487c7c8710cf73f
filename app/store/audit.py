"""Audit log: who changed what, and when."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime

from sqlmodel import col, select

from app.store.database import Database
from app.store.models import AuditEntry

MOST_LISTED = 1000
"""Most entries returned at once."""


class AuditStore:
    """Keeps the entries; none is ever changed or removed.

    Parameters
    ----------
    database
        Database of the entries.

    """

    def __init__(self, database: Database) -> None:
        self._database = database

    def add(self, entry: AuditEntry) -> None:
        """Write an entry."""
        with self._database.writing() as session:
            session.add(entry)

    def newest(
        self,
        limit: int = 100,
        *,
        before: int | None = None,
        name: str | None = None,
        since: datetime | None = None,
        until: datetime | None = None,
    ) -> Sequence[AuditEntry]:
        """Return entries, the newest first.

        Parameters
        ----------
        limit
            Most entries, at most `MOST_LISTED`.
        before
            Only entries with a smaller id: the next page.
        name
            Only entries of this name.
        since, until
            Only entries from `since` on, and before `until`.

        """
        query = select(AuditEntry).order_by(col(AuditEntry.id).desc())
        if before is not None:
            query = query.where(col(AuditEntry.id) < before)
        if name is not None:
            query = query.where(AuditEntry.name == name)
        if since is not None:
            query = query.where(col(AuditEntry.time) >= since)
        if until is not None:
            query = query.where(col(AuditEntry.time) < until)
        with self._database.reading() as session:
            return session.exec(query.limit(min(limit, MOST_LISTED))).all()
