"""Routes of slates: a language as one printable page."""

from __future__ import annotations

from fastapi import APIRouter, Response

from app.api.http.downloads import attachment
from app.api.http.problems import file_responses
from app.api.routes.asked_revisions import CurrentRevision
from app.api.services.running_studio import computed_briefly
from app.ui.slate.layout import lay_out
from app.ui.slate.pdf import to_pdf
from app.ui.slate.svg import to_svg

SVG, PDF = "image/svg+xml", "application/pdf"

router = APIRouter(prefix="/languages", tags=["languages"])


@router.get(
    "/{language_id}/slate.svg",
    response_class=Response,
    responses=file_responses("The slate", SVG),
)
@computed_briefly
def get_slate_as_svg(asked: CurrentRevision) -> Response:
    """Send a language as one printable page, in the fonts of whoever opens it."""
    content = to_svg(lay_out(asked.language))
    return _file(content.encode("utf-8"), SVG, attachment(asked.state.revision.name, ".svg"))


@router.get(
    "/{language_id}/slate.pdf",
    response_class=Response,
    responses=file_responses("The slate", PDF),
)
@computed_briefly
def get_slate_as_pdf(asked: CurrentRevision) -> Response:
    """Send a language as one printable page, with its fonts inside."""
    content = to_pdf(lay_out(asked.language))
    return _file(content, PDF, attachment(asked.state.revision.name, ".pdf"))


def _file(content: bytes, media_type: str, disposition: str) -> Response:
    # Sent as a download and not shown in our origin, because labels may be a stranger's text.
    return Response(content, media_type=media_type, headers={"Content-Disposition": disposition})
