"""Named tokens: a file beside the database that says who may read, edit or administer.

The file holds digests, never the tokens. It is read again after a change, so that tokens can be
added or withdrawn while the server runs. A data folder remembers that it had a list, and the newest
one: a list that is lost, emptied or replaced by an older one lets nobody in.
"""

from __future__ import annotations

import hashlib
import hmac
import logging
import os
import secrets
import stat
import time
import unicodedata
from collections import OrderedDict
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime, timedelta
from enum import StrEnum
from pathlib import Path
from threading import Lock
from typing import Annotated, Final, Literal

from filelock import FileLock
from pydantic import AwareDatetime, BaseModel, ConfigDict, Field
from sqlmodel import Session, col, delete, or_, select

from app.recognition.text.atomic_files import PRIVATE, replace_file
from app.recognition.text.look_alikes import skeleton
from app.store.database import Database, DatabaseStore, NotFound, StoreUnavailable
from app.store.models import SignIn, now

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


TOKEN_BYTES = 24
"""Random bytes of a token: 192 bits, so that a plain digest of it cannot be inverted."""

MOST_BYTES: Final = 4 * 1024 * 1024
"""Largest list that is read: that of some 15 000 tokens."""

ADMINISTRATOR: Final = "admin"
"""Name of the sender who uses the single token of the settings."""

COMMAND_LINE: Final = "command line"
"""Name under which the audit log has what an administrator does with ``osg-studio``."""

NAME: Final = r"^[\w .@-]+$"

_BEGINNING: Final = datetime(1970, 1, 1, tzinfo=UTC)

logger = logging.getLogger(__name__)


class Role(StrEnum):
    """What a token allows; each role includes the ones before it."""

    READ = "read"
    EDIT = "edit"
    ADMIN = "admin"


class NamedToken(BaseModel):
    """The entry of a token, which holds only its digest.

    Attributes
    ----------
    name
        Name of its user, shown in the audit log.
    role
        What it allows.
    sha256
        Digest of the token.
    created
        When it was made.
    quota_bytes, quota_clips
        Most bytes and clips that this name may keep; None takes the quota of the settings.

    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: Annotated[str, Field(min_length=1, max_length=80, pattern=NAME)]
    role: Role
    sha256: Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
    created: datetime
    quota_bytes: Annotated[int, Field(gt=0)] | None = None
    quota_clips: Annotated[int, Field(gt=0)] | None = None


class _Document(BaseModel):
    model_config = ConfigDict(extra="forbid")

    version: Literal[1] = 1
    written: AwareDatetime = _BEGINNING
    """When the list was changed; a list of an earlier version or made by hand does not say."""
    tokens: tuple[NamedToken, ...] = ()


class TokensUnavailable(StoreUnavailable):
    """Raised when the list of tokens cannot be read, or is not the newest one."""


class TokenFile:
    """Reads and writes the named tokens.

    Parameters
    ----------
    path
        The file; there are no tokens while it does not exist.
    seen
        File in the data folder that remembers the newest list, by the moment of its last change;
        None remembers it in this object alone.

    """

    def __init__(self, path: Path, seen: Path | None = None) -> None:
        self._path = path
        self._seen = seen
        self._state: tuple[int, ...] | None = None
        self._tokens: tuple[NamedToken, ...] = ()
        self._newest: datetime | None = None

    def read(self) -> tuple[NamedToken, ...]:
        """Return the tokens; the same object while the file is unchanged.

        Raises
        ------
        TokensUnavailable
            When the file cannot be read, is damaged, or is older than one that was seen before.

        """
        try:
            found = self._path.stat()
            place, times = (found.st_dev, found.st_ino), (found.st_mtime_ns, found.st_ctime_ns)
            state = (*place, found.st_size, *times)
            if state != self._state:
                # A device or a pipe would be read for ever.
                if not stat.S_ISREG(found.st_mode) or found.st_size > MOST_BYTES:
                    raise ValueError("no list of tokens")
                document = _Document.model_validate_json(self._path.read_bytes())
                self._note(document.written)
                self._tokens, self._state = document.tokens, state
        except (FileNotFoundError, NotADirectoryError):
            if self._state is not None or self._tokens:
                self._state, self._tokens = None, ()
        except (OSError, ValueError) as error:
            self._state = None
            raise TokensUnavailable(
                f"the tokens in {self._path} cannot be read, so nobody with one is let in; "
                "correct the file, or remove it and add the tokens again"
            ) from error
        return self._tokens

    @property
    def in_use(self) -> bool:
        """Whether there is a list, or ever was one; if it is lost, nobody is let in.

        Raises
        ------
        TokensUnavailable
            As `read`.

        """
        self.read()
        known = self._state is not None or self._remembered() is not None
        # A link that leads nowhere is a list on a disk that is not mounted.
        return known or os.path.lexists(self._path)

    def add(
        self,
        name: str,
        role: Role,
        *,
        quota_bytes: int | None = None,
        quota_clips: int | None = None,
    ) -> str:
        """Add a token, or replace the one of the same name; return the token itself.

        Raises
        ------
        ValueError
            When the name or a quota cannot be used.
        TokensUnavailable
            As `read`.

        """
        if is_reserved(name):
            raise ValueError(f"{name[:80]!r} is reserved, or looks like a reserved name")
        secret = secrets.token_urlsafe(TOKEN_BYTES)
        token = NamedToken(
            name=name,
            role=role,
            sha256=digest(secret),
            created=now(),
            quota_bytes=quota_bytes,
            quota_clips=quota_clips,
        )
        with self._changing():
            self._write([*(each for each in self.read() if each.name != name), token])
        return secret

    def remove(self, name: str) -> int:
        """Withdraw a token; return how many are left.

        Raises
        ------
        NotFound
            When there is none of that name.
        TokensUnavailable
            As `read`.

        """
        with self._changing():
            left = [each for each in self.read() if each.name != name]
            if len(left) == len(self.read()):
                raise NotFound(f"there is no token named {name[:80]!r}")
            self._write(left)
        return len(left)

    def _changing(self) -> FileLock:
        """Return the lock of a change: of two at the same time, none may undo the other."""
        self._path.parent.mkdir(parents=True, exist_ok=True)
        return FileLock(self._path.with_name(f"{self._path.name}.lock"), mode=0o600)

    def _write(self, tokens: Sequence[NamedToken]) -> None:
        # Later than every list before it, whatever the clocks of several machines say.
        written = max(now(), (self._remembered() or _BEGINNING) + timedelta(microseconds=1))
        document = _Document(written=written, tokens=tuple(tokens))
        with replace_file(self._path, PRIVATE) as file:
            file.write(document.model_dump_json(indent=2, exclude_none=True).encode())
        self.read()

    def _remembered(self) -> datetime | None:
        """Return when the newest list that was ever seen was changed; None if there was none."""
        if self._newest is None and self._seen is not None:
            try:
                moment = datetime.fromisoformat(self._seen.read_text("ascii"))
                self._newest = moment.astimezone(UTC)
            except FileNotFoundError:
                return None
            except (OSError, ValueError) as error:
                raise TokensUnavailable(
                    f"{self._seen}, which says how new the list of tokens must be, cannot be read, "
                    "so nobody is let in; remove it, look through the tokens, and add one"
                ) from error
        return self._newest

    def _note(self, written: datetime) -> None:
        """Remember a list; refuse one that is older than the newest."""
        newest = self._remembered()
        if newest is not None and written < newest:
            raise TokensUnavailable(
                f"the tokens in {self._path} are of {written:%Y-%m-%d %H:%M:%S}, older than those "
                f"of {newest:%Y-%m-%d %H:%M:%S} that were seen before, so nobody with one is let "
                "in; put the newer file back, or remove it and add the tokens again"
            )
        if written == newest:
            return
        self._newest = written
        if self._seen is None:
            return
        try:
            self._seen.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
            with replace_file(self._seen, PRIVATE) as file:
                file.write(written.isoformat().encode())
        except OSError:
            # This server remembers it itself; only a restart would forget.
            logger.exception("that there are tokens could not be remembered in %s", self._seen)


def is_reserved(name: str) -> bool:
    """Return whether a name is one under which the audit log has something else, or looks so."""
    return _shape(name) in {"", *map(_shape, (ADMINISTRATOR, COMMAND_LINE))}


def _shape(name: str) -> str:
    """Return a name without what the eye overlooks: case, accents, gaps, alphabets."""
    seen = skeleton(unicodedata.normalize("NFKD", name).casefold()).casefold()
    # A 1 has the skeleton of an l, and stands for an i as well.
    return "".join(each for each in seen.replace("i", "l") if each.isalnum())


def digest(token: str) -> str:
    """Return the stored digest of a token, or of the cookie of a session."""
    return hashlib.sha256(token.encode("utf-8", "surrogateescape")).hexdigest()


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
