"""Identities: determine the sender of a request by token or session, and the sender's role."""

from __future__ import annotations

import hashlib
import hmac
from dataclasses import dataclass

from starlette.types import Scope

from app.settings import Settings
from app.store import NamedToken, Role, TokenFile
from app.store.tokens import digest

ADMINISTRATOR = "admin"
"""Name of the sender who uses the single token of the settings."""


@dataclass(frozen=True)
class Identity:
    """Sender of a request.

    Attributes
    ----------
    name
        Name of the token; empty if the server needs none.
    role
        Role of the token.
    quota_bytes, quota_clips
        Most bytes and clips that this name may keep; 0 is no limit.

    """

    name: str
    role: Role
    quota_bytes: int = 0
    quota_clips: int = 0


ANYBODY = Identity("", Role.ADMIN)
"""Sender of any request to a server without tokens, which listens only on this machine."""


class Identities:
    """Finds the identity of a token or a session.

    Parameters
    ----------
    settings
        Settings with the single token, the file of the named tokens, and the quotas.

    """

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._file = TokenFile(settings.tokens)
        secret = settings.token.get_secret_value().encode() if settings.token else None
        self._own = None if secret is None else hashlib.sha256(secret).hexdigest()
        self._own_session = None if secret is None else _session(secret)
        self._read: tuple[NamedToken, ...] | None = None
        self._by_digest: dict[str, Identity] = {}
        self._by_session: dict[str, Identity] = {}

    @property
    def required(self) -> bool:
        """Whether a token is needed at all."""
        return self._own is not None or bool(self._file.read())

    def of_token(self, shown: str) -> Identity | None:
        """Return the identity of a token; None if it is unknown."""
        # The lookup is by digest, so that its duration reveals nothing about the token.
        self._update()
        return self._by_digest.get(digest(shown))

    def of_session(self, shown: str) -> Identity | None:
        """Return the identity of a session; None if it is unknown."""
        self._update()
        return self._by_session.get(shown)

    def session(self, shown: str) -> str:
        """Return the session of a token that `of_token` knows.

        The cookie is not the token itself, so that a leaked cookie cannot be used as a bearer
        token.
        """
        shown_digest = digest(shown)
        if shown_digest == self._own and self._own_session is not None:
            return self._own_session
        return _session(shown_digest.encode())

    def _update(self) -> None:
        tokens = self._file.read()
        if tokens is self._read:
            return
        by_digest = {each.sha256: self._identity(each) for each in tokens}
        by_session = {_session(key.encode()): each for key, each in by_digest.items()}
        if self._own is not None and self._own_session is not None:
            own = Identity(ADMINISTRATOR, Role.ADMIN)
            by_digest[self._own] = by_session[self._own_session] = own
        self._read, self._by_digest, self._by_session = tokens, by_digest, by_session

    def _identity(self, token: NamedToken) -> Identity:
        settings = self._settings
        return Identity(
            token.name,
            token.role,
            settings.quota_bytes if token.quota_bytes is None else token.quota_bytes,
            settings.quota_clips if token.quota_clips is None else token.quota_clips,
        )


def identity_of(scope: Scope) -> Identity:
    """Return the sender of a request, as stored by `TokenRequired`."""
    found: Identity = scope.get("state", {}).get("identity", ANYBODY)
    return found


def _session(key: bytes) -> str:
    return hmac.new(key, b"osg-studio session", hashlib.sha256).hexdigest()
