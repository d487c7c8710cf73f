"""Routes of a language's invitations: make, list, withdraw; add or remove what came in."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from app.api.http.page_files import INVITATION_ADDRESS, prefix_of
from app.api.http.problems import ProblemError, problem_responses
from app.api.http.schemas import invitations as schemas
from app.api.ingest.intake import SenderQuota
from app.api.services.gesture_edits import add_demonstration_to, demonstration_at, gesture_in
from app.api.services.invited_takes import Returned, add_take, choose_range, remove_take
from app.api.services.limited_routes import computed, edited
from app.api.services.running_studio import CurrentStudio, Invitations, Languages
from app.api.services.stored_languages import language_of, recognizer_of
from app.api.services.stored_recognitions import load_known
from app.recognition import Recognizer
from app.recognition.explanation.context import KnownTakes
from app.store import InvitationState, InvitationStore, InvitedTake
from app.ui.charts import data_url, mark_gesture
from app.ui.qr_code import draw_qr_code

router = APIRouter(prefix="/languages/{language_id}/invitations", tags=["invitations"])


@router.get("", responses=problem_responses(404))
def list_invitations(
    language_id: str, languages: Languages, invitations: Invitations
) -> list[schemas.InvitationView]:
    """List the newest invitations to a language, with the takes that came in by each."""
    languages.get(language_id)
    return [_view(each) for each in invitations.of(language_id)]


@router.post("", status_code=201, responses=problem_responses(404, 409))
def invite(
    request: Request,
    language_id: str,
    draft: schemas.InvitationDraft,
    studio: CurrentStudio,
    quota: SenderQuota,
) -> schemas.NewInvitationView:
    """Invite other people to show each gesture of a language once, by a link.

    Who has the link sees the gestures of this language and adds takes to it, and can do nothing
    else. It ends with its days, with its takes or bytes, when it is withdrawn, and when its maker
    may not edit any more.
    """
    gestures = language_of(studio.languages.get(language_id)).gestures
    if not gestures:
        detail = "this language has no gesture that others could show; save one first"
        raise ProblemError(409, "no_gestures", detail)
    takes = draft.takes or draft.people * len(gestures) * schemas.TAKES_OF_A_GESTURE
    made, token = studio.invitations.add(
        language_id,
        quota.owner,
        most_takes=takes,
        most_bytes=draft.bytes or takes * schemas.MEAN_TAKE_BYTES,
        days=draft.days,
    )
    # After the "#", which browsers do not send: so the token is in no log.
    prefix = prefix_of(request.headers, studio.settings)
    link = f"{str(request.base_url).rstrip('/')}{prefix}{INVITATION_ADDRESS}#{token}"
    seen = _view(InvitationState(made, ()))
    return schemas.NewInvitationView(**seen.model_dump(), link=link, qr=draw_qr_code(link))


@router.delete("/{invitation_id}", status_code=204, responses=problem_responses(404))
def withdraw_invitation(
    language_id: str, invitation_id: str, languages: Languages, invitations: Invitations
) -> Response:
    """End an invitation at once; what was added stays."""
    languages.get(language_id)
    invitations.withdraw(language_id, invitation_id)
    return Response(status_code=204)


@router.get("/{invitation_id}/takes/{take_id}", responses=problem_responses(404, 409))
@computed
def get_received_take(
    language_id: str, invitation_id: str, take_id: str, studio: CurrentStudio
) -> schemas.ReceivedTakeOutlook:
    """Show a take that is held, and what the language would read with it."""
    state = studio.languages.get(language_id)
    language = language_of(state)
    take = _find_take(studio.invitations, language_id, invitation_id, take_id)
    try:
        draft = choose_range(studio.clips, take, gesture_in(language, take.label), language.trigger)
    except Returned as error:
        raise _refusal(error) from error
    shown = demonstration_at(studio.clips, draft, language.trigger)
    changed = add_demonstration_to(language, draft, shown)
    recognizer = recognizer_of(state)
    takes = list(load_known(studio, language_id, recognizer, but=take.clip_id))
    with_it = Recognizer(changed, recognizer.profile, tuning=recognizer.tuning)
    repaired, broken = KnownTakes(recognizer, takes).try_change(with_it)
    return schemas.ReceivedTakeOutlook(
        start=shown.start,
        end=shown.end,
        image=data_url(mark_gesture(changed.gesture(take.label).single_demonstrations()[-1])),
        known=len(takes),
        repaired=len(repaired),
        broken=len(broken),
    )


@router.put("/{invitation_id}/takes/{take_id}", responses=problem_responses(404, 409))
@edited
def change_received_take(
    language_id: str,
    invitation_id: str,
    take_id: str,
    change: schemas.ReceivedTakeChange,
    studio: CurrentStudio,
    quota: SenderQuota,
) -> schemas.ReceivedTakeView:
    """Add a take to the language, or remove it; its clip stays."""
    take = _find_take(studio.invitations, language_id, invitation_id, take_id)
    try:
        (add_take if change.status == "added" else remove_take)(studio, take, quota)
    except Returned as error:
        raise _refusal(error) from error
    return schemas.ReceivedTakeView.of(studio.invitations.take(invitation_id, take_id))


def _find_take(
    invitations: InvitationStore, language_id: str, invitation_id: str, take_id: str
) -> InvitedTake:
    """Return a take of an invitation to a language that is neither returned nor looked at."""
    invitations.get(invitation_id, language_id)
    take = invitations.take(invitation_id, take_id)
    if not take.held and take.status not in ("added", "removed"):
        raise ProblemError(409, "take_not_held", "this take was returned, or is looked at still")
    return take


def _refusal(error: Returned) -> ProblemError:
    return ProblemError(409, "take_unusable", str(error))


def _view(state: InvitationState) -> schemas.InvitationView:
    invitation = state.invitation
    return schemas.InvitationView(
        **invitation.model_dump(exclude={"language_id", "sha256", "owner", "withdrawn"}),
        closed=invitation.closed,
        shown=[schemas.ReceivedTakeView.of(take) for take in state.takes],
    )
