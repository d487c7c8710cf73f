"""Invitations: limits that hold, takes that are judged once, and tokens that are not stored."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from datetime import timedelta

import pytest
from sqlalchemy import text, update
from sqlmodel import col

from app.store import (
    Database,
    Draft,
    Invitation,
    InvitationClosed,
    InvitationStore,
    InvitedTake,
    LanguageStore,
    NotFound,
)
from app.store.invitations import CLAIM
from app.store.models import now
from app.store.tokens import digest


@pytest.fixture
def invitations(database: Database) -> InvitationStore:
    return InvitationStore(database)


@pytest.fixture
def language_id(languages: LanguageStore) -> str:
    return languages.create(draft("pool"), 1).record.id


def draft(name: str) -> Draft:
    return Draft(name=name, labels=["circle"], change="Created", document="{}")


def invite(
    invitations: InvitationStore, language_id: str, *, takes: int = 3, size: int = 100
) -> tuple[Invitation, str]:
    return invitations.add(language_id, "Ada", most_takes=takes, most_bytes=size, days=7)


def send(invitations: InvitationStore, invitation: Invitation, size: int = 10) -> InvitedTake:
    return invitations.receive(invitation.id, label="circle", diver="Bo", size=size)


def put(database: Database, invitation: Invitation, **values: object) -> None:
    """Change the row of an invitation."""
    with database.writing() as session:
        changed = update(Invitation).where(col(Invitation.id) == invitation.id)
        session.execute(changed.values(**values))


def refused(invitations: InvitationStore, invitation: Invitation, size: int = 10) -> str:
    with pytest.raises(InvitationClosed) as caught:
        send(invitations, invitation, size)
    return caught.value.code


def test_the_token_is_found_by_its_digest_and_is_in_no_row(
    database: Database, invitations: InvitationStore, language_id: str
) -> None:
    made, token = invite(invitations, language_id)
    assert invitations.find(digest(token)) == made
    assert invitations.find(digest(f"{token}x")) is None
    with database.engine.connect() as connection:
        rows = connection.execute(text("SELECT * FROM invitation")).all()
    assert len(rows) == 1
    assert token not in str(rows)


def test_no_more_takes_and_bytes_come_in_than_were_allowed(
    invitations: InvitationStore, language_id: str
) -> None:
    few, _ = invite(invitations, language_id, takes=2)
    send(invitations, few)
    send(invitations, few)
    assert refused(invitations, few) == "used_up"
    small, _ = invite(invitations, language_id, size=25)
    send(invitations, small, 20)
    assert refused(invitations, small, 6) == "used_up"
    send(invitations, small, 5)
    assert (invitations.get(small.id).takes, invitations.get(small.id).bytes) == (2, 25)


def test_takes_at_the_same_time_cannot_pass_a_limit(
    invitations: InvitationStore, language_id: str
) -> None:
    made, _ = invite(invitations, language_id, takes=3)

    def try_to_send(_: int) -> bool:
        try:
            send(invitations, made)
        except InvitationClosed:
            return False
        return True

    with ThreadPoolExecutor(8) as pool:
        assert sum(pool.map(try_to_send, range(8))) == 3
    assert invitations.get(made.id).takes == 3


def test_a_take_whose_clip_could_not_be_stored_does_not_count(
    invitations: InvitationStore, language_id: str
) -> None:
    made, _ = invite(invitations, language_id, takes=1)
    invitations.release(send(invitations, made))
    assert (invitations.get(made.id).takes, invitations.get(made.id).bytes) == (0, 0)
    assert invitations.waiting() == []
    send(invitations, made)


def test_an_invitation_that_is_over_or_withdrawn_takes_nothing(
    database: Database, invitations: InvitationStore, language_id: str
) -> None:
    over, _ = invite(invitations, language_id)
    put(database, over, expires=now() - timedelta(seconds=1))
    assert refused(invitations, over) == "expired"
    ended, token = invite(invitations, language_id)
    invitations.withdraw(language_id, ended.id)
    assert refused(invitations, ended) == "withdrawn"
    kept = invitations.find(digest(token))
    assert kept is not None
    moment = kept.withdrawn
    invitations.withdraw(language_id, ended.id)
    assert invitations.get(ended.id).withdrawn == moment


def test_the_invitation_of_another_language_cannot_be_withdrawn(
    invitations: InvitationStore, languages: LanguageStore, language_id: str
) -> None:
    made, _ = invite(invitations, language_id)
    other = languages.create(draft("reef"), 1).record.id
    with pytest.raises(NotFound):
        invitations.withdraw(other, made.id)
    assert invitations.get(made.id).withdrawn is None


def test_a_take_is_judged_by_one_server_until_its_claim_is_old(
    database: Database, invitations: InvitationStore, language_id: str
) -> None:
    made, _ = invite(invitations, language_id)
    take = send(invitations, made)
    another = InvitationStore(database)
    assert invitations.claim(take.id)
    assert not another.claim(take.id)
    assert another.waiting() == []
    with database.writing() as session:
        session.execute(update(InvitedTake).values(claimed=now() - 2 * CLAIM))
    assert [each.id for each in another.waiting()] == [take.id]
    assert another.claim(take.id)
    another.settle(take.id, "added")
    assert invitations.waiting() == []
    assert not invitations.claim(take.id)


def test_what_came_in_is_listed_with_its_outcome(
    invitations: InvitationStore, language_id: str
) -> None:
    first, _ = invite(invitations, language_id)
    second, _ = invite(invitations, language_id)
    added, returned = send(invitations, first), send(invitations, first)
    invitations.settle(added.id, "added")
    invitations.settle(returned.id, "returned", "Nobody is seen.")
    newest, oldest = invitations.of(language_id)
    assert (newest.invitation.id, list(newest.takes)) == (second.id, [])
    assert [(each.status, each.reason) for each in oldest.takes] == [
        ("added", None),
        ("returned", "Nobody is seen."),
    ]
    assert invitations.take(first.id, added.id).status == "added"
    with pytest.raises(NotFound):
        invitations.take(second.id, added.id)


def test_a_question_without_an_answer_waits_for_the_owner_after_ten_minutes(
    database: Database, invitations: InvitationStore, language_id: str
) -> None:
    made, _ = invite(invitations, language_id)
    take = send(invitations, made)
    invitations.ask(take.id, "line", "Is it 'circle'?")
    asked = invitations.take(made.id, take.id)
    assert (asked.standing, asked.held, asked.read_as) == ("asked", True, "line")
    assert invitations.waiting() == []
    with database.writing() as session:
        session.execute(update(InvitedTake).values(asked=now() - timedelta(minutes=10)))
    late = invitations.take(made.id, take.id)
    assert (late.standing, late.held, late.reason) == ("waiting", True, "Is it 'circle'?")
    assert invitations.waiting() == []
    assert not invitations.claim(take.id)


def test_invitations_go_with_their_language(
    invitations: InvitationStore, languages: LanguageStore, language_id: str
) -> None:
    made, _ = invite(invitations, language_id)
    send(invitations, made)
    languages.delete(language_id)
    languages.purge(now() + timedelta(days=1))
    with pytest.raises(NotFound):
        invitations.get(made.id)
    assert invitations.waiting() == []
