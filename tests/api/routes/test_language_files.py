"""Language files over HTTP: import and export."""

import json

import httpx
import pytest

from app.recognition import Language
from tests.api.languages import LANGUAGES, add_gesture
from tests.api.running import assert_problem


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
        (b"no json", ""),
        (b"[" * 10_000, ""),
        (b'{"format": "osg-studio/gesture-language", "version": 99}', "/version"),
        (b'{"format": "osg-studio/gesture-language", "version": NaN}', "/version"),
        (b'{"circle": {"image": 3, "salient_keypoints": []}}', "/circle/image"),
        (b"\xff\xfe", ""),
    ],
    ids=["empty", "text", "deep", "newer", "nan", "reference", "utf16"],
)
def test_a_file_that_is_no_language_is_422_and_names_the_place(
    client: httpx.Client, content: bytes, pointer: str
) -> None:
    answer = client.post(f"{LANGUAGES}/import", content=content)
    problem = assert_problem(answer, 422, "language_invalid")
    errors = problem["errors"]
    assert isinstance(errors, list)
    assert errors[0]["pointer"] == pointer
    assert client.get(LANGUAGES).json() == []
