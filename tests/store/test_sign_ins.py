"""Sessions: random, ended by log-out, and of no use to who reads the database."""

from __future__ import annotations

from datetime import timedelta

import pytest
from sqlalchemy import text
from sqlmodel import select

from app.store import Database, SignInStore
from app.store.models import SignIn, now
from app.store.tokens import LIFETIME, MOST_OF_A_NAME, digest, proof_of


@pytest.fixture
def sign_ins(database: Database) -> SignInStore:
    return SignInStore(database)


def test_a_session_is_found_by_its_cookie_until_it_ends(
    sign_ins: SignInStore, database: Database
) -> None:
    one, two = (sign_ins.begin("Ada", digest("token")) for _ in range(2))
    assert one != two
    found = sign_ins.find([one, two, "invented"])
    assert {cookie: each.name for cookie, each in found.items()} == {one: "Ada", two: "Ada"}
    assert found[one].proof == proof_of(one, digest("token"))
    assert sign_ins.cached(one) is not None
    sign_ins.end(one)
    assert sign_ins.cached(one) is None
    # Another server finds the same.
    for store in (sign_ins, SignInStore(database)):
        assert list(store.find([one, two])) == [two]


def test_neither_cookie_nor_token_is_in_the_database(
    sign_ins: SignInStore, database: Database
) -> None:
    cookie = sign_ins.begin("Ada", digest("token"))
    with database.engine.connect() as connection:
        rows = str(connection.execute(text("SELECT * FROM sign_in")).all())
    assert "Ada" in rows
    for secret in (cookie, "token", digest("token")):
        assert secret not in rows


def test_a_session_ends_by_itself(sign_ins: SignInStore, database: Database) -> None:
    cookie = sign_ins.begin("Ada", digest("token"))
    with database.writing() as session:
        row = session.exec(select(SignIn)).one()
        row.created = now() - LIFETIME - timedelta(seconds=1)
    assert sign_ins.find([cookie]) == {}
    sign_ins.begin("Bo", digest("other"))
    with database.reading() as session:
        assert [each.name for each in session.exec(select(SignIn))] == ["Bo"]


def test_a_name_has_a_limited_number_of_sessions_the_newest(sign_ins: SignInStore) -> None:
    kept = sign_ins.begin("Bo", digest("other"))
    cookies = [sign_ins.begin("Ada", digest("token")) for _ in range(MOST_OF_A_NAME + 3)]
    assert set(sign_ins.find([*cookies, kept])) == {*cookies[3:], kept}
