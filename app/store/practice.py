"""Store of practice: what divers were asked to show, and how it was recognised."""

from __future__ import annotations

from sqlmodel import col, delete, select

from app.store.database import DatabaseStore, NotFound
from app.store.models import PracticeTake

MOST_PRACTISED = 5000
"""Number of a language's newest takes that are counted: an acceptance test of a hundred divers."""


class PracticeStore(DatabaseStore):
    """Keeps practice takes in `database`; they are removed with the purged clips."""

    def keep(self, take: PracticeTake) -> PracticeTake:
        """Store a take; it replaces the same take recognised by the same revision."""
        with self._database.writing() as session:
            session.exec(
                delete(PracticeTake).where(
                    col(PracticeTake.language_id) == take.language_id,
                    col(PracticeTake.revision) == take.revision,
                    col(PracticeTake.clip_id) == take.clip_id,
                    col(PracticeTake.start) == take.start,
                )
            )
            session.add(take)
        return take

    def remove(self, language_id: str, take_id: str) -> None:
        """Remove a take.

        Raises
        ------
        NotFound
            When the language has no such take.

        """
        with self._database.writing() as session:
            take = session.get(PracticeTake, take_id)
            if take is None or take.language_id != language_id:
                raise NotFound(f"there is no practice take {take_id!r} of this language")
            session.delete(take)

    def of(self, language_id: str) -> list[PracticeTake]:
        """Return the takes of a language, the newest first."""
        with self._database.reading() as session:
            query = (
                select(PracticeTake)
                .where(PracticeTake.language_id == language_id)
                .order_by(col(PracticeTake.created).desc())
                .limit(MOST_PRACTISED)
            )
            return list(session.exec(query))
