"""Security headers that every answer has."""

import httpx
import pytest

from tests.api.shared_server import server, settings

__all__ = ["server", "settings"]


@pytest.mark.parametrize("path", ["/api/v1/clips", "/healthz", "/nothing", "/api/v1/nothing"])
@pytest.mark.withstands(row="H17")
def test_every_answer_carries_the_security_headers(client: httpx.Client, path: str) -> None:
    headers = client.get(path).headers
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["referrer-policy"] == "no-referrer"
    assert headers["cross-origin-opener-policy"] == "same-origin"
    assert headers["permissions-policy"].startswith("camera=(self)")
    assert "frame-ancestors 'self'" in headers["content-security-policy"]


def test_the_page_may_load_its_own_scripts_only(client: httpx.Client) -> None:
    policy = client.get("/healthz").headers["content-security-policy"]
    directives = dict(part.strip().split(" ", 1) for part in policy.split(";"))
    assert directives["script-src"] == "'self'"
    assert directives["connect-src"] == "'self'"
    assert directives["object-src"] == "'none'"
    assert directives["base-uri"] == "'none'"


def test_answers_of_the_api_are_not_stored(client: httpx.Client) -> None:
    assert client.get("/api/v1/recognitions").headers["cache-control"] == "no-store"


def test_lists_may_be_kept_by_the_browser_but_are_asked_for_again(client: httpx.Client) -> None:
    assert client.get("/api/v1/clips").headers["cache-control"] == "private, no-cache"
