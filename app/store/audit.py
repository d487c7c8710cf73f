"""Audit log: who changed what, and when.

An entry is on the disk when `AuditStore.add` returns. While the database takes no entries, they are
kept in a journal in the data folder, which is moved to the database when it answers again.
"""

from __future__ import annotations

import json
import logging
import os
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path

from filelock import FileLock
from sqlalchemy.exc import SQLAlchemyError
from sqlmodel import col, select

from app.recognition.text.atomic_files import sync_directory
from app.store.database import Database, DatabaseStore, StoreError, StoreUnavailable
from app.store.models import AuditEntry

MOST_LISTED = 1000
"""Most entries returned at once."""

JOURNAL = "audit.jsonl"
"""Name of the journal in the data folder, which one server and its command line use."""

logger = logging.getLogger(__name__)


class AuditStore(DatabaseStore):
    """Keeps the entries; none is ever changed or removed.

    Parameters
    ----------
    database
        Database of the entries.
    folder
        Data folder, for the journal.

    """

    def __init__(self, database: Database, folder: Path) -> None:
        super().__init__(database)
        self._journal = folder / JOURNAL
        self._lock = FileLock(folder / f"{JOURNAL}.lock", mode=0o600)

    def add(self, entry: AuditEntry) -> None:
        """Write an entry, durably; to the journal if the database does not take it.

        Raises
        ------
        StoreUnavailable
            When neither can be written to.

        """
        # The fields, because a row that could not be stored belongs to its broken session.
        fields = entry.model_dump(mode="json", exclude={"id"})
        file = self._database.file
        if file is not None and not file.exists():
            # Not made here: the first start makes it, or a backup is restored.
            return self._append(fields)
        try:
            self.import_journal()
            with self._database.writing() as session:
                session.add(entry)
        except (StoreError, SQLAlchemyError, OSError):
            logger.warning("the database takes no audit entry; it goes to %s", self._journal)
            self._append(fields)

    def import_journal(self) -> None:
        """Move the journal's entries to the database, each once, in their order.

        Raises
        ------
        StoreUnavailable
            When the database does not answer.
        OSError
            When the journal cannot be read or removed.

        """
        if not self._journal.exists():
            return
        with self._lock:
            entries = self._read()
            with self._database.writing() as session:
                for entry in entries:
                    # A crash may have come between the commit and the removal.
                    known = select(AuditEntry.id).where(
                        AuditEntry.time == entry.time,
                        AuditEntry.name == entry.name,
                        AuditEntry.method == entry.method,
                        AuditEntry.path == entry.path,
                        AuditEntry.request_id == entry.request_id,
                    )
                    if session.exec(known).first() is None:
                        session.add(entry)
            self._journal.unlink(missing_ok=True)
            sync_directory(self._journal.parent)

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
        self.import_journal()
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

    def _read(self) -> list[AuditEntry]:
        """Return the entries of the journal.

        A line that a power cut broke off was acknowledged to nobody.
        """
        entries = []
        content = self._journal.read_bytes() if self._journal.exists() else b""
        for line in filter(None, content.split(b"\n")):
            try:
                fields = json.loads(line)
                time = datetime.fromisoformat(fields.pop("time"))
                entries.append(AuditEntry(time=time, **fields))
            except (ValueError, KeyError, TypeError, AttributeError):
                logger.exception("a broken line in %s is no audit entry", self._journal)
        return entries

    def _append(self, fields: dict[str, object]) -> None:
        line = json.dumps(fields).encode()
        try:
            self._journal.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
            with self._lock:
                flags = os.O_WRONLY | os.O_CREAT | os.O_APPEND
                with os.fdopen(os.open(self._journal, flags, 0o600), "ab") as file:
                    # A line that broke off must not take this one with it.
                    file.write(b"\n" + line + b"\n")
                    file.flush()
                    os.fsync(file.fileno())
                sync_directory(self._journal.parent)
        except OSError as error:
            raise StoreUnavailable(
                "the audit log cannot be written to, neither in the database nor in the data "
                f"folder ({error.strerror}); free space, then try again"
            ) from error
