"""Language files: import and export."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated
from urllib.parse import quote

from fastapi import APIRouter, Query, Request, Response
from pydantic import BaseModel, Field
from starlette.concurrency import run_in_threadpool

from app.api.http.problems import documented
from app.api.http.schemas import LanguageView, Name
from app.api.routes.languages import Revision, announced, tag_of
from app.api.services.context import CurrentStudio, Studio
from app.api.services.language_documents import draft_of
from app.recognition import Language
from app.recognition.language.osg_reference import from_reference, is_reference, to_reference
from app.recognition.language.proteus import SUFFIX as PROTEUS_SUFFIX
from app.recognition.language.proteus import to_proteus
from app.recognition.language.requirements import find_requirements
from app.recognition.language.schema import FORMAT, VERSION

router = APIRouter(prefix="/languages", tags=["languages"])


class FileFormat(StrEnum):
    """The language files."""

    OSG_STUDIO = "osg-studio"
    """Ours: everything."""
    OSG_REFERENCE = "osg-reference"
    """The published implementation's: images and salient keypoints only."""
    PROTEUS = "proteus"
    """A PROTEUS language definition file: names and kinds of the gestures only."""

    @property
    def media_type(self) -> str:
        """What a file of the format is sent as."""
        return "application/xml" if self is FileFormat.PROTEUS else "application/json"

    @property
    def suffix(self) -> str:
        """How the name of a file of the format ends."""
        return PROTEUS_SUFFIX if self is FileFormat.PROTEUS else ".json"


@router.post(
    "/import",
    status_code=201,
    responses=documented(),
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
    response: Response,
    name: Annotated[Name, Query()] = "imported",
) -> LanguageView:
    """Add the language of a file: ours, or the published implementation's (then under `name`)."""
    content = await request.body()
    return await run_in_threadpool(_imported, studio, content, name, response)


@router.get(
    "/{language_id}/export",
    response_class=Response,
    responses={
        **documented(404),
        200: {
            "description": "The language file",
            "content": {"application/json": {}, "application/xml": {}},
        },
    },
)
def export_language(
    language_id: str,
    studio: CurrentStudio,
    format: FileFormat = FileFormat.OSG_STUDIO,
    revision: Revision = None,
) -> Response:
    """Send the language as the file that robots load."""
    state = studio.languages.get(language_id, revision)
    document = state.revision.document
    if format is FileFormat.OSG_REFERENCE:
        document = to_reference(studio.language(state))
    elif format is FileFormat.PROTEUS:
        document = to_proteus(studio.language(state))
    plain, name = (
        f"language{format.suffix}",
        quote(f"{state.revision.name}{format.suffix}", safe=""),
    )
    headers = {
        "Content-Disposition": f"attachment; filename=\"{plain}\"; filename*=utf-8''{name}",
        "ETag": tag_of(state),
    }
    return Response(document, media_type=format.media_type, headers=headers)


class ExportedFile(BaseModel):
    """One of the files a language can leave as."""

    format: FileFormat
    bytes: int
    complete: bool = Field(description="Whether importing it again gives the same language")


class ExportView(BaseModel):
    """What leaves with a language, and what it takes to use it."""

    name: str
    revision: int
    schema_format: str
    schema_version: int
    files: list[ExportedFile]
    salient: list[str] = Field(description="Landmarks without which gestures are not recognised")
    limbs: list[str] = Field(description="Landmarks that make recognition surer")
    torso: list[str] = Field(description="Landmarks that distance and drift are taken out by")
    models: list[str]
    without_command: list[str] = Field(description="Gestures that tell a robot nothing to do")


@router.get("/{language_id}/export/contents", responses=documented(404))
def describe_export(
    language_id: str, studio: CurrentStudio, revision: Revision = None
) -> ExportView:
    """Tell what the export holds, before it is taken to the robot."""
    state = studio.languages.get(language_id, revision)
    language = studio.language(state)
    needed = find_requirements(language)
    documents = {
        FileFormat.OSG_STUDIO: state.revision.document,
        FileFormat.OSG_REFERENCE: to_reference(language),
        FileFormat.PROTEUS: to_proteus(language),
    }
    return ExportView(
        name=language.name,
        revision=state.revision.revision,
        schema_format=FORMAT,
        schema_version=VERSION,
        files=[
            ExportedFile(
                format=file, bytes=len(text.encode()), complete=file is FileFormat.OSG_STUDIO
            )
            for file, text in documents.items()
        ],
        salient=list(needed.salient),
        limbs=list(needed.limbs),
        torso=list(needed.torso),
        models=list(needed.models),
        without_command=[gesture.label for gesture in language.gestures if not gesture.command],
    )


def _imported(studio: Studio, content: bytes, name: str, response: Response) -> LanguageView:
    if is_reference(content):
        language, change = from_reference(content, name), "Import of an osg-reference file"
    else:
        language, change = Language.from_json(content), "Import"
    state = studio.languages.create(draft_of(language, change), language.revision)
    return announced(studio, state, response)
