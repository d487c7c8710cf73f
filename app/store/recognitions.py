"""Recognition store: results of recognitions, saved unchanged."""

from __future__ import annotations

from sqlmodel import col, select

from app.store.database import DatabaseStore, NotFound
from app.store.models import Clip, LanguageRecord, RecognitionRecord
from app.store.quotas import NO_QUOTA, Quota

_VISIBLE = (col(Clip.deleted).is_(None), col(LanguageRecord.deleted).is_(None))


class RecognitionStore(DatabaseStore):
    """Keeps recognitions in `database`; those of deleted clips and languages are hidden."""

    def add(self, record: RecognitionRecord, quota: Quota = NO_QUOTA) -> RecognitionRecord:
        """Store `record` for the owner of a quota.

        Raises
        ------
        QuotaExceeded
            When the owner may not keep as much.

        """
        record.owner, record.size = quota.owner, len(record.result.encode())
        with self._database.writing() as session:
            quota.require_in(session, record.size)
            session.add(record)
        return record

    def get(self, recognition_id: str) -> RecognitionRecord:
        """Return a recognition.

        Raises
        ------
        NotFound
            When there is none.

        """
        with self._database.reading() as session:
            query = select(RecognitionRecord).join(Clip).join(LanguageRecord)
            query = query.where(RecognitionRecord.id == recognition_id, *_VISIBLE)
            if (record := session.exec(query).first()) is None:
                raise NotFound(f"there is no recognition {recognition_id!r}")
            return record

    def all(
        self, *, clip_id: str | None = None, language_id: str | None = None, limit: int
    ) -> list[RecognitionRecord]:
        """Return the newest `limit` recognitions of a clip, of a language, or of all."""
        with self._database.reading() as session:
            query = select(RecognitionRecord).join(Clip).join(LanguageRecord).where(*_VISIBLE)
            if clip_id is not None:
                query = query.where(RecognitionRecord.clip_id == clip_id)
            if language_id is not None:
                query = query.where(RecognitionRecord.language_id == language_id)
            query = query.order_by(col(RecognitionRecord.created).desc()).limit(limit)
            return list(session.exec(query))
