"""Named tokens: a file beside the database that says who may read, edit or administer.

The file holds digests, never the tokens. It is read again after a change, so that tokens can be
added or withdrawn while the server runs.
"""

from __future__ import annotations

import hashlib
import json
import os
import secrets
from collections.abc import Sequence
from datetime import datetime
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from app.store.atomic_files import publish, sync_directory
from app.store.errors import NotFound, StoreUnavailable
from app.store.models import now

TOKEN_BYTES = 24
"""Random bytes of a token: 192 bits, so that a plain digest of it cannot be inverted."""


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

    name: Annotated[str, Field(min_length=1, max_length=80, pattern=r"^[\w .@-]+$")]
    role: Role
    sha256: Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
    created: datetime
    quota_bytes: Annotated[int, Field(gt=0)] | None = None
    quota_clips: Annotated[int, Field(gt=0)] | None = None


class _Document(BaseModel):
    model_config = ConfigDict(extra="forbid")

    version: Literal[1] = 1
    tokens: tuple[NamedToken, ...] = ()


class TokenFile:
    """Reads and writes the named tokens.

    Parameters
    ----------
    path
        The file; there are no tokens while it does not exist.

    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._state: tuple[int, int, int] | None = None
        self._tokens: tuple[NamedToken, ...] = ()

    def read(self) -> tuple[NamedToken, ...]:
        """Return the tokens; the same object while the file is unchanged.

        Raises
        ------
        StoreUnavailable
            When the file cannot be read or is damaged.

        """
        try:
            found = self._path.stat()
        except FileNotFoundError:
            self._state, self._tokens = None, ()
            return self._tokens
        state = (found.st_mtime_ns, found.st_size, found.st_ino)
        if state != self._state:
            try:
                content = self._path.read_text("utf-8")
                self._tokens = _Document.model_validate_json(content).tokens
            except (OSError, UnicodeDecodeError, ValidationError) as error:
                raise StoreUnavailable(
                    f"the tokens in {self._path} cannot be read, so nobody with one is let in; "
                    "correct the file, or remove it and add the tokens again"
                ) from error
            self._state = state
        return self._tokens

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

        """
        secret = secrets.token_urlsafe(TOKEN_BYTES)
        token = NamedToken(
            name=name,
            role=role,
            sha256=digest(secret),
            created=now(),
            quota_bytes=quota_bytes,
            quota_clips=quota_clips,
        )
        self._write([*(each for each in self.read() if each.name != name), token])
        return secret

    def remove(self, name: str) -> None:
        """Withdraw a token.

        Raises
        ------
        NotFound
            When there is none of that name.

        """
        left = [each for each in self.read() if each.name != name]
        if len(left) == len(self.read()):
            raise NotFound(f"there is no token named {name[:80]!r}")
        self._write(left)

    def _write(self, tokens: Sequence[NamedToken]) -> None:
        document = _Document(tokens=tuple(tokens)).model_dump(mode="json", exclude_none=True)
        self._path.parent.mkdir(parents=True, exist_ok=True)
        partial = self._path.with_suffix(".part")
        # Readable only by its owner, because of the names and roles; the digests reveal nothing.
        with os.fdopen(os.open(partial, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), "w") as file:
            json.dump(document, file, indent=2)
        publish(partial, self._path)
        sync_directory(self._path.parent)


def digest(token: str) -> str:
    """Return the stored digest of a token."""
    return hashlib.sha256(token.encode("utf-8", "surrogateescape")).hexdigest()
