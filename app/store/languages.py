"""Language store: immutable revisions, the newest of which is the head."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from datetime import datetime

from sqlalchemy.orm import defer
from sqlmodel import Session, col, delete, func, select

from app.store.database import Conflict, DatabaseStore, NotFound, StoreUnavailable
from app.store.models import (
    Clip,
    DemonstrationSource,
    LanguageRecord,
    LanguageRevision,
    SeededSample,
    now,
)
from app.store.quotas import NO_QUOTA, Quota, Usage

MOST_RACES = 20
"""Attempts at an edit without a given revision before it is refused, each lost to another edit."""

_WITHOUT_DOCUMENT = defer(LanguageRevision.document, raiseload=True)  # type: ignore[arg-type]
"""Leaves out the documents: hundreds of kilobytes each, which no list shows."""


@dataclass(frozen=True, kw_only=True)
class Draft:
    """Content of a new revision that is not stored yet."""

    name: str
    labels: Sequence[str]
    change: str
    document: str
    author: str = ""

    @property
    def size(self) -> int:
        """Bytes of the document."""
        return len(self.document.encode())


@dataclass(frozen=True)
class LanguageState:
    """A language and one of its revisions."""

    record: LanguageRecord
    revision: LanguageRevision


class LanguageStore(DatabaseStore):
    """Keeps languages in `database`; documents are opaque text here."""

    def create(
        self,
        draft: Draft,
        revision: int = 1,
        *,
        sample: str | None = None,
        quota: Quota = NO_QUOTA,
    ) -> LanguageState:
        """Add a language with `draft` as its first revision, numbered `revision`.

        Parameters
        ----------
        draft
            Content of the revision.
        revision
            The revision number in its document.
        sample
            Name of the sample that it is; a sample is added automatically only once.
        quota
            Quota of its owner.

        Raises
        ------
        QuotaExceeded
            When the owner may not keep as much.

        """
        with self._database.writing() as session:
            quota.require_in(session, draft.size)
            record = LanguageRecord(head=revision, sample=sample is not None)
            session.add(record)
            session.flush()
            row = _row(record.id, revision, draft, quota.owner)
            session.add(row)
            if sample is not None:
                session.merge(SeededSample(name=sample))
        return LanguageState(record, row)

    def seeded(self) -> set[str]:
        """Return the names of the samples that were added before, deleted or not."""
        with self._database.reading() as session:
            return set(session.exec(select(SeededSample.name)).all())

    def get(self, language_id: str, revision: int | None = None) -> LanguageState:
        """Return a language that is not deleted, in its newest or the given revision.

        Raises
        ------
        NotFound
            When there is no such language or revision.

        """
        with self._database.reading() as session:
            return _load(session, language_id, revision)

    def all(self) -> list[LanguageState]:
        """Return the languages that are not deleted in their newest revisions, oldest first.

        Their documents are not read; `get` reads one.
        """
        with self._database.reading() as session:
            query = (
                select(LanguageRecord, LanguageRevision)
                .join(LanguageRevision)
                .options(_WITHOUT_DOCUMENT)
                .where(
                    col(LanguageRecord.deleted).is_(None),
                    LanguageRevision.revision == LanguageRecord.head,
                )
                .order_by(col(LanguageRecord.created), col(LanguageRecord.id))
            )
            return [LanguageState(record, row) for record, row in session.exec(query)]

    def revisions(self, language_id: str) -> list[LanguageRevision]:
        """Return every revision, newest first, without the documents; `get` reads one.

        Raises
        ------
        NotFound
            When there is no such language.

        """
        with self._database.reading() as session:
            _load(session, language_id, None)
            query = (
                select(LanguageRevision)
                .where(LanguageRevision.language_id == language_id)
                .options(_WITHOUT_DOCUMENT)
                .order_by(col(LanguageRevision.revision).desc())
            )
            # Otherwise the session would return the revision that the check read with its document.
            session.expunge_all()
            return list(session.exec(query))

    def edit(
        self,
        language_id: str,
        change: Callable[[LanguageRevision, int], Draft],
        expected: int | None = None,
        quota: Quota = NO_QUOTA,
    ) -> LanguageState:
        """Add a revision made from the newest one.

        The change is made outside the write lock, because that of a large language takes seconds,
        and is made again if another edit came first, so that no edit is lost.

        Parameters
        ----------
        language_id
            Which one.
        change
            Makes the draft from the newest revision and the number that the draft will get.
        expected
            The revision the caller saw; ``None`` accepts any.
        quota
            Quota of the revision's owner.

        Raises
        ------
        NotFound
            When there is no such language.
        Conflict
            When the newest revision is not the `expected` one.
        QuotaExceeded
            When the owner may not keep as much; revisions are never thinned out.
        StoreUnavailable
            When others edit the language again and again.

        """
        for _ in range(MOST_RACES):
            state = self.get(language_id)
            head = state.record.head
            _require_head(head, expected)
            draft = change(state.revision, head + 1)
            with self._database.writing() as session:
                record = _load(session, language_id, None, changing=True).record
                _require_head(record.head, expected)
                if record.head != head:
                    continue
                quota.require_in(session, draft.size)
                row = _row(language_id, head + 1, draft, quota.owner)
                session.add(row)
                record.head = head + 1
            return LanguageState(record, row)
        raise StoreUnavailable(
            "others are changing this language now; nothing was changed, try again"
        )

    def delete(self, language_id: str, expected: int | None = None) -> None:
        """Hide a language until `purge`.

        Raises
        ------
        NotFound
            When there is no such language.
        Conflict
            When the newest revision is not the `expected` one.

        """
        with self._database.writing() as session:
            record = _load(session, language_id, None, changing=True).record
            if expected is not None and expected != record.head:
                raise Conflict(
                    f"the language is at revision {record.head}, not {expected}; look at what "
                    "changed before deleting it",
                    current=record.head,
                )
            record.deleted = now()

    def restore(self, language_id: str) -> LanguageState:
        """Bring a deleted language back; nothing happens to one that is not deleted.

        Raises
        ------
        NotFound
            When it never existed or is purged.

        """
        with self._database.writing() as session:
            record = session.get(LanguageRecord, language_id)
            if record is None:
                raise NotFound(f"there is no language {language_id!r} to restore")
            record.deleted = None
            return _load(session, language_id, None)

    def purge(self, before: datetime) -> int:
        """Remove for good the languages deleted before a given time; return their number."""
        with self._database.writing() as session:
            over = col(LanguageRecord.deleted) < before
            return session.exec(delete(LanguageRecord).where(over)).rowcount

    def purge_for(self, owner: str, excess: Usage) -> Usage:
        """Purge the languages that an owner alone wrote and deleted first; see `ClipStore`."""
        with self._database.writing() as session:
            revisions = (
                select(col(LanguageRevision.language_id), func.sum(LanguageRevision.size))
                .join(LanguageRecord)
                .where(col(LanguageRecord.deleted).is_not(None))
                .group_by(col(LanguageRevision.language_id), col(LanguageRecord.deleted))
                .having(func.min(LanguageRevision.owner) == owner)
                .having(func.max(LanguageRevision.owner) == owner)
                .order_by(col(LanguageRecord.deleted))
            )
            for language_id, size in session.exec(revisions).all():
                if not excess.bytes:
                    break
                excess = Usage(excess.clips, max(0, excess.bytes - size))
                session.delete(session.get_one(LanguageRecord, language_id))
        return excess


def _require_head(head: int, expected: int | None) -> None:
    if expected is not None and expected != head:
        raise Conflict(
            f"the language is at revision {head} and the change was made from revision "
            f"{expected}; load it again and repeat the change",
            current=head,
        )


def _row(language_id: str, revision: int, draft: Draft, owner: str) -> LanguageRevision:
    content = vars(draft) | {"labels": [*draft.labels], "owner": owner, "size": draft.size}
    return LanguageRevision(language_id=language_id, revision=revision, **content)


def _load(
    session: Session, language_id: str, revision: int | None, *, changing: bool = False
) -> LanguageState:
    # SQLite's writers lock the whole file; other databases lock the row.
    record = session.get(LanguageRecord, language_id, with_for_update=changing)
    if record is None or record.deleted is not None:
        raise NotFound(f"there is no language {language_id!r}")
    number = record.head if revision is None else revision
    row = session.get(LanguageRevision, (language_id, number))
    if row is None:
        raise NotFound(f"language {language_id!r} has no revision {number}")
    return LanguageState(record, row)


class SourceStore(DatabaseStore):
    """Keeps the sources of demonstrations in `database`.

    A source is stored by demonstration and not by language, revision or label, so it stays known
    after a rename or revert, in a copy, and in an exported file that is imported again.
    """

    def keep(self, source: DemonstrationSource) -> None:
        """Store the source of a demonstration, in place of an earlier one."""
        with self._database.writing() as session:
            session.merge(source)

    def of(self, trajectories: Collection[str]) -> dict[str, DemonstrationSource]:
        """Return the known sources of demonstrations, without those whose clip is deleted."""
        with self._database.reading() as session:
            query = select(DemonstrationSource).join(Clip)
            query = query.where(
                col(DemonstrationSource.trajectory).in_(trajectories), col(Clip.deleted).is_(None)
            )
            return {source.trajectory: source for source in session.exec(query)}
