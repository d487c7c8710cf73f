"""JSON bodies are unambiguous, or refused."""

import httpx
import pytest

from tests.api.running import assert_problem

LANGUAGES = "/api/v1/languages"
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


def test_a_plain_body_passes(client: httpx.Client) -> None:
    assert post(client, '{"name": "pool"}').status_code == 201
