"""Language files over HTTP: import and export."""

import json
import logging
import socket

import httpx
import pytest

from app.api.routes.languages.language_files import SMALL_BYTES
from app.recognition import Language
from tests.api.languages import LANGUAGES, add_gesture, listed, many_gestures
from tests.api.running import Running, assert_problem, until


def test_an_exported_file_loads_and_imports_to_the_same_bytes(
    client: httpx.Client, language_id: str, circle_clip: str
) -> None:
    add_gesture(client, language_id, circle_clip)
    exported = client.get(f"{LANGUAGES}/{language_id}/export")
    assert exported.headers["content-disposition"].startswith("attachment;")
    assert "pool.json" in exported.headers["content-disposition"]
    assert Language.from_json(exported.content).labels == ("circle",)
    imported = client.post(f"{LANGUAGES}/import", content=exported.content)
    assert imported.status_code == 201
    assert imported.json()["revision"] == 2
    again = client.get(f"{LANGUAGES}/{imported.json()['id']}/export")
    assert again.content == exported.content


def test_the_published_file_goes_out_and_comes_in_without_trajectories(
    client: httpx.Client, language_id: str, circle_clip: str
) -> None:
    add_gesture(client, language_id, circle_clip)
    exported = client.get(f"{LANGUAGES}/{language_id}/export", params={"format": "osg-reference"})
    entry = json.loads(exported.content)["circle"]
    assert entry["salient_keypoints"] == ["RIGHT_WRIST"]
    imported = client.post(
        f"{LANGUAGES}/import", params={"name": "published"}, content=exported.content
    )
    assert imported.json()["name"] == "published"
    assert imported.json()["gestures"][0]["has_trajectory"] is False


@pytest.mark.parametrize(
    ("content", "pointer"),
    [
        (b"", ""),
        (b'{"format": "osg-studio/gesture-language", "version": 99}', "/version"),
        (b'{"circle": {"image": 3, "salient_keypoints": []}}', "/circle/image"),
    ],
    ids=["empty", "newer", "reference"],
)
def test_a_file_that_is_no_language_is_422_and_names_the_place(
    client: httpx.Client, content: bytes, pointer: str
) -> None:
    before = listed(client)
    answer = client.post(f"{LANGUAGES}/import", content=content)
    problem = assert_problem(answer, 422, "language_invalid")
    errors = problem["errors"]
    assert isinstance(errors, list)
    assert errors[0]["pointer"] == pointer
    assert listed(client) == before


@pytest.mark.slow
def test_a_large_file_is_read_like_a_small_one(client: httpx.Client) -> None:
    document = many_gestures(60)
    assert len(document) > SMALL_BYTES
    imported = client.post(f"{LANGUAGES}/import", params={"name": "--x"}, content=document)
    assert imported.status_code == 201
    assert len(imported.json()["labels"]) == 60
    exported = client.get(f"{LANGUAGES}/{imported.json()['id']}/export")
    assert exported.text == document


@pytest.mark.slow
def test_a_large_file_that_is_no_language_names_the_place(client: httpx.Client) -> None:
    document = json.loads(many_gestures(60))
    document["gestures"][59]["label"] = 3
    answer = client.post(f"{LANGUAGES}/import", content=json.dumps(document))
    problem = assert_problem(answer, 422, "language_invalid")
    assert "/gestures/59/label" in str(problem["errors"])
    twice = b'{"a": [' + b'{"k": 1, "k": 2},' * 200_000 + b"{}]}"
    assert_problem(client.post(f"{LANGUAGES}/import", content=twice), 422, "language_invalid")


@pytest.mark.slow
@pytest.mark.withstands(row="H04")
def test_an_import_whose_client_leaves_ends_and_is_no_error(
    server: Running, client: httpx.Client, caplog: pytest.LogCaptureFixture
) -> None:
    before, document = listed(client), many_gestures(200).encode()
    head = f"POST {LANGUAGES}/import HTTP/1.1\r\nHost: 127.0.0.1\r\n"
    head += f"Content-Length: {len(document)}\r\n\r\n"
    folder = server.studio.clips.folder
    files = set(folder.iterdir())
    with caplog.at_level(logging.WARNING):
        for said in (head.encode() + document[:-1], head.encode() + document):
            with socket.create_connection(("127.0.0.1", server.port)) as connection:
                connection.sendall(said)
                until(lambda: list(folder.glob("*.part")))
            until(lambda: set(folder.iterdir()) == files)
    assert listed(client) == before
    assert [record.message for record in caplog.records] == []


@pytest.mark.parametrize("path", [LANGUAGES, "/api/v1/recognitions"])
def test_a_client_that_leaves_in_the_middle_of_json_is_no_error(
    server: Running, client: httpx.Client, path: str, caplog: pytest.LogCaptureFixture
) -> None:
    head = f"POST {path} HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Type: application/json\r\n"
    with caplog.at_level(logging.WARNING):
        for _ in range(5):
            with socket.create_connection(("127.0.0.1", server.port)) as connection:
                connection.sendall(f"{head}Content-Length: 100\r\n\r\n{{".encode())
        assert client.get("/healthz").status_code == 200
    assert [record.message for record in caplog.records] == []
