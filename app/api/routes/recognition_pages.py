"""Route that exports a recognition as one HTML file, which needs no server."""

from __future__ import annotations

from urllib.parse import quote

from fastapi import APIRouter, Response

from app.api.http.problems import problem_responses
from app.api.services.stored_recognitions import load_recognition, load_situation
from app.api.services.studio import CurrentStudio
from app.api.viser_workspaces.views import ViewRequest, view_of
from app.recognition.explanation.explanation import explain
from app.ui.recognition_page import analysis_page

router = APIRouter(prefix="/recognitions", tags=["recognitions"])


@router.get(
    "/{recognition_id}/analysis",
    response_class=Response,
    responses={
        **problem_responses(404, 409),
        200: {"description": "One file that plays without a server", "content": {"text/html": {}}},
    },
)
def share_analysis(recognition_id: str, studio: CurrentStudio) -> Response:
    """Send the take, its votes and why, as one HTML file."""
    record = studio.recognitions.get(recognition_id)
    view = view_of(studio, ViewRequest(clip_id=record.clip_id, recognition_id=record.id))
    meant = record.expected
    why = None if meant is None else explain(load_situation(record, studio), meant)
    name = quote(f"{view.title}.html", safe="")
    disposition = f"attachment; filename=\"analysis.html\"; filename*=utf-8''{name}"
    return Response(
        analysis_page(view, load_recognition(record), why),
        media_type="text/html",
        headers={"Content-Disposition": disposition},
    )
