"""Resumable uploads by the tus protocol 1.0.0 (https://tus.io).

It implements core, creation and termination, which every tus client supports. No library is used:
the maintained one for FastAPI serves the files to anybody, and has neither our limits of rate, disk
and queue nor a way to make clips of uploads.
"""

from __future__ import annotations

import asyncio
import base64
import os
from functools import partial
from http import HTTPStatus
from typing import Annotated, BinaryIO, Final
from weakref import WeakValueDictionary

from fastapi import APIRouter, Depends, Header, Request, Response
from starlette.concurrency import run_in_threadpool
from starlette.requests import ClientDisconnect

from app.api.http.page_files import prefix_of
from app.api.http.problems import ProblemError, problem_responses
from app.api.ingest import intake
from app.api.ingest.fields import LONGEST, UploadFields
from app.api.ingest.intake import SenderQuota
from app.api.ingest.multipart import display_name, require_space
from app.api.middleware.request_bodies import too_large
from app.api.services.identities import identity_of
from app.api.services.running_studio import (
    Clips,
    CurrentStudio,
    Quotas,
    ServerSettings,
    Studio,
    Uploads,
)
from app.store import ClipWithJob, NotFound, QuotaStore, Role, Upload, UploadStore
from app.store.uploads import room_of

VERSION: Final = "1.0.0"
EXTENSIONS: Final = "creation,termination"
OFFSETS: Final = "application/offset+octet-stream"
"""Media type of a part of a file (tus, core protocol)."""

_COMMON = {"Tus-Resumable": VERSION, "Cache-Control": "no-store"}

_writing: WeakValueDictionary[str, asyncio.Lock] = WeakValueDictionary()


def require_version(tus_resumable: Annotated[str | None, Header()] = None) -> None:
    """Refuse a version of the protocol that is not ours."""
    if tus_resumable != VERSION:
        detail = f"the header Tus-Resumable says {tus_resumable!r}; this server speaks {VERSION}"
        raise ProblemError(412, "tus_version", detail, headers={"Tus-Version": VERSION})


router = APIRouter(tags=["clips"])
versioned = APIRouter(prefix="/uploads", dependencies=[Depends(require_version)])


@router.options("/uploads", status_code=204, responses=problem_responses())
def tell_abilities(settings: ServerSettings) -> Response:
    """Return the version and the extensions of the tus protocol."""
    size = str(settings.max_clip_bytes)
    abilities = {"Tus-Version": VERSION, "Tus-Extension": EXTENSIONS, "Tus-Max-Size": size}
    return Response(status_code=204, headers=_COMMON | abilities)


@versioned.post("", status_code=201, responses=problem_responses(412, 429))
async def begin_upload(
    request: Request,
    studio: CurrentStudio,
    quota: SenderQuota,
    upload_length: Annotated[int, Header(ge=0, description="Bytes of the whole file")],
    upload_metadata: Annotated[
        str,
        Header(
            max_length=4096,
            description="Keys with their values in base64: `filename`, and the fields of "
            "`POST /clips`",
        ),
    ] = "",
) -> Response:
    """Begin an upload; `Location` is where its parts go."""
    if upload_length > studio.settings.max_clip_bytes:
        raise too_large(studio.settings.max_clip_bytes)
    given = _metadata(upload_metadata)
    name = display_name(given.get("filename", ""))
    # Checked before the bytes arrive, so that a malformed field does not cost a gigabyte of
    # traffic.
    fields = UploadFields.read(given).model_dump(exclude_none=True, mode="json")
    texts = {key: str(value) for key, value in fields.items()}
    room = room_of(upload_length, joined="chapters" in texts)
    async with studio.turns.beginnings:
        reserved = await intake.require_place_in_queue(request, studio)
        require_space(studio.clips.folder, room, studio.settings, reserved=reserved)
        upload = await run_in_threadpool(
            studio.uploads.create,
            name,
            upload_length,
            texts,
            intake.client_of(request),
            quota.owner,
        )
        try:
            reserve = partial(studio.quotas.reserve, upload, quota)
            await run_in_threadpool(studio.keep_within, quota, reserve)
        except BaseException:
            await run_in_threadpool(studio.uploads.remove, upload.id)
            raise
    location = f"{prefix_of(request.headers, studio.settings)}{request.url.path}/{upload.id}"
    return Response(status_code=201, headers=_COMMON | {"Location": location})


@versioned.head("/{upload_id}", responses=problem_responses(404, 412))
def tell_offset(request: Request, upload_id: str, clips: Clips, uploads: Uploads) -> Response:
    """Return how many bytes have arrived; `Content-Location` is the clip once all of it has.

    While all bytes are there and the clip is not, because it could not be stored, the last byte is
    asked for again: clients take an upload for finished whose offset is its length.
    """
    if clip := clips.by_idempotency_key(upload_id):
        _require_owner(request, upload_id, clip.clip.owner)
        size = str(clip.clip.received_size)
        return Response(
            headers=_finished_headers(clip) | {"Upload-Offset": size, "Upload-Length": size}
        )
    upload = uploads.get(upload_id)
    _require_owner(request, upload_id, upload.owner)
    offset = min(upload.offset, max(upload.size - 1, 0))
    progress = {"Upload-Offset": str(offset), "Upload-Length": str(upload.size)}
    return Response(headers=_COMMON | progress)


@versioned.patch(
    "/{upload_id}",
    status_code=204,
    responses=problem_responses(404, 409, 412, 415),
    openapi_extra={"requestBody": {"content": {OFFSETS: {"schema": {"type": "string"}}}}},
)
async def append_part(
    request: Request,
    upload_id: str,
    studio: CurrentStudio,
    upload_offset: Annotated[int, Header(ge=0, description="Where this part begins")],
    content_type: Annotated[str, Header()] = "",
) -> Response:
    """Add a part; with the last one the file becomes a clip, whose place is `Content-Location`."""
    if content_type != OFFSETS:
        detail = f"a part must be sent as {OFFSETS}, not as {content_type[:80]!r}"
        raise ProblemError(415, "unsupported_media_type", detail)
    # One at a time: what a second request writes must not get into a file that was inspected.
    async with _writing.setdefault(upload_id, asyncio.Lock()):
        try:
            return await _append(request, upload_id, studio, upload_offset)
        except FileNotFoundError as error:
            raise NotFound(f"upload {upload_id} was given up meanwhile; begin it anew") from error


@versioned.delete("/{upload_id}", status_code=204, responses=problem_responses(404, 412))
def give_up_upload(request: Request, upload_id: str, quotas: Quotas, uploads: Uploads) -> Response:
    """Forget an upload and what came of it."""
    _require_owner(request, upload_id, uploads.get(upload_id).owner)
    _forget(upload_id, quotas, uploads)
    return Response(status_code=204, headers=_COMMON)


router.include_router(versioned)


async def _append(request: Request, upload_id: str, studio: Studio, upload_offset: int) -> Response:
    """Add a part, which begins at `upload_offset`, and make a clip of a file that is complete."""
    try:
        upload = await run_in_threadpool(studio.uploads.get, upload_id)
    except NotFound:
        if (answer := await _answer_again(request, studio, upload_id, upload_offset)) is None:
            raise
        return answer
    _require_owner(request, upload_id, upload.owner)
    came = upload.offset
    # A clip shares the bytes of its upload, so none are written once there is one.
    if came == upload.size and (
        answer := await _answer_again(request, studio, upload_id, upload_offset)
    ):
        return answer
    if upload_offset not in (_ends(upload.size) if came == upload.size else (came,)):
        detail = f"{came} bytes have come; go on there instead of at {upload_offset}"
        raise ProblemError(409, "upload_offset", detail)
    others = [
        each for each in await run_in_threadpool(studio.uploads.active) if each.id != upload_id
    ]
    reserved = intake.bytes_to_come(others)
    require_space(studio.clips.folder, upload.to_come, studio.settings, reserved=reserved)
    await run_in_threadpool(studio.quotas.renew, upload)
    offset = await _write(request, upload, upload_offset)
    headers = _COMMON | {"Upload-Offset": str(offset)}
    if offset == upload.size:
        headers |= await _accept(request, upload, studio)
    return Response(status_code=204, headers=headers)


def _require_owner(request: Request, upload_id: str, owner: str) -> None:
    """Answer as if there were no upload to all but its owner and administrators.

    An upload that began before there were tokens is everybody's.
    """
    identity = identity_of(request.scope)
    if owner not in ("", identity.name) and identity.role is not Role.ADMIN:
        raise NotFound(f"there is no upload {upload_id[:80]!r}; begin it anew")


def _forget(upload_id: str, quotas: QuotaStore, uploads: UploadStore) -> None:
    """Remove an upload that becomes no clip."""
    quotas.release(upload_id)
    uploads.remove(upload_id)


def _metadata(header: str) -> dict[str, str]:
    """Parse ``Upload-Metadata``, and return the known keys.

    The header lists keys with their values in base64, and keys alone.
    """
    values: dict[str, str] = {}
    for pair in header.split(","):
        key, _, value = pair.strip().partition(" ")
        if key not in ("filename", *LONGEST):
            continue
        try:
            text = base64.b64decode(value, validate=True)
        except ValueError as error:  # also of characters beyond ASCII
            detail = f"the {key} in Upload-Metadata is not base64"
            raise ProblemError(400, "malformed_upload", detail) from error
        if len(text) > LONGEST.get(key, len(text)):
            detail = f"the field {key!r} is longer than {LONGEST[key]} bytes"
            raise ProblemError(400, "malformed_upload", detail)
        values[key] = text.decode("utf-8", "replace")
    return values


async def _answer_again(
    request: Request, studio: Studio, upload_id: str, offset: int
) -> Response | None:
    """Answer a last part that is sent again because its answer was lost; None if it is not one."""
    clip = await run_in_threadpool(studio.clips.by_idempotency_key, upload_id)
    if clip is None or offset not in _ends(clip.clip.received_size):
        return None
    _require_owner(request, upload_id, clip.clip.owner)
    # It is still there when the server ended between the commit of the clip and the answer.
    await run_in_threadpool(studio.uploads.remove, upload_id)
    headers = _finished_headers(clip) | {"Upload-Offset": str(clip.clip.received_size)}
    return Response(status_code=204, headers=headers)


def _ends(size: int) -> tuple[int, ...]:
    """Return the offsets at which the last part of a complete file may be sent again."""
    return (size, size - 1)


async def _write(request: Request, upload: Upload, offset: int) -> int:
    """Write the received bytes from `offset` on to the disk; return the offset after them.

    Bytes received before a lost connection are kept, so that the next part continues after them.
    """
    with await run_in_threadpool(upload.path.open, "r+b") as file:
        file.seek(offset)
        try:
            async for chunk in request.stream():
                offset += len(chunk)
                if offset > upload.size:
                    raise too_large(upload.size)
                await run_in_threadpool(file.write, chunk)
        except ClientDisconnect as error:
            detail = f"the connection was lost after {offset} of {upload.size} bytes; go on there"
            raise ProblemError(400, "upload_broken_off", detail) from error
        # An acknowledged part outlasts a power cut.
        await run_in_threadpool(_sync, file)
    return offset


def _sync(file: BinaryIO) -> None:
    file.flush()
    os.fsync(file.fileno())


async def _accept(request: Request, upload: Upload, studio: Studio) -> dict[str, str]:
    """Make a clip of a complete file.

    The upload is removed once it is a clip, or is refused for its content. It stays when the store
    is temporarily unavailable.
    """
    clip = await run_in_threadpool(studio.clips.by_idempotency_key, upload.id)
    if clip is None:
        name, fields = upload.name, UploadFields.read(upload.fields)
        try:
            async with intake.joined(upload.path, studio, name=name, fields=fields) as whole:
                made = await intake.inspect(whole, studio.workers, name=name, fields=fields)
                made.clip.idempotency_key, made.clip.owner = upload.id, upload.owner
                await intake.store(made, whole, studio, request, upload_id=upload.id)
        except ProblemError as error:
            if error.status_code < HTTPStatus.INTERNAL_SERVER_ERROR:
                await run_in_threadpool(_forget, upload.id, studio.quotas, studio.uploads)
            raise
        clip = await run_in_threadpool(studio.clips.by_idempotency_key, upload.id)
    # Also when it was a clip already: a crash may have come between the two.
    await run_in_threadpool(studio.uploads.remove, upload.id)
    if clip is None:
        raise NotFound(f"the clip of upload {upload.id} was deleted meanwhile")
    return _finished_headers(clip)


def _finished_headers(clip: ClipWithJob) -> dict[str, str]:
    return _COMMON | {"Content-Location": f"/api/v1/clips/{clip.clip.id}"}
