"""Problem documents (RFC 9457): the one form of every error response."""

from __future__ import annotations

import errno
import logging
from collections.abc import Mapping, Sequence
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from pydantic import BaseModel, ConfigDict
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect

from app import store
from app.recognition.errors import (
    AmbiguousRangeError,
    BagError,
    GestureError,
    LandmarkError,
    LanguageError,
    ModelError,
    OsgError,
    PoseError,
    RangeError,
    TopicError,
    VideoError,
)
from app.recognition.language.file import list_document_steps
from app.recognition.text.described import DESCRIBED
from app.recognition.text.strict_json import build_pointer

MEDIA_TYPE = "application/problem+json"

RETRY_SECONDS = "5"
"""``Retry-After`` in seconds where waiting may help: the time a writer waits for the database."""

_DISK_FULL = (errno.ENOSPC, errno.EDQUOT)

logger = logging.getLogger(__name__)


class Fault(BaseModel):
    """One thing that is wrong with a request."""

    model_config = DESCRIBED

    pointer: str
    """JSON pointer (RFC 6901) into the body; empty: all of it."""
    detail: str
    """What is wrong there."""
    parameter: str | None = None
    """Name of the query, path or header parameter, outside the body."""


class Problem(BaseModel):
    """What went wrong, in the shape of RFC 9457."""

    model_config = ConfigDict(**DESCRIBED, extra="allow")

    type: str
    """URI of this kind of problem."""
    title: str
    """The kind of problem in words."""
    status: int
    """The HTTP status."""
    detail: str
    """What is wrong here, why, and what to do next."""
    code: str
    """Stable word for programs."""
    errors: list[Fault] | None = None
    """Each fault of the request."""


class ProblemError(HTTPException):
    """Raised to answer with a problem document.

    Parameters
    ----------
    status
        HTTP status.
    code
        Stable word for programs, in snake_case.
    detail
        What is wrong, why, and what to do next.
    errors
        Each fault of the request, if there can be several.
    pointer
        Place of the one fault in the body, if it has one.
    headers
        Response headers.
    more
        Further members of the document.

    """

    def __init__(
        self,
        status: int,
        code: str,
        detail: str,
        *,
        errors: Sequence[Fault] = (),
        pointer: str | None = None,
        headers: Mapping[str, str] | None = None,
        **more: Any,
    ) -> None:
        super().__init__(status, detail, headers=dict(headers or {}))
        self.code = code
        self.errors = errors if pointer is None else [Fault(pointer=pointer, detail=detail)]
        self.more = more

    def response(self) -> JSONResponse:
        """Return the answer to send."""
        faults = [fault.model_dump(exclude_none=True) for fault in self.errors]
        content = {
            "type": f"urn:osg-studio:problem:{self.code}",
            "title": HTTPStatus(self.status_code).phrase,
            "status": self.status_code,
            "detail": self.detail,
            "code": self.code,
            **({"errors": faults} if faults else {}),
            **self.more,
        }
        return JSONResponse(
            content, self.status_code, headers=dict(self.headers or {}), media_type=MEDIA_TYPE
        )


def problem_responses(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """Return the OpenAPI ``responses`` of an operation that may answer with these statuses."""
    # Every operation may be refused by the middleware, or fail because the store is unavailable.
    return {
        status: {
            "description": HTTPStatus(status).phrase,
            "content": {MEDIA_TYPE: {"schema": {"$ref": "#/components/schemas/Problem"}}},
        }
        for status in sorted({*statuses, 400, 401, 403, 413, 422, 500, 503, 507})
    }


def file_responses(
    description: str, *media_types: str, refusals: Sequence[int] = (404,)
) -> dict[int | str, dict[str, Any]]:
    """Return the OpenAPI ``responses`` of an operation that sends a file, or a refusal."""
    content: dict[str, dict[str, Any]] = {media_type: {} for media_type in media_types}
    return {
        **problem_responses(*refusals),
        200: {"description": description, "content": content},
    }


def schemas() -> dict[str, Any]:
    """Return the JSON Schemas that `problem_responses` refers to."""
    schema = Problem.model_json_schema(ref_template="#/components/schemas/{model}")
    return {**schema.pop("$defs"), "Problem": schema}


def install(app: FastAPI) -> None:
    """Make `app` answer every error with a problem document."""
    own = OsgError, store.StoreError, OSError, Exception
    for kind in (RequestValidationError, HTTPException, ClientDisconnect, *own):
        app.add_exception_handler(kind, _on_error)


def problem_of(error: Exception) -> ProblemError:
    """Return the problem that stands for `error`."""
    match error:
        case ProblemError():
            return error
        case HTTPException():
            code = HTTPStatus(error.status_code).name.lower()
            return ProblemError(error.status_code, code, str(error.detail), headers=error.headers)
        case RequestValidationError():
            return _convert_invalid_request(error)
        case ClientDisconnect():
            # Nobody reads this; a 400 keeps the server's log free of an error that is not its own.
            return ProblemError(400, "client_left", "the client left before it was answered")
        case store.StoreError():
            return _convert_store_error(error)
        case OsgError():
            return _convert_recognition_error(error)
        case OSError():
            return _convert_os_error(error)
    logger.error("unexpected error", exc_info=error)
    return ProblemError(
        500,
        "internal",
        "the server met an error that it does not know; its log has the details",
    )


def _convert_store_error(error: store.StoreError) -> ProblemError:
    match error:
        case store.NotFound():
            return ProblemError(404, "not_found", str(error))
        case store.Conflict():
            return ProblemError(
                412,
                "revision_conflict",
                str(error),
                headers={"ETag": f'"{error.current}"'},
                current_revision=error.current,
            )
        case store.QuotaExceeded():
            return ProblemError(
                413 if error.alone else 507,  # Alone: no deletion helps.
                "quota_exceeded",
                str(error),
                # The rest of a body stays unread, so the connection cannot be used again.
                headers={"Connection": "close"},
                used={"clips": error.usage.clips, "bytes": error.usage.bytes},
                limit=error.limit,
            )
        case store.TooManyInvitations():
            return ProblemError(409, "too_many_invitations", str(error))
        case store.TestSetFull():
            return ProblemError(409, "test_set_full", str(error))
        case store.InvitationClosed():
            # The rest of a body stays unread, so the connection cannot be used again.
            headers = {"Connection": "close"}
            return ProblemError(
                403, "invitation_closed", str(error), headers=headers, reason=error.code
            )
    headers = {"Retry-After": RETRY_SECONDS}
    return ProblemError(503, "store_unavailable", str(error), headers=headers)


def _convert_recognition_error(error: OsgError) -> ProblemError:
    if isinstance(error, ModelError):
        return ProblemError(503, "model_missing", str(error))
    if isinstance(error, LanguageError):
        return ProblemError(422, "language_invalid", str(error), pointer=error.pointer)
    if isinstance(error, AmbiguousRangeError):
        return ProblemError(422, "take_ambiguous", str(error))
    if isinstance(error, RangeError):
        return ProblemError(422, "range_empty", str(error), pointer=error.pointer)
    codes: dict[type, str] = {
        GestureError: "gesture_unusable",
        VideoError: "video_unreadable",
        BagError: "bag_unreadable",
        TopicError: "topic_unusable",
        PoseError: "poses_unusable",
        LandmarkError: "landmark_missing",
    }
    return ProblemError(422, codes.get(type(error), "recognition"), str(error))


def _convert_os_error(error: OSError) -> ProblemError:
    # The path is only logged, because it must not leave this machine.
    logger.error("storage failed", exc_info=error)
    reason = error.strerror or type(error).__name__
    headers = {"Retry-After": RETRY_SECONDS}
    if error.errno in _DISK_FULL:
        detail = f"the server's disk is full ({reason}); delete clips or free space, then try again"
        return ProblemError(507, "disk_full", detail, headers=headers)
    detail = f"the server's storage cannot be used ({reason}); nothing was changed, try again"
    return ProblemError(503, "storage_unavailable", detail, headers=headers)


async def _on_error(_request: Request, error: Exception) -> JSONResponse:
    return problem_of(error).response()


def _convert_invalid_request(error: RequestValidationError) -> ProblemError:
    faults = [_fault(item) for item in error.errors()]
    where = "; ".join(f"{f.parameter or f.pointer or 'body'}: {f.detail}" for f in faults[:3])
    more = f" (and {len(faults) - 3} more)" if len(faults) > 3 else ""
    detail = f"the request is not valid: {where}{more}"
    return ProblemError(422, "request_invalid", detail, errors=faults)


def _fault(item: Mapping[str, Any]) -> Fault:
    """Convert one of pydantic's errors, without the input, which may be anything."""
    place, *steps = item["loc"]
    told = item["msg"].removeprefix("Value error, ")
    if place != "body":
        name = str(steps[0]) if steps else str(place)
        return Fault(pointer="", detail=told, parameter=name)
    if item["type"] == "json_invalid":
        return Fault(pointer="", detail=f"not JSON: {item['ctx']['error']}")
    return Fault(pointer=build_pointer(*list_document_steps(tuple(steps))), detail=told)
