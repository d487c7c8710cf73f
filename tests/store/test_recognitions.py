"""Recognitions: kept as answered, hidden with what they are about."""

import pytest

from app.store import ClipStore, Database, LanguageStore, NotFound, RecognitionRecord
from app.store.takes import RecognitionStore
from tests.store.conftest import add_clip
from tests.store.test_languages import draft


@pytest.fixture
def recognitions(database: Database) -> RecognitionStore:
    return RecognitionStore(database)


def record(clip_id: str, language_id: str) -> RecognitionRecord:
    return RecognitionRecord(
        clip_id=clip_id,
        language_id=language_id,
        revision=1,
        start=0.5,
        end=2.5,
        profile="paper",
        result='{"label": "circle"}',
    )


def test_recognitions_are_listed_newest_first_and_by_what_they_are_about(
    recognitions: RecognitionStore, clips: ClipStore, languages: LanguageStore
) -> None:
    clip, other = add_clip(clips).clip.id, add_clip(clips).clip.id
    language = languages.create(draft()).record.id
    first = recognitions.add(record(clip, language))
    second = recognitions.add(record(other, language))
    assert [kept.id for kept in recognitions.all(limit=9)] == [second.id, first.id]
    assert [kept.id for kept in recognitions.all(limit=1)] == [second.id]
    assert [kept.id for kept in recognitions.all(clip_id=clip, limit=9)] == [first.id]
    assert recognitions.all(language_id="none", limit=9) == []


def test_a_recognition_hides_and_comes_back_with_its_clip_and_language(
    recognitions: RecognitionStore, clips: ClipStore, languages: LanguageStore
) -> None:
    clip, language = add_clip(clips).clip.id, languages.create(draft()).record.id
    kept = recognitions.add(record(clip, language))
    clips.delete(clip)
    with pytest.raises(NotFound):
        recognitions.get(kept.id)
    clips.restore(clip)
    assert recognitions.get(kept.id).result == kept.result
    languages.delete(language)
    with pytest.raises(NotFound):
        recognitions.get(kept.id)
