"""Routes of what a recognition compared: its images, and an HTML file that needs no server."""

from __future__ import annotations

from fastapi import APIRouter, Response

from app.api.http.downloads import attachment_as_written
from app.api.http.problems import file_responses, problem_responses
from app.api.http.schemas.values import View
from app.api.services.running_studio import CurrentStudio, computed
from app.api.services.stored_recognitions import load_context, load_recognition
from app.api.viser_workspaces.view_requests import ViewRequest, view_of
from app.recognition.explanation.explanation import explain
from app.ui.charts import data_url
from app.ui.recognition_page import analysis_page
from app.ui.workspace import Range, compared_images

router = APIRouter(prefix="/recognitions", tags=["recognitions"])


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
