"""Store of invitations: who may add takes to a language by a link, and what came in."""

from __future__ import annotations

import secrets
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import timedelta
from typing import Final

from sqlalchemy import ColumnElement, and_, func, not_, or_, update
from sqlmodel import Session, col, select

from app.store.database import DatabaseStore, InvitationClosed, NotFound, TooManyInvitations
from app.store.models import Invitation, InvitedTake, new_id, now
from app.store.tokens import TOKEN_BYTES, digest

CLAIM: Final = timedelta(minutes=5)
"""Time after which another server judges a take that one began to judge: it takes seconds."""

MOST_LISTED: Final = 50
"""Most open invitations of a language, and most of those that are over that are listed."""

LONGEST_DAYS: Final = 30
"""Longest time for which an invitation may be valid; `health/invitations.js` offers it."""

ASK: Final = "ask whoever sent it for a new one"

REASONS: Final = {
    "withdrawn": f"this invitation was withdrawn; {ASK}",
    "expired": f"this invitation is over; {ASK}",
    "used_up": f"this invitation takes nothing more, because its limit is reached; {ASK}",
}


@dataclass(frozen=True)
class InvitationState:
    """An invitation and the takes that came in by it, the oldest first."""

    invitation: Invitation
    takes: Sequence[InvitedTake]


class InvitationStore(DatabaseStore):
    """Keeps invitations and their takes in `database`; a language's go when it is purged."""

    def add(
        self, language_id: str, owner: str, *, most_takes: int, most_bytes: int, days: int
    ) -> tuple[Invitation, str]:
        """Make an invitation; return it with its token, which is stored nowhere.

        Raises
        ------
        TooManyInvitations
            When `MOST_LISTED` of the language are open.

        """
        token = secrets.token_urlsafe(TOKEN_BYTES)
        made = Invitation(
            language_id=language_id,
            sha256=digest(token),
            owner=owner,
            most_takes=most_takes,
            most_bytes=most_bytes,
            expires=now() + timedelta(days=days),
        )
        with self._database.writing() as session:
            of_language = col(Invitation.language_id) == language_id
            count = select(func.count()).select_from(Invitation).where(of_language, _open())
            if session.exec(count).one() >= MOST_LISTED:
                raise TooManyInvitations(
                    f"this language has {MOST_LISTED} open invitations; withdraw one first"
                )
            session.add(made)
        return made, token

    def find(self, token_digest: str) -> Invitation | None:
        """Return the invitation of a token by its digest, valid or not; None if there is none.

        The lookup is by digest, so that its duration reveals nothing about the token.
        """
        with self._database.reading() as session:
            return session.exec(select(Invitation).where(Invitation.sha256 == token_digest)).first()

    def get(self, invitation_id: str, language_id: str | None = None) -> Invitation:
        """Return an invitation, to this language if one is given.

        Raises
        ------
        NotFound
            When there is none.

        """
        with self._database.reading() as session:
            return _load(session, invitation_id, language_id)

    def of(self, language_id: str) -> list[InvitationState]:
        """Return the invitations of a language with their takes, the newest first.

        All that are open, then the newest of those that are over.
        """
        with self._database.reading() as session:
            newest = (
                select(Invitation)
                .where(Invitation.language_id == language_id)
                .order_by(col(Invitation.created).desc(), col(Invitation.id))
            )
            still_open = session.exec(newest.where(_open())).all()
            over = session.exec(newest.where(not_(_open())).limit(MOST_LISTED)).all()
            invitations = [*still_open, *over]
            query = (
                select(InvitedTake)
                .where(col(InvitedTake.invitation_id).in_([each.id for each in invitations]))
                .order_by(col(InvitedTake.created), col(InvitedTake.id))
            )
            takes = session.exec(query).all()
        return [
            InvitationState(each, [take for take in takes if take.invitation_id == each.id])
            for each in invitations
        ]

    def withdraw(self, language_id: str, invitation_id: str) -> None:
        """End an invitation; nothing happens to one that is withdrawn already.

        Raises
        ------
        NotFound
            When the language has no such invitation.

        """
        with self._database.writing() as session:
            found = _load(session, invitation_id, language_id)
            found.withdrawn = found.withdrawn or now()

    def receive(self, invitation_id: str, *, label: str, diver: str, size: int) -> InvitedTake:
        """Count a take and keep it as waiting, for a clip of its `clip_id`.

        Raises
        ------
        InvitationClosed
            When the invitation is over, or one of its limits would be exceeded.

        """
        with self._database.writing() as session:
            invitation = session.get_one(Invitation, invitation_id)
            require_open(invitation, size)
            take = InvitedTake(
                invitation_id=invitation_id, clip_id=new_id(), label=label, diver=diver, size=size
            )
            _count(invitation, 1, size)
            session.add(take)
        return take

    def release(self, take: InvitedTake) -> None:
        """Forget a take whose clip could not be stored."""
        with self._database.writing() as session:
            if (kept := session.get(InvitedTake, take.id)) is not None:
                session.delete(kept)
                _count(session.get_one(Invitation, take.invitation_id), -1, -take.size)

    def take(self, invitation_id: str, take_id: str) -> InvitedTake:
        """Return a take of an invitation.

        Raises
        ------
        NotFound
            When the invitation has no such take.

        """
        with self._database.reading() as session:
            found = session.get(InvitedTake, take_id)
        if found is None or found.invitation_id != invitation_id:
            raise NotFound(f"there is no take {take_id!r} of this invitation")
        return found

    def waiting(self) -> list[InvitedTake]:
        """Return the takes that nobody has judged or is judging, the oldest first."""
        with self._database.reading() as session:
            query = select(InvitedTake).where(_unjudged(), _unclaimed())
            return list(session.exec(query.order_by(col(InvitedTake.created))))

    def claim(self, take_id: str) -> bool:
        """Return whether this server may judge a take now; no other one may for a while."""
        with self._database.writing(counted=False) as session:
            claimed = session.exec(
                update(InvitedTake)
                .where(col(InvitedTake.id) == take_id, _unjudged(), _unclaimed())
                .values(claimed=now())
            )
            return claimed.rowcount == 1

    def settle(
        self, take_id: str, status: str, reason: str | None = None, *, arrived: bool = True
    ) -> None:
        """Keep the status of a take, and its reason; one that has not `arrived` does not count."""
        with self._database.writing() as session:
            if (take := session.get(InvitedTake, take_id)) is not None:
                take.status, take.reason = status, reason
                if not arrived:
                    _count(session.get_one(Invitation, take.invitation_id), -1, -take.size)

    def ask(self, take_id: str, read_as: str | None, question: str) -> None:
        """Keep that the person who shows is asked about a take, in which `read_as` was read."""
        with self._database.writing() as session:
            if (take := session.get(InvitedTake, take_id)) is not None:
                take.status, take.reason, take.read_as = "asked", question, read_as
                take.asked = now()


def require_open(invitation: Invitation, size: int) -> None:
    """Refuse a take of `size` bytes if the invitation is over or would exceed a limit.

    Raises
    ------
    InvitationClosed
        Why it is refused.

    """
    code: str | None = invitation.closed
    if invitation.takes >= invitation.most_takes or invitation.bytes + size > invitation.most_bytes:
        code = code or "used_up"
    if code is not None:
        raise closed(code)


def closed(code: str) -> InvitationClosed:
    """Return the error of an invitation that is closed for this reason, see `REASONS`."""
    return InvitationClosed(REASONS[code], code)


def _load(session: Session, invitation_id: str, language_id: str | None) -> Invitation:
    found = session.get(Invitation, invitation_id)
    if found is None or language_id not in (None, found.language_id):
        to = "" if language_id is None else " to this language"
        raise NotFound(f"there is no invitation {invitation_id!r}" + to)
    return found


def _open() -> ColumnElement[bool]:
    return and_(col(Invitation.withdrawn).is_(None), col(Invitation.expires) > now())


def _unjudged() -> ColumnElement[bool]:
    return and_(col(InvitedTake.status) == "waiting", col(InvitedTake.reason).is_(None))


def _unclaimed() -> ColumnElement[bool]:
    return or_(col(InvitedTake.claimed).is_(None), col(InvitedTake.claimed) < now() - CLAIM)


def _count(invitation: Invitation, takes: int, size: int) -> None:
    invitation.takes += takes
    invitation.bytes += size
