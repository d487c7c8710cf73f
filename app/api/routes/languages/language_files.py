"""Routes of what enters and leaves with a language: import, export, slate."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from fastapi import APIRouter, Query, Request, Response
from starlette.concurrency import run_in_threadpool

from app.api.http.connection import while_connected
from app.api.http.downloads import attachment
from app.api.http.problems import ProblemError, file_responses, problem_responses
from app.api.http.revisions import revision_tag
from app.api.http.schemas.languages import LanguageView
from app.api.http.schemas.values import Name, View
from app.api.ingest.intake import SenderQuota
from app.api.ingest.multipart import receive_body
from app.api.routes.asked_revisions import AskedRevision, CurrentRevision
from app.api.services.language_documents import LONGEST_NAME
from app.api.services.language_responses import add_language
from app.api.services.limited_routes import computed, computed_briefly
from app.api.services.running_studio import CurrentStudio, Studio
from app.api.workers.tasks import Import, ImportedLanguage, read_language
from app.api.workers.worker_messages import Failed
from app.api.workers.worker_processes import Workers
from app.recognition.language.export_format import FileFormat
from app.recognition.language.file_schema import FORMAT, VERSION
from app.recognition.language.requirements import find_requirements
from app.store import Draft, Quota
from app.ui.slate.layout import lay_out
from app.ui.slate.pdf import to_pdf
from app.ui.slate.svg import to_svg

SVG, PDF = "image/svg+xml", "application/pdf"


SMALL_BYTES = 512 * 1024
"""Largest file that is read in a thread, within half a second: thirty gestures in our format."""

router = APIRouter(prefix="/languages", tags=["languages"])


@router.post(
    "/import",
    status_code=201,
    responses=problem_responses(),
    openapi_extra={
        "requestBody": {
            "required": True,
            "content": {"application/json": {"schema": {"type": "object"}}},
        }
    },
)
async def import_language(
    request: Request,
    studio: CurrentStudio,
    quota: SenderQuota,
    response: Response,
    name: Annotated[Name, Query()] = "imported",
) -> LanguageView:
    """Add the language of a file: ours, or the published implementation's (then under `name`)."""
    # Stored on disk first, because many slow uploads must not fill the memory.
    with studio.clips.receiving() as partial:
        size = await receive_body(request, partial, studio.settings)
        found = await while_connected(request, _read(partial, size, name, studio.workers))
        return await run_in_threadpool(_create, studio, quota, found, response)


@router.get(
    "/{language_id}/export",
    response_class=Response,
    responses=file_responses("The language file", "application/json", "application/xml"),
)
@computed
def export_language(asked: CurrentRevision, format: FileFormat = FileFormat.OSG_STUDIO) -> Response:
    """Send the language as the file that robots load."""
    row = asked.state.revision
    headers = {
        "Content-Disposition": attachment(row.name, format.suffix),
        "ETag": revision_tag(row.revision),
    }
    return Response(_content(asked, format), media_type=format.media_type, headers=headers)


class ExportedFile(View):
    """One of the files a language can leave as."""

    format: FileFormat
    bytes: int
    complete: bool
    """Whether importing it again gives the same language."""


class ExportView(View):
    """What leaves with a language, and what it takes to use it."""

    name: str
    revision: int
    schema_format: str
    schema_version: int
    files: list[ExportedFile]
    salient: list[str]
    """Landmarks without which gestures are not recognised."""
    limbs: list[str]
    """Landmarks that make recognition surer."""
    torso: list[str]
    """Landmarks that distance and drift are taken out by."""
    models: list[str]
    without_command: list[str]
    """Gestures without a command for the robot."""


@router.get("/{language_id}/export/contents", responses=problem_responses(404))
@computed
def describe_export(asked: CurrentRevision) -> ExportView:
    """Return what the export holds, before it is taken to the robot."""
    language = asked.language
    return ExportView(
        name=language.name,
        revision=asked.state.revision.revision,
        schema_format=FORMAT,
        schema_version=VERSION,
        files=[
            ExportedFile(
                format=file,
                bytes=len(_content(asked, file).encode()),
                complete=file is FileFormat.OSG_STUDIO,
            )
            for file in FileFormat
        ],
        **vars(find_requirements(language)),
        without_command=[gesture.label for gesture in language.gestures if not gesture.command],
    )


def _content(asked: AskedRevision, format: FileFormat) -> str:
    """Return the content of a language file; our own is sent as the revision was saved."""
    if format is FileFormat.OSG_STUDIO:
        return asked.state.revision.document
    return format.write(asked.language)


async def _read(file: Path, size: int, name: str, workers: Workers) -> ImportedLanguage:
    """Read a language file; a large one in a separate process, with limits."""
    if size <= SMALL_BYTES:
        content = await run_in_threadpool(file.read_bytes)
        return await run_in_threadpool(read_language, content, name)
    ended = await workers.run(Import(file=file, name=name))
    if isinstance(ended, Failed):
        raise ProblemError(422, ended.code, ended.detail, pointer=ended.pointer)
    return ImportedLanguage.model_validate(ended.result)


def _create(
    studio: Studio, quota: Quota, found: ImportedLanguage, response: Response
) -> LanguageView:
    read = found.model_dump(exclude={"revision"}) | {"name": found.name[:LONGEST_NAME]}
    return add_language(studio, quota, Draft(**read), found.revision, response)


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
