"""Every error of every route has one shape."""

import errno
from typing import Any

import httpx
import pytest
from fastapi import FastAPI
from fastapi.routing import APIRoute
from pydantic import ValidationError

from app.api.http.problems import problem_of
from app.api.http.schemas.values import Body
from app.recognition.errors import (
    AmbiguousRangeError,
    GestureError,
    LanguageError,
    ModelError,
    OsgError,
    PoseError,
    RangeError,
    VideoError,
)
from app.server import create_app
from app.settings import Settings
from app.store import Conflict, NotFound, StoreUnavailable
from tests.api.running import assert_problem
from tests.api.shared_server import server, settings

__all__ = ["server", "settings"]


def operations(app: FastAPI) -> list[tuple[str, str]]:
    """Return method and path of every documented operation."""
    return [
        (method.upper(), path)
        for path, methods in app.openapi()["paths"].items()
        for method in methods
    ]


@pytest.mark.parametrize(
    ("error", "status", "code"),
    [
        (NotFound("x"), 404, "not_found"),
        (Conflict("x", 3), 412, "revision_conflict"),
        (StoreUnavailable("x"), 503, "store_unavailable"),
        (GestureError("x"), 422, "gesture_unusable"),
        (PoseError("x"), 422, "poses_unusable"),
        (VideoError("x"), 422, "video_unreadable"),
        (LanguageError("x", "/name"), 422, "language_invalid"),
        (AmbiguousRangeError("x"), 422, "take_ambiguous"),
        (RangeError("x", "/start"), 422, "range_empty"),
        (OsgError("x"), 422, "recognition"),
        (ModelError("x"), 503, "model_missing"),
        (OSError(errno.ENOSPC, "No space left on device", "/secret"), 507, "disk_full"),
        (OSError(errno.EROFS, "Read-only file system", "/secret"), 503, "storage_unavailable"),
        (PermissionError(errno.EACCES, "denied", "/secret"), 503, "storage_unavailable"),
        (KeyError("secret"), 500, "internal"),
    ],
    ids=lambda value: type(value).__name__,
)
def test_every_kind_of_error_has_its_status_and_code(
    error: Exception, status: int, code: str
) -> None:
    problem = problem_of(error)
    assert (problem.status_code, problem.code) == (status, code)
    assert b"secret" not in problem.response().body
    if status in (503, 507) and code != "model_missing":
        assert problem.response().headers["retry-after"]


def test_what_does_not_exist_is_a_problem_on_every_route(client: httpx.Client) -> None:
    addressed = [
        (method, path)
        for method, path in operations(create_app(Settings()))
        if "{" in path and "/invited/" not in path  # These ask for an invitation first.
    ]
    assert len(addressed) > 15
    for method, path in addressed:
        address = path.replace("{label}", "circle").replace("{index}", "0")
        for name in IDS:
            address = address.replace(f"{{{name}}}", "missing")
        body, query = BODIES.get((method, path)), QUERIES.get(path)
        headers = TUS if "{upload_id}" in path else {}
        answer = client.request(method, address, json=body, params=query, headers=headers)
        if method == "HEAD":
            assert answer.status_code == 404
        else:
            assert_problem(answer, 404, "not_found")


IDS = (
    "clip_id",
    "invitation_id",
    "job_id",
    "language_id",
    "recognition_id",
    "upload_id",
    "workspace_id",
)

TUS = {
    "Tus-Resumable": "1.0.0",
    "Upload-Offset": "0",
    "Content-Type": "application/offset+octet-stream",
}


BODIES: dict[tuple[str, str], dict[str, Any]] = {
    ("POST", "/api/v1/clips/{clip_id}/turn"): {"degrees": 90},
    ("PATCH", "/api/v1/languages/{language_id}"): {"name": "x"},
    ("POST", "/api/v1/clips/{clip_id}/session.mcap"): {"id": "mine"},
    ("POST", "/api/v1/clips/{clip_id}/topic"): {"topic": "/camera"},
    ("PUT", "/api/v1/languages/{language_id}/trigger"): {"kind": "none"},
    ("POST", "/api/v1/languages/{language_id}/revert"): {"revision": 1},
    ("POST", "/api/v1/languages/{language_id}/gestures"): {"label": "x", "clip_id": "missing"},
    ("PATCH", "/api/v1/languages/{language_id}/gestures"): {"label": "x"},
    ("POST", "/api/v1/languages/{language_id}/gestures/batch"): {
        "gestures": [{"label": "x", "clip_id": "missing"}]
    },
    ("POST", "/api/v1/languages/{language_id}/test-set"): {
        "takes": [{"clip_id": "missing", "expected": "x"}]
    },
    ("PATCH", "/api/v1/languages/{language_id}/test-set/{take_id}"): {"expected": "x"},
    ("POST", "/api/v1/languages/{language_id}/take-table"): {"id": "x", "clip_ids": ["missing"]},
    ("POST", "/api/v1/languages/{language_id}/invitations"): {},
    ("PUT", "/api/v1/languages/{language_id}/invitations/{invitation_id}/takes/{take_id}"): {
        "status": "added"
    },
    ("POST", "/api/v1/languages/{language_id}/practice"): {
        "clip_id": "missing",
        "expected": "x",
        "diver": "Ben",
    },
    ("POST", "/api/v1/languages/{language_id}/demonstrations"): {
        "label": "x",
        "clip_id": "missing",
    },
    ("PATCH", "/api/v1/languages/{language_id}/gestures/{label}"): {"label": "x"},
    ("POST", "/api/v1/languages/{language_id}/replacements"): {"label": "x"},
    ("PUT", "/api/v1/languages/{language_id}/replacements"): {
        "label": "x",
        "demonstration": {"clip_id": "missing"},
    },
    ("POST", "/api/v1/languages/{language_id}/preview"): {"label": "x", "change": {}},
    ("POST", "/api/v1/languages/{language_id}/preview/health"): {"label": "x", "change": {}},
    ("PUT", "/api/v1/workspaces/{workspace_id}/view"): {"clip_id": "missing"},
    ("PATCH", "/api/v1/workspaces/{workspace_id}"): {"dark": True},
}


GESTURES = "/api/v1/languages/{language_id}/gestures"
DEMONSTRATIONS = "/api/v1/languages/{language_id}/demonstrations"
QUERIES = {
    "/api/v1/languages/{language_id}/contrast": {"one": "circle", "other": "line"},
    **{GESTURES + part: {"label": "circle"} for part in ("", "/image", "/demonstration")},
    **{DEMONSTRATIONS + part: {"label": "circle"} for part in ("", "/{index}", "/{index}/image")},
}


def test_a_body_that_is_no_json_is_a_problem_on_every_route(client: httpx.Client) -> None:
    app = create_app(Settings())
    described = app.openapi()["paths"]
    bodies = [
        (method, path)
        for method, path in operations(app)
        if "/invited/" not in path  # These ask for an invitation first.
        and "application/json"
        in described[path][method.lower()].get("requestBody", {}).get("content", {})
    ]
    assert len(bodies) > 7
    for method, path in bodies:
        for content in (b"{", b'{"a": 1e999', b"[" * 100_000, b"\xff", b'"\\ud800"', b"[1]"):
            headers = {"Content-Type": "application/json"}
            answer = client.request(method, path, content=content, headers=headers)
            assert answer.status_code in (400, 422), (method, path, content[:10])
            assert_problem(answer, answer.status_code, answer.json()["code"])


def test_unknown_paths_and_methods_are_problems(client: httpx.Client) -> None:
    assert_problem(client.get("/api/v1/nothing"), 404, "not_found")
    answer = client.put("/api/v1/languages")
    assert_problem(answer, 405, "method_not_allowed")
    assert answer.headers["allow"]


def test_a_fault_outside_the_body_names_its_parameter(client: httpx.Client) -> None:
    answer = client.get("/api/v1/recognitions", params={"limit": "many"})
    problem = assert_problem(answer, 422, "request_invalid")
    assert problem["errors"] == [
        {
            "pointer": "",
            "parameter": "limit",
            "detail": "Input should be a valid integer, unable to parse string as an integer",
        }
    ]


def test_pointers_escape_what_json_pointers_reserve(client: httpx.Client) -> None:
    answer = client.post("/api/v1/languages", json={"name": "x", "a/b~c": 1})
    errors = assert_problem(answer, 422, "request_invalid")["errors"]
    assert isinstance(errors, list)
    assert errors[0]["pointer"] == "/a~1b~0c"


def test_every_operation_documents_its_problems() -> None:
    app = create_app(Settings())
    schema = app.openapi()
    assert "Problem" in schema["components"]["schemas"]
    for method, path in operations(app):
        responses = schema["paths"][path][method.lower()]["responses"]
        assert "application/problem+json" in responses["422"]["content"], (method, path)


def test_every_route_below_the_api_is_documented() -> None:
    app = create_app(Settings())
    hidden = [
        route.path
        for route in app.routes
        if isinstance(route, APIRoute)
        and route.path.startswith("/api/")
        and not route.include_in_schema
    ]
    assert hidden == []


def test_a_text_or_number_is_no_truth_value_in_any_body() -> None:
    waiting, found = [Body], set()
    while waiting:
        model = waiting.pop()
        waiting += model.__subclasses__()
        for name, field in model.model_fields.items():
            if field.annotation is bool:
                found.add(name)
                for value in ("yes", 1, "false"):
                    with pytest.raises(ValidationError) as refused:
                        model.model_validate({name: value})
                    assert "bool_type" in [
                        fault["type"] for fault in refused.value.errors() if fault["loc"] == (name,)
                    ]
    assert found >= {"confirmed", "further", "keep_transit"}
