"""Store of sign-ins: the sessions of browsers, valid on all servers until log-out."""

from __future__ import annotations

import hashlib
import hmac
import secrets
import time
from collections import OrderedDict
from collections.abc import Iterable
from datetime import timedelta
from threading import Lock
from typing import Final

from sqlmodel import Session, col, delete, or_, select

from app.store.database import Database, DatabaseStore
from app.store.models import SignIn, now
from app.store.tokens import digest

LIFETIME: Final = timedelta(days=30)
"""Longest session: a month, the length of a project to design gestures."""

MOST_OF_A_NAME: Final = 100
"""Sessions of one name; the oldest end when there are more, so that no script fills the disk."""

CACHED_SECONDS: Final = 2.0
"""Seconds for which a session that was found counts without asking the database again: the longest
time that a log-out on one server takes to reach the others."""

MOST_CACHED: Final = 4096
"""Sessions cached: more than open pages."""

AT_ONCE: Final = 500
"""Sessions asked for in one query; databases limit the parameters of one."""

COOKIE_BYTES: Final = 32
"""Random bytes of a session's cookie."""


class SignInStore(DatabaseStore):
    """Begins, finds and ends sessions; used by several threads.

    Parameters
    ----------
    database
        Database of the sessions.

    """

    def __init__(self, database: Database) -> None:
        super().__init__(database)
        self._lock = Lock()
        self._cached: OrderedDict[str, tuple[float, SignIn]] = OrderedDict()

    def begin(self, name: str, token_digest: str) -> str:
        """Begin a session of a token; return its cookie, which is stored nowhere."""
        cookie = secrets.token_urlsafe(COOKIE_BYTES)
        begun = SignIn(id=digest(cookie), name=name, proof=proof_of(cookie, token_digest))
        with self._database.writing(counted=False) as session:
            _make_room(session, name)
            session.add(begun)
        return cookie

    def find(self, cookies: Iterable[str]) -> dict[str, SignIn]:
        """Return the sessions of those cookies that have one."""
        by_id = {digest(cookie): cookie for cookie in cookies}
        ids, found = list(by_id), dict[str, SignIn]()
        for start in range(0, len(ids), AT_ONCE):
            query = select(SignIn).where(
                col(SignIn.id).in_(ids[start : start + AT_ONCE]),
                col(SignIn.created) >= now() - LIFETIME,
            )
            with self._database.reading() as session:
                found |= {each.id: each for each in session.exec(query)}
        until = time.monotonic() + CACHED_SECONDS
        with self._lock:
            for key in ids:
                self._cached.pop(key, None)
                if key in found:
                    self._cached[key] = (until, found[key])
            while len(self._cached) > MOST_CACHED:
                self._cached.popitem(last=False)
        return {by_id[key]: each for key, each in found.items()}

    def cached(self, cookie: str) -> SignIn | None:
        """Return a session that was found a moment ago; None if the database must be asked."""
        until, found = self._cached.get(digest(cookie), (0.0, None))
        return found if time.monotonic() < until else None

    def end(self, cookie: str) -> None:
        """End a session; do nothing if there is none."""
        with self._database.writing(counted=False) as session:
            session.execute(delete(SignIn).where(col(SignIn.id) == digest(cookie)))
        with self._lock:
            self._cached.pop(digest(cookie), None)


def proof_of(cookie: str, token_digest: str) -> str:
    """Return what a session's row keeps of its token.

    The key is in no database: who reads the rows can neither sign in nor guess short tokens.
    """
    return hmac.new(cookie.encode(), token_digest.encode(), hashlib.sha256).hexdigest()


def _make_room(session: Session, name: str) -> None:
    """Remove the sessions that are over, and the oldest ones of a name with too many."""
    newest = (
        select(SignIn.id)
        .where(SignIn.name == name)
        .order_by(col(SignIn.created).desc())
        .offset(MOST_OF_A_NAME - 1)
    )
    too_many = session.exec(newest).all()
    over = or_(col(SignIn.created) < now() - LIFETIME, col(SignIn.id).in_(too_many[:AT_ONCE]))
    session.execute(delete(SignIn).where(over))
