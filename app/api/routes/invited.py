"""Routes for people who were invited: they see one language's gestures, and add takes to it.

`TokenRequired` lets the token of an invitation reach these routes, and no others.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path, PurePath
from typing import Annotated

from fastapi import APIRouter, Depends, Query, Request
from starlette.concurrency import run_in_threadpool

from app.api.http.problems import ProblemError, problem_responses
from app.api.http.schemas import invitations as schemas
from app.api.http.schemas.values import Diver, Label
from app.api.ingest.intake import (
    UNSUPPORTED,
    Inspected,
    SenderQuota,
    inspect,
    require_place_in_queue,
    require_quota,
    store,
)
from app.api.ingest.multipart import Upload, display_name, file_form, least_size, receive_file
from app.api.services.gesture_edits import gesture_in
from app.api.services.invited_takes import Returned, answer_question, require_unshown
from app.api.services.limited_routes import computed_briefly, edited
from app.api.services.running_studio import CurrentStudio, Invitations, Languages, ServerSettings
from app.api.services.stored_languages import language_of
from app.api.workers.worker_processes import Workers
from app.recognition import Gesture
from app.settings import Settings
from app.store import Invitation, LanguageStore, require_open
from app.store.invitations import closed
from app.store.models import VIDEO
from app.ui.charts import data_url, mark_gesture

router = APIRouter(prefix="/invited", tags=["invitations"])


def _invitation_of(request: Request) -> Invitation:
    invitation: Invitation = request.state.invitation
    return invitation


CurrentInvitation = Annotated[Invitation, Depends(_invitation_of)]
"""Type of a route's parameter that receives the invitation of the request's token."""


@router.get("", responses=problem_responses(404, 429))
@computed_briefly
def get_invited_language(
    languages: Languages, settings: ServerSettings, invitation: CurrentInvitation
) -> schemas.InvitedView:
    """Show the gestures of the language that one is invited to."""
    language = language_of(languages.get(invitation.language_id))
    return schemas.InvitedView(
        id=invitation.id,
        language=language.name,
        trigger=language.trigger.kind,
        expires=invitation.expires,
        takes_left=max(0, invitation.most_takes - invitation.takes),
        most_bytes=min(settings.max_clip_bytes, schemas.MOST_TAKE_BYTES),
        gestures=[_view(gesture) for gesture in language.gestures],
    )


@router.post(
    "/takes",
    status_code=202,
    responses=problem_responses(404, 408, 409, 415, 429),
    openapi_extra=file_form(),
)
async def send_take(
    request: Request,
    studio: CurrentStudio,
    quota: SenderQuota,
    invitation: CurrentInvitation,
    label: Annotated[Label, Query(description="The gesture that it shows")],
    diver: Annotated[Diver, Query(min_length=1, pattern=r"\S", description="Who shows it")],
) -> schemas.InvitedTakeView:
    """Send a video of one gesture, shown once.

    The take is added to the gesture as this person's demonstration, or returned with the reason;
    `GET /invited/takes/{id}` tells which.
    """
    diver = diver.strip()
    await run_in_threadpool(_require_wanted, studio.languages, invitation, label, diver)
    least = least_size(request)
    require_open(invitation, least)
    reserved = await require_place_in_queue(request, studio)
    await require_quota(quota, studio.quotas, least)
    with studio.clips.receiving() as received:
        upload = await _receive_within(invitation, request, received, studio.settings, reserved)
        receive = studio.invitations.receive
        count = partial(receive, invitation.id, label=label, diver=diver, size=upload.size)
        # Counted before it is read, so that files that cannot be used are limited as well.
        take = await run_in_threadpool(count)
        try:
            made = await _inspect_video(received, studio.workers, upload)
        except ProblemError as error:
            await run_in_threadpool(studio.invitations.settle, take.id, "returned", error.detail)
            raise
        made.clip.id = take.clip_id
        made.clip.name = display_name(f"{diver} {label}{PurePath(upload.name).suffix[:8]}")
        try:
            await store(made, received, studio, request)
        except Exception:
            await run_in_threadpool(studio.invitations.release, take)
            raise
    return schemas.InvitedTakeView.of(take)


@router.get("/takes/{take_id}", responses=problem_responses(404, 429))
def get_take(
    take_id: str, invitations: Invitations, invitation: CurrentInvitation
) -> schemas.InvitedTakeView:
    """Tell whether a take was added, why it was returned, or what is asked about it."""
    return schemas.InvitedTakeView.of(invitations.take(invitation.id, take_id))


@router.put("/takes/{take_id}/answer", responses=problem_responses(404, 429))
@edited
def answer_about_take(
    take_id: str,
    answer: schemas.InvitedAnswer,
    studio: CurrentStudio,
    quota: SenderQuota,
    invitation: CurrentInvitation,
) -> schemas.InvitedTakeView:
    """Say whether a take is the gesture, where the language does not read it so.

    An answer that comes again changes nothing, nor does one about a take that is not asked about.
    """
    take = studio.invitations.take(invitation.id, take_id)
    answer_question(studio, take, quota, confirmed=answer.confirmed)
    return schemas.InvitedTakeView.of(studio.invitations.take(invitation.id, take_id))


async def _receive_within(
    invitation: Invitation, request: Request, received: Path, settings: Settings, reserved: int
) -> Upload:
    """Receive a file as `receive_file`; one that does not state its size ends at the limit."""
    largest, left = settings.max_clip_bytes, invitation.most_bytes - invitation.bytes
    within = settings.model_copy(update={"max_clip_bytes": min(largest, left)})
    try:
        return await receive_file(request, received, within, reserved=reserved)
    except ProblemError as error:
        if error.code == "too_large" and left < largest:
            raise closed("used_up") from error
        raise


async def _inspect_video(received: Path, workers: Workers, upload: Upload) -> Inspected:
    """Probe a received file as `inspect`; refuse what is no video in a sentence for divers."""
    detail = f"{upload.name} is no video; record one, or choose another file"
    no_video = ProblemError(415, UNSUPPORTED, detail)
    try:
        made = await inspect(received, workers, name=upload.name, one_take=True)
    except ProblemError as error:
        raise no_video if error.code == UNSUPPORTED else error from error
    if made.clip.source != VIDEO:
        raise no_video
    return made


def _require_wanted(
    languages: LanguageStore, invitation: Invitation, label: str, diver: str
) -> None:
    language = language_of(languages.get(invitation.language_id))
    try:
        require_unshown(gesture_in(language, label), diver)
    except Returned as error:
        raise ProblemError(409, "already_shown", str(error)) from error


def _view(gesture: Gesture) -> schemas.InvitedGestureView:
    shown = gesture.trajectory
    return schemas.InvitedGestureView(
        label=gesture.label,
        description=gesture.description,
        image=data_url(mark_gesture(gesture)),
        seconds=None if shown is None else float(shown.time[-1]),
        held_shapes=len(gesture.held_shapes),
    )
