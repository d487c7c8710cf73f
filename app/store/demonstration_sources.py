"""Store of provenance: the clip and range of each demonstration."""

from __future__ import annotations

from collections.abc import Collection

from sqlmodel import col, select

from app.store.database import Database
from app.store.models import Clip, DemonstrationSource


class SourceStore:
    """Keeps the sources of demonstrations in `database`.

    A source is stored by demonstration and not by language, revision or label, so it stays known
    after a rename or revert, in a copy, and in an exported file that is imported again.
    """

    def __init__(self, database: Database) -> None:
        self._database = database

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
