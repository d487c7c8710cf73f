"""The API description: `/openapi.json` holds for generated requests, too."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import HealthCheck, given
from hypothesis import settings as hypothesis_settings

from app.server import create_app
from app.settings import Limits, Settings
from tests.api.recordings import add_recorded_clip, recording_of
from tests.api.running import Running, client_of, running

if TYPE_CHECKING:
    from schemathesis import Case

pytestmark = pytest.mark.slow

TAGS = (
    "administration",
    "clips",
    "gestures",
    "health",
    "invitations",
    "jobs",
    "languages",
    "recognitions",
    "revisions",
    "samples",
    "workspaces",
)
"""Nouns by which the description groups its operations."""


@pytest.fixture(scope="module")
def lasting_server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Running]:
    """Return one server for all generated requests."""
    folder = tmp_path_factory.mktemp("openapi")
    settings = Settings(
        data_dir=folder / "data",
        samples_dir=folder / "samples",
        limits=Limits(max_jobs_per_client=3),
    )
    with running(settings) as server:
        yield server


@pytest.fixture(scope="module")
def operations() -> list[Any]:
    """Return the described operations, without the stream that never ends.

    Only the test worker that needs the description makes it and loads its library.
    """
    import schemathesis
    from schemathesis.core.result import Ok

    # A part of a file is sent as plain bytes, whatever content type tus names.
    schemathesis.serializer.alias("application/offset+octet-stream", "application/octet-stream")
    schema = schemathesis.openapi.from_dict(create_app(Settings()).openapi())
    described = [found.ok() for found in schema.get_all_operations() if isinstance(found, Ok)]
    return [operation for operation in described if operation.path != "/api/v1/events"]


def test_every_operation_has_one_of_the_tags_that_are_tested(operations: list[Any]) -> None:
    assert {tag for operation in operations for tag in operation.tags} == set(TAGS)
    assert all(operation.tags for operation in operations)


@pytest.mark.parametrize("tag", TAGS)
def test_no_request_breaks_the_server_or_the_description(
    lasting_server: Running, operations: list[Any], tag: str, subtests: pytest.Subtests
) -> None:
    from schemathesis.checks import not_a_server_error
    from schemathesis.specs.openapi.checks import (
        content_type_conformance,
        response_schema_conformance,
        status_code_conformance,
    )

    checks = [
        not_a_server_error,
        content_type_conformance,
        response_schema_conformance,
        status_code_conformance,
    ]

    def answer_as_described(case: Case[Any]) -> None:
        response = case.call(base_url=lasting_server.address, timeout=60)
        case.validate_response(response, checks=checks)

    examples = hypothesis_settings(
        max_examples=8, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck)
    )
    for operation in operations:
        if tag in operation.tags:
            with subtests.test(operation.label):
                examples(given(case=operation.as_strategy())(answer_as_described))()


def test_real_objects_answer_as_described(lasting_server: Running, operations: list[Any]) -> None:
    """Request existing ids, which generated requests never hit."""
    clip_id = add_recorded_clip(lasting_server.studio, recording_of("circle"))
    with client_of(lasting_server.address) as client:
        language_id = client.post("/api/v1/languages", json={"name": "pool"}).json()["id"]
        body: dict[str, Any] = {"label": "circle", "clip_id": clip_id}
        client.post(f"/api/v1/languages/{language_id}/gestures", json=body)
        query = {"clip_id": clip_id, "language_id": language_id, "expected": "circle"}
        recognition_id = client.post("/api/v1/recognitions", json=query).json()["id"]
        known = {
            "clip_id": clip_id,
            "language_id": language_id,
            "recognition_id": recognition_id,
            "job_id": client.get(f"/api/v1/clips/{clip_id}").json()["job_id"],
            "label": "circle",
            "index": 0,
        }
        readable = [
            operation
            for operation in operations
            if operation.method == "get"
            and "workspace" not in operation.path
            # Two gestures are compared by their labels in the query.
            and not operation.path.endswith("/contrast")
            # Only an invitation is let in, and takes come by it.
            and "/invited" not in operation.path
            and "{take_id}" not in operation.path
        ]
        assert len(readable) >= 15
        for operation in readable:
            answer = client.get(operation.path.format(**known), params={"label": known["label"]})
            # A clip made of numbers has no pictures.
            pictures = {"poster": 404, "filmstrip": 404, "analysis": 422}
            expected = pictures.get(operation.path.rsplit("/", 1)[1], 200)
            assert answer.status_code == expected, operation.path
            if "json" in answer.headers["content-type"]:
                operation.validate_response(answer)
