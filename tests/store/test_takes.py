"""Takes of test sets and of practice: their labels, results, and those of older versions."""

from datetime import timedelta
from pathlib import Path

import pytest
from alembic import command
from alembic.config import Config

from app.store import (
    ClipStore,
    Database,
    LabelledResult,
    LabelledTake,
    LanguageStore,
    NotFound,
    PracticeTake,
    RecognitionRecord,
    RecognitionStore,
    TakeStore,
    TestSetFull,
)
from app.store.database import MIGRATIONS
from app.store.takes import KEPT_RESULTS
from tests.store.conftest import add_clip
from tests.store.test_languages import draft


@pytest.fixture
def store(database: Database) -> TakeStore:
    return TakeStore(database)


@pytest.fixture
def take(clips: ClipStore, languages: LanguageStore) -> LabelledTake:
    clip, language = add_clip(clips).clip.id, languages.create(draft()).record.id
    return LabelledTake(language_id=language, clip_id=clip, start=0.5, end=2.5, expected="circle")


def again(take: LabelledTake, **changes: object) -> LabelledTake:
    """Return a further draft of the same range."""
    return LabelledTake(**(take.model_dump(exclude={"id", "created"}) | changes))


def recognition_of(take: LabelledTake, revision: int = 1) -> RecognitionRecord:
    """Return a recognition of a take that is not stored yet."""
    return RecognitionRecord(
        clip_id=take.clip_id,
        language_id=take.language_id,
        revision=revision,
        start=0.5,
        end=2.5,
        profile="full",
        expected="circle",
        result="{}",
    )


def test_a_range_is_in_the_set_once_with_its_newest_label(
    store: TakeStore, take: LabelledTake
) -> None:
    (kept,) = store.add([take])
    store.keep(LabelledResult(take_id=kept.id, revision=1, label="circle"), "circle")
    (relabelled,) = store.add([again(take, expected="line")])
    (tested,) = store.tested(take.language_id)
    assert relabelled.id == kept.id == tested.take.id
    assert (tested.clip, tested.take.expected, tested.results) == ("dive.mp4", "line", ())


def test_results_are_kept_newest_first_and_only_the_newest(
    store: TakeStore, database: Database, take: LabelledTake
) -> None:
    (kept,) = store.add([take])
    recognitions = RecognitionStore(database)
    for revision in range(1, KEPT_RESULTS + 3):
        record = recognitions.add(recognition_of(take, revision))
        result = LabelledResult(take_id=kept.id, revision=revision, recognition_id=record.id)
        assert store.keep(result, "circle")
    (tested,) = store.tested(take.language_id)
    newest = [result.revision for result in tested.results]
    assert newest == [KEPT_RESULTS + 2, KEPT_RESULTS + 1, KEPT_RESULTS]
    assert len(recognitions.all(language_id=take.language_id, limit=99)) == KEPT_RESULTS


def test_a_result_for_another_label_is_not_kept(store: TakeStore, take: LabelledTake) -> None:
    (kept,) = store.add([take])
    store.label(take.language_id, kept.id, "line")
    assert not store.keep(LabelledResult(take_id=kept.id, revision=1), "circle")
    store.remove(LabelledTake, take.language_id, kept.id)
    assert not store.keep(LabelledResult(take_id=kept.id, revision=1), "line")
    assert store.tested(take.language_id) == []


def test_a_recognition_stays_only_with_its_result(
    store: TakeStore, database: Database, take: LabelledTake
) -> None:
    (kept,) = store.add([take])
    recognitions = RecognitionStore(database)
    first, second, unwanted = (recognitions.add(recognition_of(take)).id for _ in range(3))
    for recognition in (first, second):
        result = LabelledResult(take_id=kept.id, revision=1, recognition_id=recognition)
        assert store.keep(result, "circle")
    result = LabelledResult(take_id=kept.id, revision=1, recognition_id=unwanted)
    assert not store.keep(result, "line")
    assert [each.id for each in recognitions.all(language_id=take.language_id, limit=9)] == [second]


def test_a_take_of_another_language_is_not_found(
    store: TakeStore, languages: LanguageStore, take: LabelledTake
) -> None:
    (kept,) = store.add([take])
    other = languages.create(draft()).record.id
    with pytest.raises(NotFound):
        store.label(other, kept.id, "line")
    with pytest.raises(NotFound):
        store.remove(LabelledTake, other, kept.id)


def test_known_takes_come_in_the_order_of_their_making_and_each_range_once(
    store: TakeStore, take: LabelledTake
) -> None:
    def practise(start: float, days: int) -> PracticeTake:
        made = PracticeTake(
            language_id=take.language_id,
            clip_id=take.clip_id,
            start=start,
            diver="Ana",
            expected="circle",
            revision=1,
            recognition_id="0" * 32,
            created=take.created + timedelta(days=days),
        )
        store.practise(made)
        return made

    store.add([take, again(take, start=3.0)])
    old, new, same = practise(4.0, -1), practise(5.0, 2), practise(3.0, 1)
    known = [each.id for each in store.known(take.language_id)]
    assert known == [old.id, take.id, same.id, new.id]


def test_takes_of_deleted_clips_are_hidden_and_come_back(
    store: TakeStore, clips: ClipStore, take: LabelledTake
) -> None:
    store.add([take])
    clips.delete(take.clip_id)
    assert store.tested(take.language_id) == []
    clips.restore(take.clip_id)
    assert len(store.tested(take.language_id)) == 1


def test_a_set_that_is_full_takes_none_of_the_new_ones(
    store: TakeStore, take: LabelledTake, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.store.takes.MOST_TAKES", 2)
    store.add([take])
    with pytest.raises(TestSetFull, match="at most 2"):
        store.add([again(take, start=3.0), again(take, start=4.0)])
    assert len(store.tested(take.language_id)) == 1


def test_the_recognitions_that_were_the_test_become_the_test_set(tmp_path: Path) -> None:
    database = Database(f"sqlite:///{tmp_path / 'studio.db'}")
    config = Config()
    config.set_main_option("script_location", str(MIGRATIONS))
    moment = "2026-01-01 00:00:0"
    with database.engine.begin() as connection:
        config.attributes["connection"] = connection
        command.upgrade(config, "0005")
        connection.exec_driver_sql(
            "INSERT INTO clip (id, name, media_type, size, width, height, topics, created) "
            f"VALUES ('c', 'dive', 'video/mp4', 1, 64, 48, '[]', '{moment}0')"
        )
        connection.exec_driver_sql(
            "INSERT INTO language (id, head, sample, created) VALUES ('l', 1, 0, ?)",
            (f"{moment}0",),
        )
        rows = [
            ("old", 1.0, "circle", "{}", 1),
            ("new", 1.0, "line", "{}", 2),
            ("on trial", 1.0, "wave", '{"trial": {}}', 3),
            ("left out", 5.0, None, "{}", 4),
            ("before it", 5.0, "circle", "{}", 3),
        ]
        for name, start, expected, result, second in rows:
            connection.exec_driver_sql(
                "INSERT INTO recognition VALUES (?, 'c', 'l', 1, ?, 2.0, 'full', ?, ?, ?)",
                (name, start, expected, result, f"{moment}{second}"),
            )
        command.upgrade(config, "0011")
        found = connection.exec_driver_sql("SELECT start, expected FROM labelled_take").all()
    assert [tuple(row) for row in found] == [(1.0, "line")]
