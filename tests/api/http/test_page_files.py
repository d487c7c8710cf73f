"""Page files: the browser caches them until they change."""

import re
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from app import resources
from app.api.http.page_files import COMMENT
from app.settings import Settings
from tests.api.running import Running, client_of, running

STATIC = resources.static_dir()
PAGE = """
<link rel="icon" href="static/icon.svg" />
<link rel="stylesheet" href="static/styles/base.css" />
<link rel="stylesheet" href="static/styles/after.css" />
<script type="module" src="static/js/main.js"></script>
"""


@pytest.fixture(scope="module")
def page_server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Running, Path]]:
    """Serve the page of a folder to all tests of this module."""
    folder, data = (tmp_path_factory.mktemp(name) for name in ("page", "data"))
    for name in ("js", "styles"):
        (folder / name).mkdir()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(resources, "static_dir", lambda: folder)
        with running(Settings(data_dir=data)) as server:
            yield server, folder


@pytest.fixture
def folder(page_server: tuple[Running, Path]) -> Path:
    """Write the page anew."""
    _, folder = page_server
    (folder / "styles" / "base.css").write_text("a { color: red }")
    (folder / "styles" / "after.css").write_text("a { color: blue }")
    (folder / "index.html").write_text(PAGE)
    (folder / "js" / "main.js").write_text("one();")
    return folder


@pytest.fixture
def client(page_server: tuple[Running, Path], folder: Path) -> Iterator[httpx.Client]:
    with client_of(page_server[0].address) as client:
        yield client


def script(client: httpx.Client) -> str:
    """Return the address of the page's script."""
    page = client.get("/")
    assert page.headers["cache-control"] == "no-cache"
    return page.text.split('src="')[1].split('"')[0]


def test_a_file_that_the_page_names_is_never_asked_for_again(client: httpx.Client) -> None:
    answer = client.get(script(client))
    assert answer.text == "one();"
    assert "immutable" in answer.headers["cache-control"]


def test_after_an_update_the_page_names_all_files_anew(client: httpx.Client, folder: Path) -> None:
    before = script(client)
    (folder / "js" / "other.js").write_text("two();")
    after = script(client)
    assert after != before
    assert "immutable" in client.get(after).headers["cache-control"]
    # A page that was opened before gets today's file, cached only briefly.
    old = client.get(before)
    assert (old.status_code, old.headers["cache-control"]) == (200, "no-cache")


def test_without_a_digest_the_browser_asks_first(client: httpx.Client) -> None:
    answer = client.get("static/js/main.js")
    assert answer.headers["cache-control"] == "no-cache"
    again = client.get("static/js/main.js", headers={"If-None-Match": answer.headers["etag"]})
    assert (again.status_code, again.headers["cache-control"]) == (304, "no-cache")


def test_all_style_sheets_come_as_one_in_the_order_of_the_page(client: httpx.Client) -> None:
    (link,) = re.findall('rel="stylesheet" href="([^"]+)"', client.get("/").text)
    answer = client.get(link)
    assert answer.text == "a { color: red }\na { color: blue }"
    assert answer.headers["content-type"].startswith("text/css")
    assert "immutable" in answer.headers["cache-control"]
    assert client.head(link).status_code == 200
    assert client.post(link).status_code == 405


def test_the_page_and_its_files_are_compressed_and_no_answer_of_the_api(
    client: httpx.Client, folder: Path
) -> None:
    text = "one();\n" * 1000
    (folder / "js" / "main.js").write_text(text)
    (folder / "index.html").write_text(PAGE + " " * 1000)
    found = client.get(script(client))
    assert found.headers["content-encoding"] == "gzip"
    assert int(found.headers["content-length"]) < len(text) / 10
    assert found.text == text
    assert client.get("/").headers["content-encoding"] == "gzip"
    (folder / "notes.txt").write_text(text)
    part = client.get("static/notes.txt", headers={"Range": "bytes=0-599"})
    assert (part.status_code, "content-encoding" in part.headers) == (206, False)
    listed = client.get("/api/v1/samples")
    assert len(listed.content) > 600
    assert "content-encoding" not in listed.headers


@pytest.mark.parametrize("path", ["", "js", "js/none.js", "0123456789abcdef", "../secret"])
def test_what_is_no_file_is_not_found(client: httpx.Client, path: str) -> None:
    assert client.get(f"static/{path}").status_code == 404


def test_scripts_come_without_comments_and_lines_keep_their_numbers(
    client: httpx.Client, folder: Path
) -> None:
    text = '// First.\n/**\n * Of two.\n */\nconst a = "// no"; // kept\n  // Third.\n  b(a);\n'
    (folder / "js" / "main.js").write_text(text)
    answer = client.get(script(client))
    assert answer.text == '\n\n\n\nconst a = "// no"; // kept\n\nb(a);\n'
    assert answer.headers["content-type"].startswith("text/javascript")


def test_no_line_of_a_template_looks_like_a_comment() -> None:
    for file in (STATIC / "js").rglob("*.js"):
        for found in COMMENT.finditer(file.read_text(encoding="utf-8")):
            lines = [line.strip() for line in found[0].splitlines()]
            assert all(line.startswith(("//", "/*", "*")) for line in lines), found[0]


def test_all_scripts_styles_and_pages_are_at_most_250_kb_on_their_way(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(resources, "static_dir", lambda: STATIC)
    with running(Settings(data_dir=tmp_path)) as server, client_of(server.address) as client:
        page = client.get("/").text
        sheet = re.findall('rel="stylesheet" href="([^"]+)"', page)[0]
        scripts = [each.relative_to(STATIC).as_posix() for each in STATIC.rglob("*.*js")]
        paths = ["/", sheet, *(f"static/{each}" for each in scripts)]
        assert len(paths) > 100
        sizes = [int(client.get(path).headers["content-length"]) for path in paths]
    assert sum(sizes) <= 250_000
