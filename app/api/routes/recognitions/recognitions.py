"""Routes of recognitions: recognise, list, read, explain, share as one HTML file."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query, Response

from app.api.http.downloads import attachment_as_written
from app.api.http.problems import ProblemError, file_responses, problem_responses
from app.api.http.schemas.gestures import ExplanationView, RecognitionRequest, RecognitionView
from app.api.http.schemas.values import Label, View
from app.api.ingest.intake import SenderQuota
from app.api.services.limited_routes import computed, computed_briefly
from app.api.services.running_studio import CurrentStudio, Recognitions
from app.api.services.stored_recognitions import (
    load_context,
    load_recognition,
    locate_cuts,
    recognize_range,
    view_recognition,
    write_notes,
)
from app.api.viser_workspaces.routes import ViewRequest, view_of
from app.recognition.explanation.explanation import explain
from app.ui.charts import data_url
from app.ui.recognition_page import analysis_page
from app.ui.workspace import Range, compared_images

MOST_LISTED = 500
"""Most recognitions in one answer; the page shows the newest of one clip or language."""

router = APIRouter(prefix="/recognitions", tags=["recognitions"])


@router.post("", status_code=201, responses=problem_responses(404, 409))
@computed
def recognize(
    request: RecognitionRequest, studio: CurrentStudio, quota: SenderQuota
) -> RecognitionView:
    """Recognise a take, a range or all of a clip, and keep the answer."""
    record = recognize_range(studio, request, quota)
    studio.broadcast.publish("recognitions", id=record.id, clip_id=record.clip_id)
    return view_recognition(record)


@router.get("", responses=problem_responses())
@computed_briefly
def list_recognitions(
    recognitions: Recognitions,
    clip_id: Annotated[str | None, Query(max_length=64)] = None,
    language_id: Annotated[str | None, Query(max_length=64)] = None,
    limit: Annotated[int, Query(ge=1, le=MOST_LISTED)] = 100,
) -> list[RecognitionView]:
    """List recognitions, newest first."""
    found = recognitions.all(clip_id=clip_id, language_id=language_id, limit=limit)
    return [view_recognition(record) for record in found]


@router.get("/{recognition_id}", responses=problem_responses(404))
def get_recognition(recognition_id: str, recognitions: Recognitions) -> RecognitionView:
    """Return a recognition as it was answered."""
    return view_recognition(recognitions.get(recognition_id))


@router.get("/{recognition_id}/explanation", responses=problem_responses(404, 409))
@computed
def explain_recognition(
    recognition_id: str,
    studio: CurrentStudio,
    response: Response,
    expected: Annotated[Label | None, Query()] = None,
) -> ExplanationView:
    """Explain why a recognition came out as it did, and what would have turned it right.

    By the language as it was then. `expected` is the gesture that was meant, by default the one
    that the recognition was asked for with.
    """
    record = studio.recognitions.get(recognition_id)
    meant = expected or record.expected
    if not meant:
        detail = "say which gesture was meant: add ?expected=LABEL"
        raise ProblemError(422, "expected_missing", detail)
    context = load_context(record, studio)
    # The recognition never changes, but the known takes by which remedies are judged do.
    response.headers["Cache-Control"] = "private, max-age=60"
    explanation = explain(context, meant)
    nearest = None if explanation.right else explanation.nearest
    notes = write_notes(studio.demonstrations, record, context.language, nearest)
    notes = [note for note in notes if note != explanation.sentence]
    located = tuple(
        locate_cuts(studio.demonstrations, context.language, explanation.counterfactuals)
    )
    content = dict(explanation) | {"counterfactuals": located}
    return ExplanationView(id=record.id, **content, notes=notes)


class ComparedImage(View):
    """A trajectory image that a recognition compared."""

    caption: str
    image: str
    """A data URI of a PNG."""


@router.get("/{recognition_id}/images", responses=problem_responses(404, 409))
@computed
def get_compared_images(
    recognition_id: str, studio: CurrentStudio, response: Response
) -> list[ComparedImage]:
    """Return the trajectory images of the take, the expected and the nearest gesture."""
    record = studio.recognitions.get(recognition_id)
    view = view_of(studio, ViewRequest(clip_id=record.clip_id, recognition_id=record.id))
    images = compared_images(view, load_recognition(record), Range.of(view).poses)
    # A recognition never changes, nor does the revision that it was made with.
    response.headers["Cache-Control"] = "private, max-age=86400"
    return [ComparedImage(caption=caption, image=data_url(image)) for caption, image in images]


@router.get(
    "/{recognition_id}/analysis",
    response_class=Response,
    responses=file_responses(
        "One file that plays without a server", "text/html", refusals=(404, 409)
    ),
)
@computed
def share_analysis(recognition_id: str, studio: CurrentStudio) -> Response:
    """Send the take, its votes and why, as one HTML file."""
    record = studio.recognitions.get(recognition_id)
    view = view_of(studio, ViewRequest(clip_id=record.clip_id, recognition_id=record.id))
    meant = record.expected
    why = None if not meant else explain(load_context(record, studio), meant)
    disposition = attachment_as_written(f"{view.title}.html", "analysis.html")
    return Response(
        analysis_page(view, load_recognition(record), why),
        media_type="text/html",
        headers={"Content-Disposition": disposition},
    )
