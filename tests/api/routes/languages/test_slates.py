"""Slates over HTTP: files that a browser saves but does not run."""

import httpx
import pytest

from tests.api.languages import LANGUAGES, add_gesture
from tests.api.running import assert_problem


@pytest.mark.parametrize(
    ("ending", "media_type", "begins"),
    [("svg", "image/svg+xml", b"<?xml"), ("pdf", "application/pdf", b"%PDF-")],
)
def test_a_language_is_sent_as_a_page(
    client: httpx.Client,
    language_id: str,
    circle_clip: str,
    ending: str,
    media_type: str,
    begins: bytes,
) -> None:
    add_gesture(client, language_id, circle_clip)
    answer = client.get(f"{LANGUAGES}/{language_id}/slate.{ending}")
    assert answer.status_code == 200
    assert answer.headers["content-type"] == media_type
    assert answer.headers["content-disposition"].startswith("attachment")
    assert answer.content.startswith(begins)
    assert_problem(client.get(f"{LANGUAGES}/none/slate.{ending}"), 404, "not_found")
