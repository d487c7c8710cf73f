"""Named tokens: what each role may, quotas, log-out, and the audit log of changes."""

from __future__ import annotations

import hashlib
import hmac
import json
import re
import sqlite3
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from itertools import product
from pathlib import Path
from typing import Any

import httpx
import pytest
from pydantic import SecretStr

from app.api.middleware.access import COOKIE
from app.api.middleware.roles import READING, SAFE_METHODS, needed_role
from app.server import create_app
from app.settings import Settings
from app.store import Role, TokenFile
from tests.api.running import Running, assert_problem, client_of, running
from tests.conftest import ROOT

API = "/api/v1"
LANGUAGES, CLIPS, UPLOADS = f"{API}/languages", f"{API}/clips", f"{API}/uploads"
UNLIMITED = {"quota": None}
ADMIN = "correct-horse-battery"
TUS = {"Tus-Resumable": "1.0.0"}


@pytest.fixture
def guarded(settings: Settings) -> Iterator[Running]:
    """Return a server with one token of its settings; named ones come while it runs."""
    with running(settings.model_copy(update={"token": SecretStr(ADMIN)})) as server:
        yield server


@pytest.fixture
def tokens(settings: Settings) -> TokenFile:
    return TokenFile(settings.tokens)


def client_with(server: Running, token: str) -> httpx.Client:
    headers = {"Authorization": f"Bearer {token}"}
    return client_of(server.address, headers=headers)


def test_a_token_of_the_settings_administers(guarded: Running) -> None:
    with client_with(guarded, ADMIN) as admin:
        session = admin.get(f"{API}/session").json()
        assert session == UNLIMITED | {"name": "admin", "role": "admin", "signed_in": False}
        assert admin.post(LANGUAGES, json={"name": "pool"}).status_code == 201
        assert admin.get(f"{API}/audit").status_code == 200
        assert admin.get("/metrics").status_code == 200


def test_a_reader_reads_and_is_told_why_it_may_not_change(
    guarded: Running, tokens: TokenFile
) -> None:
    with client_with(guarded, tokens.add("Ada", Role.READ)) as reader:
        assert reader.get(LANGUAGES).status_code == 200
        refused = assert_problem(reader.post(LANGUAGES, json={"name": "x"}), 403, "role_required")
        assert "'Ada' has the role read" in str(refused["detail"])
        assert refused["role"] == "edit"
        assert_problem(reader.delete(f"{CLIPS}/x"), 403, "role_required")
        assert_problem(reader.get("/metrics"), 403, "role_required")
        assert_problem(reader.get(f"{API}/audit"), 403, "role_required")
        # Requests that change no shared data.
        answer = reader.post(f"{LANGUAGES}/x/preview", json={"change": {}})
        assert_problem(answer, 404, "not_found")


def test_a_browser_signs_in_and_out(guarded: Running, tokens: TokenFile) -> None:
    secret = tokens.add("Eve", Role.EDIT)
    with client_of(guarded.address) as browser:
        assert browser.get("/", params={"token": secret}).status_code == 303
        session = browser.get(f"{API}/session").json()
        assert session == UNLIMITED | {"name": "Eve", "role": "edit", "signed_in": True}
        assert secret not in str(browser.cookies)
        assert browser.delete(f"{API}/session").status_code == 204
        assert_problem(browser.get(f"{API}/session"), 401, "token_required")


def test_who_reads_tokens_and_database_can_compute_no_session(
    guarded: Running, settings: Settings, tokens: TokenFile
) -> None:
    secret = tokens.add("Eve", Role.EDIT)
    with client_of(guarded.address) as browser:
        browser.get("/", params={"token": secret})
        assert browser.get(f"{API}/session").status_code == 200
    (entry,) = json.loads(settings.tokens.read_text())["tokens"]
    with closing(sqlite3.connect(settings.data_dir / "studio.db")) as database:
        (row,) = database.execute("SELECT id, proof FROM sign_in").fetchall()
    known = [entry["sha256"], *row]
    # The cookie of version 0.2 was made of the digest alone.
    known += [
        hmac.new(each.encode(), b"osg-studio session", hashlib.sha256).hexdigest() for each in known
    ]
    for cookie in known:
        answer = httpx.get(f"{guarded.address}{API}/session", cookies={COOKIE: cookie})
        assert_problem(answer, 401, "token_required")


def test_a_new_token_of_the_settings_ends_the_sessions_of_the_former_one(
    settings: Settings,
) -> None:
    own = settings.model_copy(update={"token": SecretStr(ADMIN)})
    with running(own) as server, client_of(server.address) as browser:
        browser.get("/", params={"token": ADMIN})
        cookie = {COOKIE: browser.cookies[COOKIE]}
    for token, status in ((ADMIN, 200), (f"another {ADMIN}", 401)):
        with running(settings.model_copy(update={"token": SecretStr(token)})) as server:
            answer = httpx.get(f"{server.address}{API}/session", cookies=cookie)
            assert answer.status_code == status


def test_a_session_is_of_a_token_and_not_of_a_name(guarded: Running, tokens: TokenFile) -> None:
    secret = tokens.add("Eve", Role.ADMIN)
    with client_of(guarded.address) as browser:
        browser.get("/", params={"token": secret})
        tokens.add("Eve", Role.READ)
        assert_problem(browser.get(f"{API}/session"), 401, "token_required")


def test_another_token_signs_in_in_place_of_the_former_one(
    guarded: Running, tokens: TokenFile
) -> None:
    with client_of(guarded.address) as browser:
        for name in ("Eve", "Flo"):
            browser.get("/", params={"token": tokens.add(name, Role.READ)})
            assert browser.get(f"{API}/session").json()["name"] == name


@pytest.mark.withstands(row="H29")
def test_when_the_last_token_is_withdrawn_nobody_is_let_in(settings: Settings) -> None:
    tokens = TokenFile(settings.tokens)
    secret = tokens.add("Di", Role.ADMIN)
    with running(settings) as server, client_with(server, secret) as former:
        assert former.get(LANGUAGES).status_code == 200
        tokens.remove("Di")
        paths = (LANGUAGES, "/openapi.json", "/metrics", "/", "/static/x")
        for client, path in product((former, httpx.Client(base_url=server.address)), paths):
            refused = assert_problem(client.get(path), 401, "token_required")
            assert "osg-studio tokens add" in str(refused["detail"])
        assert httpx.post(f"{server.address}{LANGUAGES}", json={}).status_code == 401
        assert httpx.get(f"{server.address}/healthz").status_code == 200
        with client_with(server, tokens.add("Di", Role.ADMIN)) as client:
            assert client.get(LANGUAGES).status_code == 200


@pytest.mark.withstands(row="H29")
def test_a_list_that_is_lost_between_two_starts_lets_nobody_in(settings: Settings) -> None:
    TokenFile(settings.tokens).add("Di", Role.ADMIN)
    with running(settings) as server:
        assert_problem(httpx.get(server.address + LANGUAGES), 401, "token_required")
    settings.tokens.unlink()
    with running(settings) as server:
        assert_problem(httpx.get(server.address + LANGUAGES), 401, "token_required")
        assert_problem(httpx.get(f"{server.address}{API}/audit"), 401, "token_required")
    # The way back that the advice at the start names.
    settings.tokens_seen.unlink()
    with running(settings) as server:
        assert httpx.get(server.address + LANGUAGES).status_code == 200


def test_a_server_for_other_machines_needs_a_token_whatever_becomes_of_the_list(
    settings: Settings,
) -> None:
    TokenFile(settings.tokens).add("Di", Role.ADMIN)
    public = Settings(**settings.model_dump() | {"host": "0.0.0.0"})
    settings.tokens.unlink()
    with running(public) as server:
        assert_problem(httpx.get(server.address + LANGUAGES), 401, "token_required")
        settings.tokens_seen.unlink(missing_ok=True)
        assert_problem(httpx.get(server.address + LANGUAGES), 401, "token_required")


def test_strangers_are_not_told_where_the_list_is(guarded: Running, settings: Settings) -> None:
    settings.tokens.write_text("{")
    answer = httpx.get(guarded.address + LANGUAGES)
    refused = assert_problem(answer, 503, "store_unavailable")
    assert str(settings.data_dir) not in str(refused["detail"])


def test_a_named_token_of_a_reserved_name_lets_nobody_in(
    guarded: Running, settings: Settings, tokens: TokenFile
) -> None:
    secret = tokens.add("Eve", Role.EDIT)
    content = settings.tokens.read_text()
    settings.tokens.write_text(content.replace('"Eve"', '"Admin"'))
    with client_with(guarded, secret) as client:
        assert_problem(client.get(LANGUAGES), 401, "token_required")


def test_without_tokens_everybody_administers(client: httpx.Client) -> None:
    assert client.get(f"{API}/session").json() == {
        "name": "",
        "role": "admin",
        "signed_in": False,
        "quota": None,
    }
    assert client.get("/metrics").status_code == 200
    assert client.get(f"{API}/audit").json() == []


def test_changes_are_noted_by_name_and_refusals_are_not(
    guarded: Running, tokens: TokenFile
) -> None:
    with client_with(guarded, tokens.add("Flo", Role.EDIT)) as editor:
        made = editor.post(
            LANGUAGES, json={"name": "pool"}, headers={"X-Request-ID": "from-flo"}
        ).json()
        place = f"{LANGUAGES}/{made['id']}"
        assert editor.patch(place, json={"wrong": 1}).status_code == 422
        assert editor.delete(place).status_code == 204
        assert editor.get(LANGUAGES).status_code == 200
    with client_with(guarded, tokens.add("Gus", Role.ADMIN)) as admin:
        deleted, added = admin.get(f"{API}/audit").json()
        assert (added["name"], added["role"], added["address"]) == ("Flo", "edit", "127.0.0.1")
        assert (added["method"], added["path"], added["status"]) == ("POST", LANGUAGES, 201)
        assert added["request_id"] == "from-flo"
        assert (deleted["method"], deleted["path"]) == ("DELETE", place)
        older = admin.get(f"{API}/audit", params={"before": deleted["id"]}).json()
        assert older == [added]
        assert admin.get(f"{API}/audit", params={"name": "Gus"}).json() == []
        assert len(admin.get(f"{API}/audit", params={"limit": 1}).json()) == 1
        between = {"since": added["time"], "until": deleted["time"]}
        assert admin.get(f"{API}/audit", params=between).json() == [added]
        for moment in ("0001-01-01T00:00:00+14:00", "2026-11-24T12:00:00"):
            answer = admin.get(f"{API}/audit", params={"since": moment})
            assert_problem(answer, 422, "request_invalid")


@pytest.mark.slow
def test_an_upload_in_parts_is_noted_once(client: httpx.Client, small_clip: Path) -> None:
    content = small_clip.read_bytes()
    headers = TUS | {"Upload-Length": str(len(content))}
    place = client.post(UPLOADS, headers=headers).headers["location"]
    half = len(content) // 2
    for start, part in ((0, content[:half]), (half, content[half:])):
        headers = TUS | {
            "Upload-Offset": str(start),
            "Content-Type": "application/offset+octet-stream",
        }
        assert client.patch(place, content=part, headers=headers).status_code == 204
    noted = [(each["method"], each["path"]) for each in client.get(f"{API}/audit").json()]
    assert noted == [("PATCH", place), ("POST", UPLOADS)]


def upload(client: httpx.Client, clip: Path) -> httpx.Response:
    return client.post(CLIPS, files={"file": ("dive.mp4", clip.read_bytes())})


@pytest.mark.slow
def test_a_quota_of_clips_is_kept_and_deleting_makes_room(
    guarded: Running, tokens: TokenFile, small_clip: Path
) -> None:
    with client_with(guarded, tokens.add("Hal", Role.EDIT, quota_clips=1)) as editor:
        first = upload(editor, small_clip)
        assert first.status_code == 202
        refused = assert_problem(upload(editor, small_clip), 507, "quota_exceeded")
        assert refused["used"] == {"clips": 1, "bytes": small_clip.stat().st_size}
        assert refused["limit"] == 1
        assert editor.get(f"{API}/session").json()["quota"] == {
            "clips": 1,
            "most_clips": 1,
            "bytes": small_clip.stat().st_size,
            "most_bytes": 0,
        }
        headers = TUS | {"Upload-Length": "10"}
        assert_problem(editor.post(UPLOADS, headers=headers), 507, "quota_exceeded")
        assert editor.delete(f"{CLIPS}/{first.json()['id']}").status_code == 204
        assert upload(editor, small_clip).status_code == 202
    with client_with(guarded, ADMIN) as admin:
        assert upload(admin, small_clip).status_code == 202


@pytest.mark.slow
def test_uploads_at_the_same_time_share_one_quota(
    guarded: Running, tokens: TokenFile, small_clip: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    store = guarded.studio.clips.add

    def store_slowly(*clip: Any, **upload: Any) -> Any:
        time.sleep(0.2)
        return store(*clip, **upload)

    monkeypatch.setattr(guarded.studio.clips, "add", store_slowly)
    with (
        client_with(guarded, tokens.add("Jo", Role.EDIT, quota_clips=1)) as editor,
        ThreadPoolExecutor(6) as uploaders,
    ):
        answers = list(uploaders.map(lambda _: upload(editor, small_clip).status_code, range(6)))
        assert sorted(answers) == [202, 507, 507, 507, 507, 507]
        assert len(editor.get(CLIPS).json()) == 1


@pytest.mark.slow
def test_a_quota_of_bytes_counts_what_is_kept_and_what_is_under_way(
    guarded: Running, tokens: TokenFile, small_clip: Path
) -> None:
    size = small_clip.stat().st_size
    secret = tokens.add("Ida", Role.EDIT, quota_bytes=2 * size + 10)
    with client_with(guarded, secret) as editor:
        too_large = TUS | {"Upload-Length": str(3 * size)}
        assert_problem(editor.post(UPLOADS, headers=too_large), 413, "quota_exceeded")
        assert upload(editor, small_clip).status_code == 202
        headers = TUS | {"Upload-Length": str(size)}
        begun = editor.post(UPLOADS, headers=headers)
        assert begun.status_code == 201
        refused = assert_problem(upload(editor, small_clip), 507, "quota_exceeded")
        assert "delete clips" in str(refused["detail"])
        assert len(editor.get(CLIPS).json()) == 1
        editor.delete(begun.headers["location"], headers=TUS)
        assert upload(editor, small_clip).status_code == 202


@pytest.mark.slow
def test_a_quota_of_the_settings_is_for_every_name(settings: Settings, small_clip: Path) -> None:
    limited = settings.model_copy(update={"quota_clips": 1})
    tokens = TokenFile(settings.tokens)
    with running(limited) as server:
        for name in ("Jo", "Kim"):
            with client_with(server, tokens.add(name, Role.EDIT)) as editor:
                assert upload(editor, small_clip).status_code == 202
                assert_problem(upload(editor, small_clip), 507, "quota_exceeded")


def test_every_operation_has_the_role_that_it_needs(settings: Settings) -> None:
    needed = {
        (method.upper(), path): needed_role(method.upper(), re.sub(r"\{.*?\}", "x", path))
        for path, methods in create_app(settings).openapi()["paths"].items()
        for method in methods
    }
    assert {path for (_, path), role in needed.items() if role is Role.ADMIN} == {"/api/v1/audit"}
    reading = {
        f"{method} {path.removeprefix('/api/v1')}"
        for (method, path), role in needed.items()
        if role is Role.READ and method not in SAFE_METHODS
    }
    page = (ROOT / "docs" / "guides" / "administration.md").read_text(encoding="utf-8")
    _, table = page.split("| request below `/api/v1` | effect |")
    assert reading == {*re.findall(r"`([A-Z]+ /\S+)`", table.partition("\n\n")[0])}
    assert not READING.fullmatch("/api/v1/languages/x/gestures")


def test_an_idempotency_key_belongs_to_a_name(
    guarded: Running, tokens: TokenFile, small_clip: Path
) -> None:
    def upload(client: httpx.Client) -> dict[str, Any]:
        files = {"file": ("dive.mp4", small_clip.read_bytes(), "video/mp4")}
        accepted: dict[str, Any] = client.post(
            CLIPS, files=files, headers={"Idempotency-Key": "7f3c"}
        ).json()
        return accepted

    ada, bo = tokens.add("Ada", Role.EDIT), tokens.add("Bo", Role.EDIT)
    with client_with(guarded, ada) as one, client_with(guarded, bo) as other:
        first = upload(one)
        assert upload(one)["id"] == first["id"]
        assert upload(other)["id"] != first["id"]


def test_a_scene_belongs_to_its_name(guarded: Running, tokens: TokenFile) -> None:
    ada, bo = tokens.add("Ada", Role.READ), tokens.add("Bo", Role.READ)
    with client_with(guarded, ada) as one, client_with(guarded, bo) as other:
        made = one.post(f"{API}/workspaces", json={}).json()
        place = f"{API}/workspaces/{made['id']}"
        assert one.get(place).status_code == one.get(made["url"]).status_code == 200
        assert_problem(other.get(place), 404, "not_found")
        assert_problem(other.get(made["url"]), 404, "not_found")
        assert_problem(other.patch(place, json={"dark": False}), 404, "not_found")
        assert_problem(other.delete(place), 404, "not_found")
        assert one.get(place).status_code == 200
