"""Invitations: a link adds takes to one language, within limits, and can do nothing else."""

from __future__ import annotations

import re
import time
from collections.abc import Iterator
from dataclasses import replace
from datetime import timedelta
from itertools import count
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import cv2
import httpx
import numpy as np
import pytest
from pydantic import SecretStr
from sqlalchemy import update

from app.api.http.page_files import InvitationFiles
from app.api.middleware import access
from app.api.middleware.access import MOST_GUESSES
from app.api.services.running_studio import Studio
from app.recognition import Recording
from app.resources import static_dir
from app.settings import Settings
from app.store import Invitation, InvitedTake, Role, TokenFile
from app.store.invitations import MOST_LISTED
from app.store.models import now
from app.ui.qr_code import draw_qr_code
from tests.api.invitations import INVITED, client_with, divers_of, invite, show, token_of
from tests.api.languages import LANGUAGES
from tests.api.recordings import add_recorded_clip, recording_of
from tests.api.running import Running, assert_problem, client_of, running, until

pytestmark = pytest.mark.usefixtures("judged_soon")

ADMIN = "correct-horse-battery"
MOST_BYTES = 2**20
"""Largest clip that the server of these tests takes."""


HOURS = count(1)


@pytest.fixture(autouse=True)
def another_hour(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the server forget the wrong tokens of the test before."""
    passed = 3600 * next(HOURS)
    later = SimpleNamespace(monotonic=lambda: time.monotonic() + passed)
    monkeypatch.setattr(access, "time", later)


@pytest.fixture(scope="module")
def server(settings: Settings) -> Iterator[Running]:
    limits = {"token": SecretStr(ADMIN), "max_clip_bytes": MOST_BYTES}
    with running(settings.model_copy(update=limits)) as server:
        yield server


@pytest.fixture
def tokens(settings: Settings) -> TokenFile:
    return TokenFile(settings.tokens)


@pytest.fixture
def editor(tokens: TokenFile) -> Iterator[str]:
    yield tokens.add("Ada", Role.EDIT)
    if any(each.name == "Ada" for each in tokens.read()):
        tokens.remove("Ada")


@pytest.fixture
def client(server: Running, editor: str) -> Iterator[httpx.Client]:
    with client_with(server, editor) as client:
        yield client


def send(
    guest: httpx.Client, content: bytes = b"", *, label: str = "circle", name: str = "take.mp4"
) -> httpx.Response:
    return guest.post(
        f"{INVITED}/takes", params={"label": label, "diver": "Bo"}, files={"file": (name, content)}
    )


def send_in_chunks(guest: httpx.Client, content: bytes) -> httpx.Response:
    """Send a take whose size is not stated."""
    head = b'--b\r\nContent-Disposition: form-data; name="file"; filename="take.mp4"\r\n\r\n'
    return guest.post(
        f"{INVITED}/takes",
        params={"label": "circle", "diver": "Bo"},
        content=iter([head, content, b"\r\n--b--\r\n"]),
        headers={"Content-Type": "multipart/form-data; boundary=b"},
    )


def assert_closed(answer: httpx.Response, reason: str) -> dict[str, object]:
    problem = assert_problem(answer, 403, "invitation_closed")
    assert problem["reason"] == reason
    return problem


def change(studio: Studio, **values: object) -> None:
    """Change the rows of all invitations."""
    with studio.invitations._database.writing() as session:
        session.execute(update(Invitation).values(**values))


def test_the_link_shows_the_gestures_of_the_language_and_nothing_else(
    client: httpx.Client, guest: httpx.Client, made: dict[str, Any], pool: str
) -> None:
    seen = guest.get(INVITED).json()
    assert (seen["language"], seen["trigger"]) == ("pool", "salute")
    assert [each["label"] for each in seen["gestures"]] == ["circle", "line"]
    assert all(each["image"].startswith("data:image/png;base64,") for each in seen["gestures"])
    assert seen["takes_left"] == made["most_takes"] == 2 * 2 * 3
    assert seen["most_bytes"] == MOST_BYTES
    assert "Ada" not in str(seen)
    # The page of the link is open, and its files; the token is in no address that is sent.
    page = client_of(str(client.base_url))
    assert re.fullmatch(r"http://127\.0\.0\.1:\d+/invitation#[\w-]{32}", made["link"])
    assert "text/html" in page.get("/invitation").headers["content-type"]
    for path in InvitationFiles(static_dir()).files:
        assert page.get(f"/invitation/{path}").status_code == 200, path
    for path in ("js/main.js", "index.html", "../index.html", "%2e%2e/index.html", "js"):
        assert page.get(f"/invitation/{path}").status_code in (401, 404), path


def test_the_page_of_invited_people_may_fetch_what_it_imports_and_no_more() -> None:
    folder = static_dir()
    page = (folder / "invitation-page" / "invitation-page.html").read_text("utf-8")
    needed, queue = set[str](), re.findall(r'"invitation/([^"]+)"', page)
    while queue:
        path = queue.pop()
        if path not in needed:
            needed.add(path)
            text = (folder / path).read_text("utf-8")
            imports = re.findall(r'(?m)(?:^|;)(?:import|export)[^;"]*?from ?"([^"]+)"', text)
            queue += [
                str((folder / path).parent.joinpath(each).resolve().relative_to(folder.resolve()))
                for each in imports
            ]
    assert needed == InvitationFiles(folder).files


def test_its_token_opens_nothing_else(guest: httpx.Client, pool: str) -> None:
    for request in (
        "GET languages",
        "GET clips",
        "GET session",
        "GET events",
        "GET audit",
        "GET ../../static/js/main.js",
        "GET ../../openapi.json",
        "POST clips",
        "POST uploads",
        "POST languages",
        "DELETE languages/{language}",
        "POST languages/{language}/demonstrations",
        "GET languages/{language}/invitations",
        "GET languages/{language}/invitations/x/takes/x",
        "PUT languages/{language}/invitations/x/takes/x",
        "GET languages/{language}/export",
    ):
        method, path = request.format(language=pool).split()
        assert_problem(guest.request(method, f"/api/v1/{path}"), 401, "token_required")


def test_no_other_token_is_an_invitation(
    server: Running, client: httpx.Client, made: dict[str, Any]
) -> None:
    assert_problem(client.get(INVITED), 401, "invitation_unknown")
    wrong = token_of(made)[:-1] + ("a" if token_of(made)[-1] != "a" else "b")
    with client_with(server, wrong) as guest:
        assert_problem(guest.get(INVITED), 401, "invitation_unknown")
        assert_problem(send(guest), 401, "invitation_unknown")
    with client_of(server.address) as nobody:
        assert_problem(nobody.get(INVITED), 401, "invitation_unknown")
    for path in ("/takes/x", "/takes/%0A", "/takes/x/", "/nothing"):
        assert_problem(client.get(INVITED + path), 401, "invitation_unknown")


def test_wrong_invitations_are_counted_and_the_right_one_passes(
    server: Running, guest: httpx.Client
) -> None:
    with client_with(server, "guess") as guesser:
        for _ in range(MOST_GUESSES):
            assert_problem(guesser.get(INVITED), 401, "invitation_unknown")
        refused = guesser.get(INVITED)
        assert_problem(refused, 429, "too_many_guesses")
        assert refused.headers["Retry-After"] == "60"
    assert guest.get(INVITED).status_code == 200


def test_a_session_does_not_count_on_the_page_of_invited_people(server: Running) -> None:
    with client_of(server.address) as browser:
        browser.get("/", params={"token": ADMIN})
        assert browser.get(LANGUAGES).status_code == 200
        assert_problem(browser.get(INVITED), 401, "invitation_unknown")


def test_an_invitation_that_is_over_lets_nobody_in(studio: Studio, guest: httpx.Client) -> None:
    change(studio, expires=now() - timedelta(seconds=1))
    refused = assert_closed(guest.get(INVITED), "expired")
    assert refused["detail"] == "this invitation is over; ask whoever sent it for a new one"
    assert_closed(send(guest), "expired")


def test_a_withdrawn_invitation_lets_nobody_in_and_what_was_sent_is_not_added(
    client: httpx.Client, studio: Studio, guest: httpx.Client, made: dict[str, Any], pool: str
) -> None:
    take = studio.invitations.receive(made["id"], label="circle", diver="Bo", size=1024)
    place = f"{LANGUAGES}/{pool}/invitations/{made['id']}"
    assert client.delete(place).status_code == 204
    assert_closed(guest.get(INVITED), "withdrawn")
    add_recorded_clip(studio, recording_of("circle"), clip_id=take.clip_id)
    until(lambda: studio.invitations.take(made["id"], take.id).status != "waiting")
    (listed,) = client.get(f"{LANGUAGES}/{pool}/invitations").json()
    assert listed["closed"] == "withdrawn"
    assert [each["status"] for each in listed["shown"]] == ["returned"]
    assert divers_of(client, pool, "circle") == [""]


@pytest.mark.parametrize("lowered", [True, False])
def test_it_ends_with_the_right_of_its_maker_to_edit(
    guest: httpx.Client, tokens: TokenFile, lowered: bool
) -> None:
    assert guest.get(INVITED).status_code == 200
    if lowered:
        tokens.add("Ada", Role.READ)
    else:
        tokens.remove("Ada")
    assert_closed(guest.get(INVITED), "withdrawn")
    assert_closed(send(guest), "withdrawn")


def test_it_stays_over_when_the_name_of_its_maker_comes_back(
    guest: httpx.Client, tokens: TokenFile
) -> None:
    tokens.remove("Ada")
    tokens.add("Ada", Role.EDIT)
    assert_closed(guest.get(INVITED), "withdrawn")
    assert_closed(send(guest), "withdrawn")


def test_a_name_that_would_be_shown_otherwise_is_refused(guest: httpx.Client) -> None:
    for diver in ("a\nb", "a\0b", "a\u202eb"):
        asked = {"label": "circle", "diver": diver}
        answer = guest.post(f"{INVITED}/takes", params=asked, files={"file": b"x"})
        assert_problem(answer, 422, "request_invalid")


def test_who_added_takes_to_the_test_set_and_to_practice_is_shown(
    client: httpx.Client, studio: Studio, pool: str
) -> None:
    clip = add_recorded_clip(studio, recording_of("circle"))
    take = {"clip_id": clip, "expected": "circle"}
    tested = client.post(f"{LANGUAGES}/{pool}/test-set", json={"takes": [take]}).json()
    shown = client.post(f"{LANGUAGES}/{pool}/practice", json=take | {"diver": "Bo"}).json()
    assert tested["takes"][0]["added_by"] == shown["take"]["added_by"] == "Ada"


def test_all_open_invitations_are_listed_and_there_are_not_more_than_can_be_looked_through(
    client: httpx.Client, pool: str
) -> None:
    place = f"{LANGUAGES}/{pool}/invitations"
    first = invite(client, pool)
    for _ in range(MOST_LISTED - 1):
        invite(client, pool)
    refused = assert_problem(client.post(place, json={}), 409, "too_many_invitations")
    assert "withdraw one" in str(refused["detail"])
    assert client.delete(f"{place}/{first['id']}").status_code == 204
    invite(client, pool)
    listed = client.get(place).json()
    assert [each["closed"] for each in listed].count(None) == MOST_LISTED
    assert listed[-1]["id"] == first["id"]


def test_it_ends_with_its_language(client: httpx.Client, guest: httpx.Client, pool: str) -> None:
    assert client.delete(f"{LANGUAGES}/{pool}").status_code == 204
    assert_problem(guest.get(INVITED), 404, "not_found")
    assert_problem(send(guest), 404, "not_found")


def test_readers_see_invitations_and_every_editor_withdraws_them(
    server: Running, tokens: TokenFile, made: dict[str, Any], pool: str
) -> None:
    place = f"{LANGUAGES}/{pool}/invitations"
    with client_with(server, tokens.add("Cy", Role.READ)) as reader:
        (listed,) = reader.get(place).json()
        assert {"link", "qr", "sha256"}.isdisjoint(listed)
        assert_problem(reader.post(place, json={}), 403, "role_required")
        assert_problem(reader.delete(f"{place}/{made['id']}"), 403, "role_required")
        take = f"{place}/{made['id']}/takes/x"
        assert_problem(reader.put(take, json={"status": "added"}), 403, "role_required")
    with client_with(server, tokens.add("Di", Role.EDIT)) as editor:
        assert editor.delete(f"{place}/{made['id']}").status_code == 204


def test_limits_that_are_none_are_refused(client: httpx.Client, pool: str) -> None:
    limits = {"days": 31, "people": 8, "takes": 0, "bytes": 0, "gestures": 1}
    for limit in ({"days": 0}, *({name: limits[name]} for name in limits)):
        answer = client.post(f"{LANGUAGES}/{pool}/invitations", json=limit)
        assert_problem(answer, 422, "request_invalid")


def test_a_language_without_gestures_invites_nobody(client: httpx.Client, language_id: str) -> None:
    answer = client.post(f"{LANGUAGES}/{language_id}/invitations", json={})
    assert_problem(answer, 409, "no_gestures")


def test_the_code_is_that_of_the_link(made: dict[str, Any]) -> None:
    assert made["qr"] == draw_qr_code(made["link"])


@pytest.mark.parametrize("token", ["mIlVwjFZ4GUDQRKXSOo83MZQ0T6aEEbv", "A" * 32, "_-z9" * 8])
def test_the_code_holds_the_link(token: str) -> None:
    link = f"http://192.168.1.20:8000/invitation#{token}"
    drawn = draw_qr_code(link)
    side = int(re.findall(r"viewBox=\"0 0 (\d+) ", drawn)[0])
    modules = np.full((side, side), 255, np.uint8)
    for x, y in re.findall(r"M(\d+) (\d+)h1v1", drawn):
        modules[int(y), int(x)] = 0
    assert not (modules[:4] == 0).any()
    # OpenCV's reader misses some sizes, and all sizes of some codes that other readers read: so
    # these links are always the same.
    sizes = (cv2.resize(modules, None, fx=each, fy=each, interpolation=0) for each in range(4, 13))
    assert link in {cv2.QRCodeDetector().detectAndDecode(each)[0] for each in sizes}


def test_a_good_take_is_added_as_the_demonstration_of_its_person(
    client: httpx.Client, studio: Studio, guest: httpx.Client, made: dict[str, Any], pool: str
) -> None:
    take = show(studio, made, recording_of("circle"))
    assert guest.get(f"{INVITED}/takes/{take.id}").json() == {
        "id": take.id,
        "label": "circle",
        "diver": "Bo",
        "status": "added",
        "reason": None,
    }
    assert divers_of(client, pool, "circle") == ["", "Bo"]
    place = f"{LANGUAGES}/{pool}/demonstrations"
    added = client.get(place, params={"label": "circle"}).json()[1]
    assert added["source"]["clip_id"] == take.clip_id
    assert added["source"]["faults"] == []
    newest = client.get(f"{LANGUAGES}/{pool}/revisions").json()[0]
    assert newest["change"] == "Add a demonstration of circle by Bo"
    (entry,) = [each for each in studio.audit.newest(10) if each.request_id == take.id]
    assert (entry.name, entry.address) == ("Ada", "invitation")


def test_a_person_shows_a_gesture_once_and_eight_people_are_enough(
    client: httpx.Client, studio: Studio, guest: httpx.Client, made: dict[str, Any], pool: str
) -> None:
    assert show(studio, made, recording_of("circle")).status == "added"
    again = show(studio, made, recording_of("circle"))
    assert (again.status, again.reason) == ("returned", "Bo has shown circle already.")
    assert_problem(send(guest), 409, "already_shown")
    assert show(studio, made, recording_of("circle"), diver="bo").status == "returned"
    for diver in ("Cy", "Di", "Ed", "Flo", "Gus", "Hal"):
        assert show(studio, made, recording_of("circle"), diver=diver).status == "added"
    ninth = show(studio, made, recording_of("circle"), diver="Ida")
    assert ninth.reason == "8 people have shown circle, which is enough."
    assert len(divers_of(client, pool, "circle")) == 8


def test_a_take_that_was_added_before_the_server_ended_stays_added(
    client: httpx.Client, studio: Studio, made: dict[str, Any], pool: str
) -> None:
    take = show(studio, made, recording_of("circle"))
    with studio.invitations._database.writing() as session:
        unsaid = update(InvitedTake).values(status="waiting", claimed=None)
        session.execute(unsaid)
    until(lambda: studio.invitations.take(made["id"], take.id).status != "waiting")
    assert studio.invitations.take(made["id"], take.id).status == "added"
    assert divers_of(client, pool, "circle") == ["", "Bo"]
    assert studio.clips.get(take.clip_id)


def without_body(recording: Recording) -> Recording:
    return replace(recording, poses=replace(recording.poses, xy=recording.poses.xy * np.nan))


def almost_without_body(recording: Recording) -> Recording:
    """Leave a body in every eighth frame, as the model of the pose finds one in empty water."""
    xy = recording.poses.xy.copy()
    xy[np.arange(len(xy)) % 8 > 0] = np.nan
    return replace(recording, poses=replace(recording.poses, xy=xy))


def without_salutes(recording: Recording) -> Recording:
    return replace(recording, salute=np.zeros_like(recording.salute))


@pytest.mark.parametrize(
    ("recording", "reason"),
    [
        (without_body(recording_of("circle")), "Nobody is seen. Stand so that"),
        (almost_without_body(recording_of("circle")), "Nobody is seen. Stand so that"),
        (without_salutes(recording_of("circle")), "Hand not seen. Show it again nearer."),
        (recording_of("circle", "circle"), "It was shown 2 times. Show it once in each clip."),
        (recording_of(), "Hand not seen."),
    ],
)
def test_a_take_with_a_fault_is_returned_with_the_reason_and_its_clip_goes(
    client: httpx.Client,
    studio: Studio,
    made: dict[str, Any],
    pool: str,
    recording: Recording,
    reason: str,
) -> None:
    take = show(studio, made, recording)
    assert take.status == "returned"
    assert take.reason is not None
    assert take.reason.startswith(reason)
    assert divers_of(client, pool, "circle") == [""]
    until(lambda: take.clip_id not in {each.clip.id for each in studio.clips.all()})


def test_takes_of_a_gesture_that_is_gone_are_returned(
    client: httpx.Client, studio: Studio, guest: httpx.Client, made: dict[str, Any], pool: str
) -> None:
    client.delete(f"{LANGUAGES}/{pool}/gestures", params={"label": "line"})
    assert show(studio, made, recording_of("line"), label="line").status == "returned"
    assert_problem(send(guest, label="line"), 404, "not_found")


def test_a_take_of_another_invitation_is_not_shown(
    server: Running, client: httpx.Client, studio: Studio, made: dict[str, Any], pool: str
) -> None:
    take = show(studio, made, recording_of("circle"))
    with client_with(server, token_of(invite(client, pool))) as other:
        assert_problem(other.get(f"{INVITED}/takes/{take.id}"), 404, "not_found")


def test_what_is_sent_is_within_the_limits_a_video_and_the_makers(
    server: Running, client: httpx.Client, studio: Studio, pool: str, small_clip: Path
) -> None:
    video = small_clip.read_bytes()
    made = invite(client, pool, takes=3, bytes=len(video) + len(b"words"))
    with client_with(server, token_of(made)) as guest:
        wrong = send(guest, b"words", name="notes.txt")
        assert_problem(wrong, 415, "unsupported_media_type")
        told = "notes.txt is no video; record one, or choose another file"
        assert wrong.json()["detail"] == told
        assert_problem(send(guest, b""), 422, "video_unreadable")
        too_much = video + bytes(200_000)
        assert_closed(send(guest, too_much), "used_up")
        assert_problem(send(guest, bytes(MOST_BYTES + 2**17)), 413, "too_large")
        assert_closed(send_in_chunks(guest, too_much), "used_up")
        assert not list((studio.settings.data_dir / "clips").glob("*.part"))
        assert studio.invitations.get(made["id"]).takes == 2
        sent = send(guest, video)
        assert sent.status_code == 202
        assert sent.json()["status"] == "waiting"
        assert_closed(send(guest, video), "used_up")
        clip = studio.clips.get(studio.invitations.take(made["id"], sent.json()["id"]).clip_id).clip
        assert (clip.name, clip.owner) == ("Bo circle.mp4", "Ada")
        place = f"{INVITED}/takes/{sent.json()['id']}"
        until(lambda: guest.get(place).json()["status"] != "waiting")
        assert guest.get(place).json()["status"] == "returned"
    entry = next(each for each in studio.audit.newest(20) if each.path.startswith(INVITED))
    assert (entry.name, entry.method, entry.status) == ("Ada", "POST", 202)
    assert "label=circle" in entry.path
