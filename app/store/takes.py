"""Store of takes: how they were recognised, and those of test sets and practice with results."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

from sqlmodel import Session, col, delete, select, update

from app.store.database import DatabaseStore, NotFound, StoreError
from app.store.models import (
    Clip,
    LabelledResult,
    LabelledTake,
    LanguageRecord,
    PracticeTake,
    RecognitionRecord,
)
from app.store.quotas import NO_QUOTA, Quota

_VISIBLE = (col(Clip.deleted).is_(None), col(LanguageRecord.deleted).is_(None))

MOST_TAKES = 500
"""Most takes of a language's test set: more would delay every change of the language by minutes."""

MOST_PRACTISED = 5000
"""Number of a language's newest takes of practice that are counted: an acceptance test of a hundred
divers."""

KEPT_RESULTS = 3
"""Number of newest results kept for a take: the current, the previous, and one for an undo."""


class TestSetFull(StoreError):
    """Raised when a test set would have more than `MOST_TAKES` takes."""

    __test__ = False


@dataclass(frozen=True)
class TestedTake:
    """A take of a test set with its results, the newest revision first.

    Attributes
    ----------
    take
        The take.
    clip
        Name of its clip.
    results
        At most `KEPT_RESULTS` results.

    """

    __test__ = False

    take: LabelledTake
    clip: str
    results: tuple[LabelledResult, ...]


Known = TypeVar("Known", LabelledTake, PracticeTake)


class TakeStore(DatabaseStore):
    """Keeps the test sets and the practice of languages in `database`.

    Takes are removed with their purged clips; in test sets, those of deleted clips are hidden.
    """

    def add(self, takes: Sequence[LabelledTake]) -> list[LabelledTake]:
        """Add takes of one language; a take that exists already gets the new label.

        Raises
        ------
        TestSetFull
            When the test set would have too many takes.

        """
        with self._database.writing() as session:
            kept = [_put(session, take) for take in takes]
            for language_id in {take.language_id for take in takes}:
                query = select(LabelledTake.id).where(LabelledTake.language_id == language_id)
                if len(session.exec(query).all()) > MOST_TAKES:
                    raise TestSetFull(
                        f"a test set has at most {MOST_TAKES} takes; remove some first"
                    )
        return kept

    def label(self, language_id: str, take_id: str, expected: str) -> None:
        """Give a take another label, and remove its results, which are for the previous label.

        A take that was set aside counts again.

        Raises
        ------
        NotFound
            When the language's test set has no such take.

        """
        with self._database.writing() as session:
            take = _load(session, LabelledTake, language_id, take_id)
            take.former = None
            if take.expected != expected:
                take.expected = expected
                _forget(session, take_id)

    def set_aside(self, language_id: str, label: str, former: Sequence[str]) -> None:
        """Set the takes of a gesture aside that show its former movement, by these digests."""
        with self._database.writing() as session:
            session.execute(
                update(LabelledTake)
                .where(
                    col(LabelledTake.language_id) == language_id,
                    col(LabelledTake.expected) == label,
                    col(LabelledTake.former).is_(None),
                )
                .values(former=[*former])
            )

    def remove(self, kind: type[Known], language_id: str, take_id: str) -> None:
        """Remove a take of this kind and its results.

        Raises
        ------
        NotFound
            When the language has no such take.

        """
        with self._database.writing() as session:
            take = _load(session, kind, language_id, take_id)
            _forget(session, take_id)
            session.delete(take)

    def tested(self, language_id: str) -> list[TestedTake]:
        """Return the takes of a language's test set, by clip and time."""
        with self._database.reading() as session:
            rows = session.exec(
                select(LabelledTake, Clip.name)
                .join(Clip)
                .where(LabelledTake.language_id == language_id, col(Clip.deleted).is_(None))
                .order_by(Clip.name, LabelledTake.clip_id, col(LabelledTake.start))
            ).all()
            found = session.exec(
                select(LabelledResult)
                .join(LabelledTake)
                .where(LabelledTake.language_id == language_id)
                .order_by(col(LabelledResult.revision).desc())
            ).all()
        results: dict[str, list[LabelledResult]] = defaultdict(list)
        for result in found:
            results[result.take_id].append(result)
        return [TestedTake(take, name, tuple(results[take.id])) for take, name in rows]

    def practised(self, language_id: str) -> list[PracticeTake]:
        """Return the takes of a language's practice, the newest first."""
        with self._database.reading() as session:
            query = (
                select(PracticeTake)
                .where(PracticeTake.language_id == language_id)
                .order_by(col(PracticeTake.created).desc())
                .limit(MOST_PRACTISED)
            )
            return list(session.exec(query))

    def known(self, language_id: str) -> list[LabelledTake | PracticeTake]:
        """Return the takes of test set and practice, the oldest first, each range once."""
        tested = [each.take for each in self.tested(language_id)]
        takes: list[LabelledTake | PracticeTake] = [*tested, *self.practised(language_id)]
        once = {(each.clip_id, round(each.start, 2)): each for each in takes}
        return sorted(once.values(), key=lambda each: each.created)

    def practise(self, take: PracticeTake) -> None:
        """Store a take of practice; it replaces the same take recognised by the same revision."""
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

    def keep(self, result: LabelledResult, expected: str) -> bool:
        """Store a result and remove old ones, or the result's recognition if it is not wanted.

        Return False if the take is removed or has another label.
        """
        with self._database.writing() as session:
            take = session.get(LabelledTake, result.take_id)
            if take is None or take.expected != expected:
                _drop_recognition(session, result)
                return False
            former = session.get(LabelledResult, (result.take_id, result.revision))
            if former is not None and former.recognition_id != result.recognition_id:
                _drop_recognition(session, former)
            session.merge(result)
            old = session.exec(
                select(LabelledResult)
                .where(LabelledResult.take_id == result.take_id)
                .order_by(col(LabelledResult.revision).desc())
                .offset(KEPT_RESULTS)
            ).all()
            for each in old:
                _drop(session, each)
        return True


def _put(session: Session, take: LabelledTake) -> LabelledTake:
    """Add a take, or relabel the existing take of the same range."""
    there = session.exec(
        select(LabelledTake).where(
            LabelledTake.language_id == take.language_id,
            LabelledTake.clip_id == take.clip_id,
            LabelledTake.start == take.start,
        )
    ).first()
    if there is None:
        session.add(take)
        return take
    if there.expected != take.expected or there.end != take.end:
        _forget(session, there.id)
    there.expected, there.end = take.expected, take.end
    return there


def _load(session: Session, kind: type[Known], language_id: str, take_id: str) -> Known:
    take = session.get(kind, take_id)
    if take is None or take.language_id != language_id:
        raise NotFound(f"this language has no take {take_id!r}")
    return take


def _forget(session: Session, take_id: str) -> None:
    for result in session.exec(select(LabelledResult).where(LabelledResult.take_id == take_id)):
        _drop(session, result)


def _drop(session: Session, result: LabelledResult) -> None:
    """Remove a result with its recognition."""
    session.delete(result)
    _drop_recognition(session, result)


def _drop_recognition(session: Session, result: LabelledResult) -> None:
    if result.recognition_id is not None:
        session.execute(
            delete(RecognitionRecord).where(col(RecognitionRecord.id) == result.recognition_id)
        )


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
