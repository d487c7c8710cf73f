"""Access: only by our host names, from our own pages, and with the token; websockets too."""

import socket
from collections.abc import Iterator

import httpx
import pytest
from pydantic import SecretStr
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from app.api.middleware.access import COOKIE, MOST_GUESSES
from app.settings import Settings
from app.store import Role, TokenFile
from tests.api.running import Running, assert_problem, client_of, running

LANGUAGES = "/api/v1/languages"
TOKEN = "correct-horse-battery"


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Running]:
    """Return one open server for all tests of this module: refusals change nothing."""
    folder = tmp_path_factory.mktemp("open")
    with running(Settings(data_dir=folder / "data", samples_dir=folder / "none")) as server:
        yield server


@pytest.fixture(scope="module")
def guarded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Running]:
    """Return one server that requires a token."""
    folder = tmp_path_factory.mktemp("guarded")
    settings = Settings(
        data_dir=folder / "data", samples_dir=folder / "none", token=SecretStr(TOKEN)
    )
    with running(settings) as server:
        yield server


@pytest.fixture
def stranger(guarded: Running) -> Iterator[httpx.Client]:
    with client_of(guarded.address) as client:
        yield client


@pytest.mark.parametrize(
    "headers",
    [
        {"Host": "evil.example"},
        {"Host": "evil.example:8000"},
        {"Host": "127.0.0.1.evil.example"},
        {"Host": "localhost@evil.example"},
        {"Host": "evil@127.0.0.1"},
        {"Host": "127.0.0.1@evil.example"},
        {"Host": "evil:secret@localhost:8000"},
        {"Host": "@localhost"},
        {"Host": "localhost."},
        {"Host": "localhost/evil.example"},
        {"Host": "localhost?"},
        {"Host": "localhost:0"},
        {"Host": "localhost:65536"},
        {"Host": "localhost:80:80"},
        {"Host": "localhost, evil.example"},
        {"Host": "[::1%25lo]"},
        {"Host": "[::1]evil"},
        {"Host": ""},
        {"Host": "[::1"},
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
        {"Origin": "http://[::1"},
        {"Origin": "http://127.0.0.1:1"},
        {"Sec-Fetch-Site": "cross-site"},
        {"Sec-Fetch-Site": "same-site"},
        {
            "Sec-Fetch-Site": "cross-site",
            "Sec-Fetch-Mode": "navigate",
            "Sec-Fetch-Dest": "document",
        },
    ],
    ids=str,
)
@pytest.mark.withstands(row="H16")
def test_changes_from_elsewhere_are_refused(client: httpx.Client, headers: dict[str, str]) -> None:
    answer = client.post(LANGUAGES, json={"name": "theirs"}, headers=headers)
    assert_problem(answer, 403, "foreign_origin")
    assert "theirs" not in [language["name"] for language in client.get(LANGUAGES).json()]


@pytest.mark.parametrize(
    "headers",
    [
        {"Host": "evil.example"},
        {"Origin": "http://evil.example"},
        {"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "no-cors", "Sec-Fetch-Dest": "image"},
        {"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "navigate", "Sec-Fetch-Dest": "iframe"},
    ],
    ids=str,
)
@pytest.mark.parametrize("path", [LANGUAGES, "/healthz", "/openapi.json", "/viser/x/", "/nothing"])
@pytest.mark.withstands(row="H16")
def test_other_sites_read_nothing(client: httpx.Client, path: str, headers: dict[str, str]) -> None:
    assert_problem(client.get(path, headers=headers), 403, "foreign_origin")


@pytest.mark.parametrize(
    "headers",
    [
        {},
        {"Sec-Fetch-Site": "same-origin"},
        {"Sec-Fetch-Site": "none"},
        {
            "Sec-Fetch-Site": "cross-site",
            "Sec-Fetch-Mode": "navigate",
            "Sec-Fetch-Dest": "document",
        },
    ],
    ids=str,
)
def test_scripts_our_pages_and_followed_links_are_let_in(
    client: httpx.Client, headers: dict[str, str]
) -> None:
    assert client.get(LANGUAGES, headers=headers).status_code == 200


@pytest.mark.parametrize("host", ["localhost", "LOCALHOST:8000", "127.0.0.1:65535", "[::1]:80"])
def test_our_own_names_are_let_in(client: httpx.Client, host: str) -> None:
    assert client.get(LANGUAGES, headers={"Host": host}).status_code == 200


@pytest.mark.withstands(row="H16")
def test_a_request_with_two_host_names_is_refused(server: Running) -> None:
    request = (
        f"GET {LANGUAGES} HTTP/1.1\r\nHost: localhost\r\nHost: evil.example\r\n"
        "Connection: close\r\n\r\n"
    )
    status, _ = answer_to(server, request)
    assert status in (400, 403)


@pytest.mark.parametrize(
    "lengths",
    [
        "Content-Length: 4\r\nTransfer-Encoding: chunked",
        "Transfer-Encoding: chunked\r\nContent-Length: 15",
        "Content-Length: 4\r\nContent-Length: 15",
        "Content-Length: 4, 15",
    ],
)
def test_a_body_with_two_lengths_is_refused_and_the_connection_closed(
    server: Running, lengths: str
) -> None:
    request = (
        f"POST {LANGUAGES} HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
        f'{lengths}\r\n\r\n11\r\n{{"name": "twice"}}\r\n0\r\n\r\n'
        f"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n"
    )
    status, answer = answer_to(server, request)
    assert status == 400
    assert "connection: close" in answer.lower()
    assert answer.count("HTTP/1.1") == 1


def answer_to(server: Running, request: str) -> tuple[int, str]:
    """Send bytes, and return the status and all that comes until the connection is closed."""
    with socket.create_connection(("127.0.0.1", server.port), timeout=60) as connection:
        connection.sendall(request.encode())
        answer = b"".join(iter(lambda: connection.recv(4096), b"")).decode()
    return int(answer.split()[1]), answer


def test_our_own_page_may_change_things(client: httpx.Client, server: Running) -> None:
    headers = {"Origin": server.address, "Sec-Fetch-Site": "same-origin"}
    assert client.post(LANGUAGES, json={"name": "ours"}, headers=headers).status_code == 201
    by_name = {"Host": f"localhost:{server.port}", "Origin": f"http://localhost:{server.port}"}
    assert client.post(LANGUAGES, json={"name": "ours"}, headers=by_name).status_code == 201


def test_more_host_names_can_be_allowed(settings: Settings) -> None:
    named = settings.model_copy(update={"allowed_hosts": ("dive-box.local",)})
    with running(named) as server, client_of(server.address) as client:
        assert client.get(LANGUAGES, headers={"Host": "dive-box.local:80"}).status_code == 200
        answer = client.get(LANGUAGES, headers={"Host": "dive-box.example"})
        assert_problem(answer, 403, "foreign_origin")


@pytest.mark.parametrize("path", ["/viser/x", "/api/v1/live", "/anything"])
@pytest.mark.withstands(row="H16")
def test_websockets_under_a_host_name_with_a_user_are_refused(server: Running, path: str) -> None:
    with socket.create_connection(("127.0.0.1", server.port)) as connection:
        handshake = (
            f"GET {path} HTTP/1.1\r\nHost: evil@127.0.0.1:{server.port}\r\nUpgrade: websocket\r\n"
            "Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
            "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
        )
        connection.sendall(handshake.encode())
        assert b"403" in connection.recv(4096).split(b"\r\n")[0]


@pytest.mark.parametrize("path", ["/viser/x", "/anything"])
@pytest.mark.parametrize("origin", ["http://evil.example", "null"])
@pytest.mark.withstands(row="H16")
def test_websockets_from_foreign_pages_are_refused(server: Running, path: str, origin: str) -> None:
    address = f"ws://127.0.0.1:{server.port}{path}"
    with (
        pytest.raises(InvalidStatus, match="403"),
        connect(address, additional_headers={"Origin": origin}, proxy=None),
    ):
        pass


@pytest.mark.parametrize("path", [LANGUAGES, "/openapi.json", "/", "/static/x", "/viser/x/"])
def test_without_the_token_nothing_is_told(stranger: httpx.Client, path: str) -> None:
    answer = stranger.get(path)
    assert_problem(answer, 401, "token_required")
    assert answer.headers["www-authenticate"] == "Bearer"


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("Authorization", "Bearer wrong"),
        ("Authorization", TOKEN),
        ("Authorization", f"Basic {TOKEN}"),
        ("Cookie", f"{COOKIE}={TOKEN}"),
        ("Cookie", f"{COOKIE}=\u00e9"),
        ("Cookie", ";;=;"),
    ],
)
def test_a_wrong_token_is_none(stranger: httpx.Client, name: str, value: str) -> None:
    header = (name.encode(), value.encode())
    assert_problem(stranger.get(LANGUAGES, headers=[header]), 401, "token_required")
    assert_problem(stranger.get("/", params={"token": "wrong"}), 401, "token_required")


def test_guesses_are_slowed_and_who_is_let_in_stays_so(settings: Settings) -> None:
    secret = settings.model_copy(update={"token": SecretStr(TOKEN)})
    bearer = {"Authorization": f"Bearer {TOKEN}"}
    with (
        running(secret) as server,
        client_of(server.address) as guest,
        client_of(server.address) as guesser,
    ):
        assert guest.get("/", params={"token": TOKEN}).status_code == 303
        for number in range(MOST_GUESSES):
            wrong = {"Authorization": f"Bearer {number}"}
            assert_problem(guesser.get(LANGUAGES, headers=wrong), 401, "token_required")
        for headers, params in (({"Authorization": "Bearer x"}, {}), ({}, {"token": "x"})):
            refused = guesser.get("/", headers=headers, params=params)
            assert_problem(refused, 429, "too_many_guesses")
            assert refused.headers["retry-after"] == "60"
        # Others may share the address.
        assert guesser.get(LANGUAGES, headers=bearer).status_code == 200
        assert guesser.get("/", params={"token": TOKEN}).status_code == 303
        assert guest.get(LANGUAGES).status_code == 200


def test_a_token_that_a_person_made_up_cannot_be_guessed_from_a_list_of_words(
    settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.api.middleware.access.MOST_OWN_GUESSES", 2 * MOST_GUESSES)
    secret = settings.model_copy(update={"token": SecretStr(TOKEN)})
    named = {"Authorization": f"Bearer {TokenFile(settings.tokens).add('Ada', Role.READ)}"}
    own = {"Authorization": f"Bearer {TOKEN}"}
    with running(secret) as server, client_of(server.address) as guesser:
        for number in range(2 * MOST_GUESSES):
            guesser.get(LANGUAGES, headers={"Authorization": f"Bearer {number}"})
        refused = guesser.get(LANGUAGES, headers=own)
        assert_problem(refused, 429, "too_many_guesses")
        assert refused.headers["retry-after"] == "3600"
        assert guesser.get(LANGUAGES, headers=named).status_code == 200


def test_the_token_in_the_address_becomes_a_cookie_and_leaves_the_address(
    stranger: httpx.Client,
) -> None:
    answer = stranger.get("/", params={"token": TOKEN, "clip": "a b"})
    assert answer.status_code == 303
    assert answer.headers["location"] == "./?clip=a+b"
    cookie = answer.headers["set-cookie"]
    assert "HttpOnly" in cookie
    assert "SameSite=strict" in cookie
    assert TOKEN not in cookie
    assert stranger.get(LANGUAGES).status_code == 200


@pytest.mark.parametrize("shown", [TOKEN, "wrong"])
def test_a_token_leaves_the_address_also_of_who_is_signed_in(guarded: Running, shown: str) -> None:
    with client_of(guarded.address) as guest:
        guest.get("/", params={"token": TOKEN})
        session = dict(guest.cookies)
        answer = guest.get("/", params={"token": shown, "clip": "a b"})
        assert answer.status_code == 303
        assert answer.headers["location"] == "./?clip=a+b"
        assert dict(guest.cookies) == session
        assert guest.get(LANGUAGES).status_code == 200


def test_the_redirect_stays_on_this_server(stranger: httpx.Client) -> None:
    answer = stranger.get(f"{stranger.base_url}//evil.example/", params={"token": TOKEN})
    assert answer.headers["location"] == "./"


def test_websockets_want_the_token_too(guarded: Running) -> None:
    address = f"ws://127.0.0.1:{guarded.port}/viser/x"
    with pytest.raises(InvalidStatus, match="403"), connect(address, proxy=None):
        pass
