"""Bodies that are too large are refused, with or without an honest Content-Length."""

from collections.abc import Iterator

import httpx
import pytest

from app.settings import Settings
from tests.api.running import assert_problem, client_of, running

BODY = b'{"name": "' + b"x" * 5000 + b'"}'


@pytest.fixture
def narrow(settings: Settings) -> Iterator[httpx.Client]:
    """Return a client of a server that takes bodies of 1000 bytes."""
    limits = {"max_body_bytes": 1000, "max_language_bytes": 3000}
    with (
        running(settings.model_copy(update=limits)) as server,
        client_of(server.address) as client,
    ):
        yield client


@pytest.mark.parametrize("path", ["/api/v1/languages", "/api/v1/languages/import"])
@pytest.mark.withstands(row="H01")
def test_a_body_that_says_it_is_too_large_is_413(narrow: httpx.Client, path: str) -> None:
    assert_problem(narrow.post(path, content=BODY), 413, "too_large")


@pytest.mark.parametrize("path", ["/api/v1/languages", "/api/v1/languages/import"])
@pytest.mark.withstands(row="H02")
def test_a_body_that_does_not_say_is_413_at_the_limit(narrow: httpx.Client, path: str) -> None:
    chunks = iter([BODY[:900]] * 20)
    headers = {"Content-Type": "application/json"}
    assert_problem(narrow.post(path, content=chunks, headers=headers), 413, "too_large")
    assert narrow.get("/healthz").status_code == 200


def test_a_language_file_may_be_larger_than_other_bodies(narrow: httpx.Client) -> None:
    answer = narrow.post("/api/v1/languages/import", content=b" " * 2000)
    assert_problem(answer, 422, "language_invalid")
