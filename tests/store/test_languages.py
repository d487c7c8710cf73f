"""Languages: revisions are written once, and no edit gets lost."""

import threading
from collections.abc import Callable

import pytest

from app.store import Conflict, Draft, LanguageRevision, LanguageStore, NotFound
from app.store.models import now


def draft(document: str = "{}", change: str = "made", name: str = "pool") -> Draft:
    return Draft(name=name, labels=["circle"], change=change, document=document)


def appending(letter: str) -> Callable[[LanguageRevision, int], Draft]:
    return lambda head, _number: draft(head.document + letter)


def test_every_edit_is_a_revision_and_the_older_ones_stay(languages: LanguageStore) -> None:
    language_id = languages.create(draft("a")).record.id
    languages.edit(language_id, appending("b"))
    languages.edit(language_id, appending("c"))
    assert [row.revision for row in languages.revisions(language_id)] == [3, 2, 1]
    assert languages.get(language_id).revision.document == "abc"
    assert languages.get(language_id, 2).revision.document == "ab"
    assert languages.get(language_id, 1).revision.document == "a"


def test_lists_leave_the_documents_where_they_are(languages: LanguageStore) -> None:
    language_id = languages.create(draft("a")).record.id
    (listed,) = languages.all()
    for row in (listed.revision, *languages.revisions(language_id)):
        assert "document" not in vars(row)


def test_numbering_goes_on_from_the_files_own(languages: LanguageStore) -> None:
    language_id = languages.create(draft("a"), revision=7).record.id
    numbers = []

    def edit(_head: LanguageRevision, number: int) -> Draft:
        numbers.append(number)
        return draft("b")

    assert languages.edit(language_id, edit).revision.revision == 8
    assert numbers == [8]


def test_an_edit_from_an_older_revision_is_refused(languages: LanguageStore) -> None:
    language_id = languages.create(draft("a")).record.id
    languages.edit(language_id, appending("b"), expected=1)
    with pytest.raises(Conflict, match="revision 2") as caught:
        languages.edit(language_id, appending("c"), expected=1)
    assert caught.value.current == 2
    assert languages.get(language_id).revision.document == "ab"


def test_an_edit_that_fails_leaves_no_revision(languages: LanguageStore) -> None:
    language_id = languages.create(draft("a")).record.id

    def broken(_head: LanguageRevision, _number: int) -> Draft:
        raise ValueError("not a language")

    with pytest.raises(ValueError, match="not a language"):
        languages.edit(language_id, broken)
    assert languages.get(language_id).record.head == 1


def test_edits_at_the_same_time_all_count(languages: LanguageStore) -> None:
    language_id = languages.create(draft("")).record.id
    letters = "abcdefgh"
    threads = [
        threading.Thread(target=languages.edit, args=(language_id, appending(letter)))
        for letter in letters
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    state = languages.get(language_id)
    assert sorted(state.revision.document) == list(letters)
    assert state.record.head == 1 + len(letters)


def test_a_deleted_language_is_gone_until_it_is_restored(languages: LanguageStore) -> None:
    language_id = languages.create(draft("a")).record.id
    with pytest.raises(Conflict):
        languages.delete(language_id, expected=5)
    languages.delete(language_id, expected=1)
    assert languages.all() == []
    for use in (languages.get, languages.delete, languages.revisions):
        with pytest.raises(NotFound):
            use(language_id)
    with pytest.raises(NotFound):
        languages.edit(language_id, appending("b"))
    assert languages.restore(language_id).revision.document == "a"


def test_an_edit_is_made_outside_the_write_lock_and_again_after_another_one(
    languages: LanguageStore,
) -> None:
    language_id = languages.create(draft("one")).record.id
    made_from: list[int] = []

    def edit(head: LanguageRevision, number: int) -> Draft:
        made_from.append(head.revision)
        if len(made_from) == 1:
            languages.edit(language_id, lambda _head, _number: draft(name="theirs"))
        return draft(name=f"mine after {head.name}")

    state = languages.edit(language_id, edit)
    assert made_from == [1, 2]
    assert (state.revision.revision, state.revision.name) == (3, "mine after theirs")


def test_purged_languages_are_gone_with_their_revisions(languages: LanguageStore) -> None:
    kept = languages.create(draft("kept")).record.id
    language_id = languages.create(draft("a")).record.id
    languages.delete(language_id)
    assert languages.purge(now()) == 1
    with pytest.raises(NotFound):
        languages.restore(language_id)
    assert [state.record.id for state in languages.all()] == [kept]


def test_a_sample_is_remembered_when_it_is_gone(languages: LanguageStore) -> None:
    language_id = languages.create(draft(), sample="osg-table-1").record.id
    languages.delete(language_id)
    languages.purge(now())
    assert languages.seeded() == {"osg-table-1"}


def test_a_revision_that_does_not_exist_is_not_found(languages: LanguageStore) -> None:
    language_id = languages.create(draft("a")).record.id
    for revision in (0, 2, 2**31 - 1):
        with pytest.raises(NotFound, match="no revision"):
            languages.get(language_id, revision)
