"""Routes of a language's invitations: make one, list them with what came in, withdraw one."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from app.api.http.page_files import INVITATION_ADDRESS, prefix_of
from app.api.http.problems import ProblemError, problem_responses
from app.api.http.schemas.invitations import (
    MEAN_TAKE_BYTES,
    TAKES_OF_A_GESTURE,
    InvitationDraft,
    InvitationView,
    InvitedTakeView,
    NewInvitationView,
)
from app.api.ingest.quotas import SenderQuota
from app.api.services.running_studio import CurrentStudio
from app.store import InvitationState
from app.ui.qr_code import draw_qr_code

router = APIRouter(prefix="/languages/{language_id}/invitations", tags=["invitations"])


@router.get("", responses=problem_responses(404))
def list_invitations(language_id: str, studio: CurrentStudio) -> list[InvitationView]:
    """List the newest invitations to a language, with the takes that came in by each."""
    studio.languages.get(language_id)
    return [_view(each) for each in studio.invitations.of(language_id)]


@router.post("", status_code=201, responses=problem_responses(404, 409))
def invite(
    request: Request,
    language_id: str,
    draft: InvitationDraft,
    studio: CurrentStudio,
    quota: SenderQuota,
) -> NewInvitationView:
    """Invite other people to show each gesture of a language once, by a link.

    Who has the link sees the gestures of this language and adds takes to it, and can do nothing
    else. It ends with its days, with its takes or bytes, when it is withdrawn, and when its maker
    may not edit any more.
    """
    gestures = studio.language(studio.languages.get(language_id)).gestures
    if not gestures:
        detail = "this language has no gesture that others could show; save one first"
        raise ProblemError(409, "no_gestures", detail)
    takes = draft.takes or draft.people * len(gestures) * TAKES_OF_A_GESTURE
    made, token = studio.invitations.add(
        language_id,
        quota.owner,
        most_takes=takes,
        most_bytes=draft.bytes or takes * MEAN_TAKE_BYTES,
        days=draft.days,
    )
    # After the "#", which browsers do not send: so the token is in no log.
    prefix = prefix_of(request.headers, studio.settings)
    link = f"{str(request.base_url).rstrip('/')}{prefix}{INVITATION_ADDRESS}#{token}"
    seen = _view(InvitationState(made, ()))
    return NewInvitationView(**seen.model_dump(), link=link, qr=draw_qr_code(link))


@router.delete("/{invitation_id}", status_code=204, responses=problem_responses(404))
def withdraw_invitation(language_id: str, invitation_id: str, studio: CurrentStudio) -> Response:
    """End an invitation at once; what was added stays."""
    studio.languages.get(language_id)
    studio.invitations.withdraw(language_id, invitation_id)
    return Response(status_code=204)


def _view(state: InvitationState) -> InvitationView:
    invitation = state.invitation
    return InvitationView(
        **invitation.model_dump(exclude={"language_id", "sha256", "owner", "withdrawn"}),
        closed=invitation.closed,
        shown=[InvitedTakeView(**take.model_dump()) for take in state.takes],
    )
