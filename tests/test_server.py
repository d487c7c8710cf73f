"""The whole app: the page, its description, and what is not there."""

from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from app import resources
from app.settings import Settings
from tests.api.running import assert_problem, running

page = pytest.mark.skipif(not resources.static_dir().is_dir(), reason="the page is not built")


@pytest.fixture
def client(tmp_path: Path) -> Iterator[httpx.Client]:
    settings = Settings(data_dir=tmp_path / "data", samples_dir=tmp_path / "samples")
    with running(settings) as server, httpx.Client(base_url=server.address, timeout=60) as client:
        yield client


@page
def test_the_page_and_its_files_are_served(client: httpx.Client) -> None:
    answer = client.get("/")
    assert answer.headers["content-type"].startswith("text/html")
    scripts = list(resources.static_dir().rglob("*.js"))
    assert scripts
    for script in scripts:
        address = f"/static/{script.relative_to(resources.static_dir()).as_posix()}"
        assert client.get(address).status_code == 200, address


@page
@pytest.mark.parametrize("path", ["/static/../app/server.py", "/static/%2e%2e/pyproject.toml"])
def test_nothing_beside_the_page_is_served(client: httpx.Client, path: str) -> None:
    assert_problem(client.get(path), 404, "not_found")


def test_the_description_is_served_and_pages_that_load_from_elsewhere_are_not(
    client: httpx.Client,
) -> None:
    assert client.get("/openapi.json").json()["info"]["title"] == "OSG Studio"
    for path in ("/docs", "/redoc"):
        assert_problem(client.get(path), 404, "not_found")
