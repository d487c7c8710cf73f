"""Open connections: ends those whose token, session or invitation is not valid any more.

A request is let in once, but a stream, a websocket, a download or an upload may last for hours.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import time
from collections.abc import Set
from dataclasses import dataclass
from typing import Any, Final

from starlette.concurrency import run_in_threadpool
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.api.http.problems import ProblemError, problem_of
from app.api.http.websockets import POLICY_VIOLATION
from app.api.middleware.roles import SAFE_METHODS, includes, needed_role
from app.api.services.identities import ANYBODY, Identities, Identity
from app.store import InvitationStore, Role, SignInStore, StoreError
from app.store.invitations import closed
from app.store.tokens import TokensUnavailable

WATCH_SECONDS: Final = 1.0
"""Seconds between two looks at the tokens and sessions of the open connections."""

CLOSING_SECONDS: Final = 5.0
"""Seconds for a websocket's route to end by itself before it is cancelled."""

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Proof:
    """What a connection was let in by: a digest, a session's cookie, or nothing needed.

    The digest is that of a token, or of an invitation's token.
    """

    token: str = ""
    cookie: str = ""
    invitation: str = ""


class OpenConnections:
    """Watches the connections that are open, all of one app.

    Parameters
    ----------
    identities
        Knows the tokens and sessions that are valid.

    """

    def __init__(self, identities: Identities) -> None:
        self._identities = identities
        self._open: set[_Connection] = set()
        self._watching: asyncio.Task[None] | None = None

    async def answer(
        self,
        app: ASGIApp,
        scope: Scope,
        receive: Receive,
        send: Send,
        *,
        proof: Proof,
    ) -> None:
        """Answer a request by `app` as long as its proof and role are sufficient."""
        studio = scope["app"].state.studio
        connection = _Connection(scope, receive, send, proof)
        self._open.add(connection)
        if self._watching is None or self._watching.done():
            self._watching = asyncio.create_task(self._watch(studio.sign_ins, studio.invitations))
        try:
            await connection.answer(app)
        finally:
            self._open.discard(connection)

    async def _watch(self, sign_ins: SignInStore, invitations: InvitationStore) -> None:
        """Look again and again, while anything is open."""
        while self._open:
            await asyncio.sleep(WATCH_SECONDS)
            try:
                proofs = {each.proof for each in self._open}
                invited = {proof for proof in proofs if proof.invitation}
                valid = await self._identify(proofs - invited, sign_ins)
                valid |= await run_in_threadpool(self._identify_invited, invited, invitations)
            except Exception:
                logger.exception("the tokens of open connections could not be looked at")
                continue
            for connection in list(self._open):
                if connection.proof in valid:
                    identity = valid[connection.proof]
                    if identity is None or not includes(identity.role, connection.needed):
                        connection.end()

    def _identify_invited(
        self, proofs: Set[Proof], invitations: InvitationStore
    ) -> dict[Proof, Identity | None]:
        """Return in whose name invited people act; leave out what cannot be told now."""
        found: dict[Proof, Identity | None] = {}
        with contextlib.suppress(StoreError, TokensUnavailable):
            for proof in proofs:
                made = invitations.find(proof.invitation)
                found[proof] = None
                if made is not None and made.closed is None:
                    found[proof] = self._identities.of_inviter(made.owner, made.created)
        return found

    async def _identify(
        self, proofs: Set[Proof], sign_ins: SignInStore
    ) -> dict[Proof, Identity | None]:
        """Return who is behind each proof, None if nobody; leave out what cannot be told now."""
        cookies = [proof.cookie for proof in proofs if proof.cookie]
        try:
            sessions = await run_in_threadpool(sign_ins.find, cookies) if cookies else {}
        except StoreError:
            # While the database does not answer, no log-out is acknowledged either.
            proofs = {proof for proof in proofs if not proof.cookie}
            sessions = {}
        found: dict[Proof, Identity | None] = dict.fromkeys(proofs)
        # Without a list of tokens, nobody can be told from anybody.
        with contextlib.suppress(TokensUnavailable):
            for proof in proofs:
                if proof.cookie and proof.cookie in sessions:
                    session = sessions[proof.cookie]
                    found[proof] = self._identities.of_session(proof.cookie, session)
                elif proof.token:
                    found[proof] = self._identities.of_token(proof.token)
                elif not proof.cookie and not self._identities.required:
                    found[proof] = ANYBODY
        return found


class _Connection:
    """One open request or websocket.

    Attributes
    ----------
    proof
        What it was let in by.
    needed
        Lowest role that it needs.

    """

    def __init__(self, scope: Scope, receive: Receive, send: Send, proof: Proof) -> None:
        self.proof = proof
        self._websocket = scope["type"] == "websocket"
        method = "GET" if self._websocket else scope["method"]
        self.needed: Role = needed_role(method, scope["path"])
        self._scope, self._receive, self._send = scope, receive, send
        self._task = asyncio.current_task()
        self._receiver: asyncio.Task[Any] | None = None
        self._interrupted = self._cut = self._refused = False
        self._complete = self._begun = self._closed = False
        self._ended_at: float | None = None

    async def answer(self, app: ASGIApp) -> None:
        """Answer by `app`; a websocket that was ended is closed with a reason."""
        try:
            await app(self._scope, self._receive_until_ended, self._send_until_ended)
        except asyncio.CancelledError:
            if not (self._cut and self._websocket):
                raise  # uvicorn closes the connection.
            assert self._task is not None
            self._task.uncancel()
        if self._websocket and self._ended_at is not None and not self._closed:
            with contextlib.suppress(RuntimeError, OSError):
                code, reason = POLICY_VIOLATION, withdrawn(self.proof).code
                await self._send({"type": "websocket.close", "code": code, "reason": reason})

    def end(self) -> None:
        """End it: refuse the rest of its body, cut off its answer, or refuse one that is not begun.

        A change whose body has arrived is made, because it was sent while it was allowed; so it is
        answered, and is in the audit log.
        """
        now = time.monotonic()
        self._ended_at = self._ended_at or now
        late = self._websocket and now - self._ended_at > CLOSING_SECONDS
        if (late or self._begun) and self._task is not None:
            if not self._cut:
                self._cut = True
                self._task.cancel()
        elif self._receiver is not None and not self._complete and not self._interrupted:
            self._interrupted = True
            self._receiver.cancel()

    async def _receive_until_ended(self) -> Message:
        if self._ended_at is not None and not self._complete:
            return self._refuse()
        self._receiver = asyncio.current_task()
        try:
            message = await self._receive()
        except asyncio.CancelledError:
            if not self._interrupted or self._receiver is None:
                raise
            self._interrupted = False
            self._receiver.uncancel()
            return self._refuse()
        finally:
            self._receiver = None
        if message["type"] == "http.request" and not message.get("more_body", False):
            self._complete = True
        return message

    def _refuse(self) -> Message:
        if not self._websocket:
            raise withdrawn(self.proof)
        return {"type": "websocket.disconnect", "code": POLICY_VIOLATION, "reason": ""}

    async def _send_until_ended(self, message: Message) -> None:
        """Send a message, but refuse an answer not yet begun; that to a change is sent (`end`)."""
        if self._websocket:
            if self._ended_at is not None:
                return  # It is closed when its route has ended.
            self._closed = self._closed or message["type"] == "websocket.close"
        elif message["type"] == "http.response.start" and not self._begun:
            if self._ended_at is not None and self._scope["method"] in SAFE_METHODS:
                self._refused = True
                await withdrawn(self.proof).response()(self._scope, self._receive, self._send)
            self._begun = True
        if not self._refused:
            await self._send(message)


def withdrawn(proof: Proof) -> ProblemError:
    """Return the problem of a request whose proof was withdrawn before it was answered."""
    if proof.invitation:
        return problem_of(closed("withdrawn"))
    detail = (
        "the token was withdrawn or may do less now, or its session has ended, so this was "
        "refused; sign in again"
    )
    # The rest of the body stays unread, so the connection cannot be reused.
    headers = {"WWW-Authenticate": "Bearer", "Connection": "close"}
    return ProblemError(401, "token_required", detail, headers=headers)
