"""Identities: determine the sender of a request by token or session, and the sender's role."""

from __future__ import annotations

import hashlib
import hmac
import logging
import os
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime

from starlette.types import Scope

from app.settings import Settings
from app.store import NamedToken, Role, StoreUnavailable, TokenFile
from app.store.models import SignIn
from app.store.tokens import ADMINISTRATOR, TokensUnavailable, is_reserved, proof_of

logger = logging.getLogger(__name__)


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
    since
        When its token was made; None for the token of the settings, and without tokens.

    """

    name: str
    role: Role
    quota_bytes: int = 0
    quota_clips: int = 0
    since: datetime | None = None


ANYBODY = Identity("", Role.ADMIN)
"""Sender of any request to a server without tokens, which listens only on this machine."""


class Identities:
    """Finds the identity of a token or a session.

    Tokens are needed once there was a list of them, and on a server that other machines can reach:
    a list that is empty or lost lets nobody in.

    Parameters
    ----------
    settings
        Settings with the single token, the file of the named tokens, and the quotas.

    """

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._file = TokenFile(settings.tokens, settings.tokens_seen)
        secret = settings.token.get_secret_value().encode() if settings.token else None
        self._own = None if secret is None else hashlib.sha256(secret).hexdigest()
        self._read: tuple[NamedToken, ...] | None = None
        self._by_digest: dict[str, Identity] = {}
        # A list that is lost with all memory of it before the first request is missed as well.
        with suppress(TokensUnavailable):
            self._file.read()

    @property
    def required(self) -> bool:
        """Whether a token is needed at all.

        Raises
        ------
        TokensUnavailable
            As `of_token`.

        """
        settings = self._settings
        always = settings.public or settings.tokens_file is not None or self._own is not None
        return always or self._file.in_use

    @property
    def nobody(self) -> bool:
        """Whether no token at all would be let in; raises as `of_token`."""
        self._update()
        return not self._by_digest

    def of_token(self, token_digest: str) -> Identity | None:
        """Return the identity of a token by its digest; None if it is unknown.

        Raises
        ------
        TokensUnavailable
            When the list of tokens cannot be read.

        """
        # The lookup is by digest, so that its duration reveals nothing about the token.
        self._update()
        return self._by_digest.get(token_digest)

    def of_session(self, cookie: str, session: SignIn) -> Identity | None:
        """Return the identity of a session; None if its token is unknown, as in `of_token`."""
        self._update()
        for token_digest, identity in self._by_digest.items():
            if identity.name == session.name:
                shown = proof_of(cookie, token_digest)
                if hmac.compare_digest(shown, session.proof):
                    return identity
        return None

    def of_inviter(self, name: str, invited: datetime) -> Identity | None:
        """Return the identity in whose name invited people add takes, by its name.

        None if nobody of that name may edit any more, or the name's token is newer than the
        invitation: one that was removed comes back without the invitations that it made. Raises as
        `of_token`.
        """
        if not self.required:
            return ANYBODY if name == ANYBODY.name else None
        self._update()
        named = [
            each
            for each in self._by_digest.values()
            if each.name == name and (each.since is None or each.since <= invited)
        ]
        return next((each for each in named if each.role is not Role.READ), None)

    def is_own(self, token_digest: str) -> bool:
        """Return whether a token is that of the settings, which a person may have made up."""
        return token_digest == self._own

    def _update(self) -> None:
        tokens = self._file.read()
        if tokens is self._read:
            return
        by_digest = {}
        for each in tokens:
            if is_reserved(each.name):
                logger.warning(
                    "the token %r lets nobody in, because its name is reserved; remove it, and add "
                    "one with another name",
                    each.name,
                )
            else:
                by_digest[each.sha256] = self._identity(each)
        if self._own is not None:
            by_digest[self._own] = Identity(ADMINISTRATOR, Role.ADMIN)
        self._read, self._by_digest = tokens, by_digest

    def _identity(self, token: NamedToken) -> Identity:
        settings = self._settings
        return Identity(
            token.name,
            token.role,
            settings.quota_bytes if token.quota_bytes is None else token.quota_bytes,
            settings.quota_clips if token.quota_clips is None else token.quota_clips,
            token.created,
        )


def check_tokens(settings: Settings) -> str | None:
    """Check the tokens before a server starts; return advice when nobody would be let in.

    Raises
    ------
    StoreUnavailable
        When the settings name a file of tokens that does not exist.

    """
    if (named := settings.tokens_file) is not None and not os.path.lexists(named):
        raise StoreUnavailable(
            f"OSG_TOKENS_FILE names {named}, which does not exist, so nobody could be let in; "
            "mount its folder, or add a token (osg-studio tokens add)"
        )
    identities = Identities(settings)
    try:
        if not identities.required or not identities.nobody:
            return None
    except StoreUnavailable as error:
        return str(error)
    way = "choose one with OSG_TOKEN"
    if not settings.public and named is None:
        way = (
            f"to let in everybody on this machine, remove it and {settings.tokens_seen}, and start "
            "again"
        )
    return (
        f"nobody is let in, because there are no tokens in {settings.tokens}; add one (osg-studio "
        f"tokens add), or {way}"
    )


def identity_of(scope: Scope) -> Identity:
    """Return the sender of a request, as stored by `TokenRequired`."""
    found: Identity = scope.get("state", {}).get("identity", ANYBODY)
    return found
