"""Request bodies: too large, too slow or ambiguous ones are refused."""

import select
import socket
from collections.abc import Iterator

import httpx
import pytest

from app.settings import Limits, Settings
from tests.api.running import assert_problem, client_of, running
from tests.api.shared_server import server, settings

__all__ = ["server", "settings"]

BODY = b'{"name": "' + b"x" * 5000 + b'"}'


@pytest.fixture
def narrow(settings: Settings) -> Iterator[httpx.Client]:
    """Return a client of a server that takes bodies of 1000 bytes."""
    limits = {"limits": Limits(max_body_bytes=1000, max_language_bytes=3000)}
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


LANGUAGES = "/api/v1/languages"
FOREIGN = (
    b"POST /api/v1/languages HTTP/1.1\r\nHost: 127.0.0.1\r\n"
    b"Origin: http://evil.example\r\nContent-Length: 12\r\n\r\n"
)
"""Header of a request that is refused whatever its body says."""


def connection_to(client: httpx.Client) -> socket.socket:
    return socket.create_connection((client.base_url.host, client.base_url.port), timeout=30)


def test_a_refusal_comes_after_a_small_body_and_keeps_the_connection(client: httpx.Client) -> None:
    with connection_to(client) as connection:
        for _ in range(2):
            connection.sendall(FOREIGN)
            assert not select.select([connection], [], [], 0.3)[0]
            connection.sendall(b'{"name":"x"}')
            answer = b""
            while not answer.endswith(b"}"):
                answer += connection.recv(10_000)
            assert answer.startswith(b"HTTP/1.1 403")


def test_a_refusal_does_not_wait_long_for_a_body_that_never_comes(client: httpx.Client) -> None:
    with connection_to(client) as connection:
        connection.sendall(FOREIGN)
        assert connection.recv(10_000).startswith(b"HTTP/1.1 403")


JSON = {"Content-Type": "application/json"}


def post(client: httpx.Client, body: str | bytes) -> httpx.Response:
    return client.post(LANGUAGES, content=body, headers=JSON)


@pytest.mark.parametrize(
    ("body", "pointer"),
    [
        ('{"name": "a", "name": "b"}', "/name"),
        ('{"name": NaN}', "/name"),
        ('{"name": 1e999}', "/name"),
        ('{"name": 123456789012345678901234567890}', "/name"),
        ('{"name": "\\ud800"}', "/name"),
        ('{"x": {"y": 1, "y": 1}}', "/x/y"),
        ("[" * 5000 + "]" * 5000, ""),
        ('{"name": ', ""),
        (b'{"name": "\xff"}', ""),
    ],
)
@pytest.mark.withstands(row="H13")
def test_what_readers_understand_differently_is_refused(
    client: httpx.Client, body: str | bytes, pointer: str
) -> None:
    problem = assert_problem(post(client, body), 422, "request_invalid")
    errors = problem["errors"]
    assert isinstance(errors, list)
    assert errors[0]["pointer"] == pointer
    assert client.get(LANGUAGES).json() == []


def test_a_body_in_many_pieces_is_checked_as_one(client: httpx.Client) -> None:
    pieces = iter([b'{"name": "a", ', b'"na', b'me": "b"}'])
    answer = client.post(LANGUAGES, content=pieces, headers=JSON)
    assert_problem(answer, 422, "request_invalid")


def test_other_json_media_types_are_checked_too(client: httpx.Client) -> None:
    answer = client.post(
        LANGUAGES,
        content=b'{"name": "a", "name": "b"}',
        headers={"Content-Type": "application/merge-patch+json; charset=utf-8"},
    )
    assert_problem(answer, 422, "request_invalid")


def test_of_thirty_thousand_duplicate_keys_twenty_are_named(client: httpx.Client) -> None:
    body = "{" + ",".join(f'"key{index % 30_000}": 1' for index in range(60_000)) + "}"
    assert len(body) < 1024 * 1024
    problem = assert_problem(post(client, body), 422, "request_invalid")
    errors = problem["errors"]
    assert isinstance(errors, list)
    assert len(errors) == 20


def test_a_key_against_double_requests_is_refused_where_it_is_not_understood(
    client: httpx.Client,
) -> None:
    key = {"Idempotency-Key": "7f3c"}
    refused = client.post(LANGUAGES, json={"name": "pool"}, headers=key)
    assert_problem(refused, 422, "idempotency_key_unknown")
    assert client.get(LANGUAGES, headers=key).status_code == 200
    assert client.post("/api/v1/clips", headers=key).json()["code"] != "idempotency_key_unknown"
