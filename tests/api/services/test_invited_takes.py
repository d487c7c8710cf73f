"""Invited takes that are doubted: their person is asked, then the owner, and nothing goes live."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import httpx
import pytest
from sqlalchemy import update
from sqlmodel import select

from app.api.services import invited_takes
from app.api.services.running_studio import Studio
from app.store import InvitedTake, Job, NotFound
from app.store.models import ANSWER_TIME, now
from tests.api.invitations import INVITED, client_with, divers_of, invite, show, token_of
from tests.api.languages import LANGUAGES
from tests.api.recordings import add_recorded_clip, recording_of
from tests.api.running import Running, assert_problem, until
from tests.api.shared_server import server, settings
from tests.recognition.damaged_clips import write_clip

__all__ = ["server", "settings"]

pytestmark = pytest.mark.usefixtures("judged_soon")

TAKES, ASKED = f"{INVITED}/takes", {"label": "circle", "diver": "Bo"}
QUESTION = "This looks like 'line'. Is it 'circle'?"


@pytest.fixture
def doubted(studio: Studio, made: dict[str, Any]) -> InvitedTake:
    """Return a line that was sent as a circle."""
    return show(studio, made, recording_of("line"))


@pytest.fixture
def place(pool: str, made: dict[str, Any], doubted: InvitedTake) -> str:
    """Return where the owner decides about it."""
    return f"{LANGUAGES}/{pool}/invitations/{made['id']}/takes/{doubted.id}"


def say(guest: httpx.Client, take: InvitedTake, *, confirmed: bool) -> tuple[str, str | None]:
    """Answer the question about a take, and return its state."""
    answer = guest.put(f"{INVITED}/takes/{take.id}/answer", json={"confirmed": confirmed})
    assert answer.status_code == 200, answer.text
    return answer.json()["status"], answer.json()["reason"]


def revisions_of(client: httpx.Client, language_id: str) -> list[str]:
    return [each["change"] for each in client.get(f"{LANGUAGES}/{language_id}/revisions").json()]


def test_the_take_of_another_gesture_is_asked_about_and_waits_for_the_owner(
    client: httpx.Client, guest: httpx.Client, doubted: InvitedTake, place: str, pool: str
) -> None:
    before = revisions_of(client, pool)
    seen = guest.get(f"{INVITED}/takes/{doubted.id}").json()
    assert (seen["status"], seen["reason"]) == ("asked", QUESTION)
    assert set(seen) == {"id", "label", "diver", "status", "reason"}
    held = ("waiting", "It is read as 'line'. Bo says that it is 'circle'.")
    assert say(guest, doubted, confirmed=True) == held
    assert say(guest, doubted, confirmed=True) == held
    assert revisions_of(client, pool) == before

    added = client.put(place, json={"status": "added"})
    assert (added.json()["status"], added.json()["clip_id"]) == ("added", doubted.clip_id)
    assert client.put(place, json={"status": "added"}).json()["status"] == "added"
    assert divers_of(client, pool, "circle") == ["", "Bo"]
    assert say(guest, doubted, confirmed=False)[0] == "added"
    assert revisions_of(client, pool) == ["Add a demonstration of circle by Bo", *before]

    for _ in range(2):
        assert client.put(place, json={"status": "removed"}).json()["status"] == "removed"
    assert divers_of(client, pool, "circle") == [""]
    assert revisions_of(client, pool)[0] == "Remove the demonstration of circle by Bo"
    assert len(revisions_of(client, pool)) == len(before) + 2
    assert say(guest, doubted, confirmed=True)[0] == "removed"
    assert client.put(place, json={"status": "added"}).json()["status"] == "added"


def test_what_is_not_confirmed_is_returned_and_its_clip_goes(
    client: httpx.Client, guest: httpx.Client, studio: Studio, doubted: InvitedTake, place: str
) -> None:
    for confirmed in (False, False, True):
        assert say(guest, doubted, confirmed=confirmed) == ("returned", "Show it again.")
    with pytest.raises(NotFound):
        studio.clips.get(doubted.clip_id)
    for status in ("added", "removed"):
        assert_problem(client.put(place, json={"status": status}), 409, "take_not_held")


def test_a_take_whose_clip_never_came_is_returned_and_does_not_count(
    studio: Studio, made: dict[str, Any]
) -> None:
    take = studio.invitations.receive(made["id"], label="circle", diver="Bo", size=1024)
    counted = studio.invitations.get(made["id"])
    assert (counted.takes, counted.bytes) == (1, 1024)
    with studio.invitations._database.writing() as session:
        session.execute(update(InvitedTake).values(created=now() - 2 * invited_takes.LOST))
    until(lambda: studio.invitations.take(made["id"], take.id).status == "returned")
    after = studio.invitations.get(made["id"])
    assert (after.takes, after.bytes) == (0, 0)


@pytest.mark.parametrize("confirmed", [True, False])
def test_a_question_that_stays_without_an_answer_waits_for_the_owner(
    client: httpx.Client,
    guest: httpx.Client,
    studio: Studio,
    doubted: InvitedTake,
    place: str,
    confirmed: bool,
) -> None:
    with studio.invitations._database.writing() as session:
        session.execute(update(InvitedTake).values(asked=now() - ANSWER_TIME))
    (listed,) = client.get(place.partition("/takes/")[0].rpartition("/")[0]).json()
    assert [(each["status"], each["reason"]) for each in listed["shown"]] == [("waiting", QUESTION)]
    assert guest.get(f"{INVITED}/takes/{doubted.id}").json()["status"] == "waiting"
    assert say(guest, doubted, confirmed=confirmed)[0] == ("waiting" if confirmed else "returned")


def test_a_take_that_is_like_no_gesture_is_asked_about(
    guest: httpx.Client, studio: Studio, made: dict[str, Any]
) -> None:
    take = show(studio, made, recording_of("corner"), label="line")
    assert (take.status, take.read_as) == ("asked", None)
    assert take.reason == "This does not look like 'line'. Is it 'line'?"
    assert say(guest, take, confirmed=True)[1] == (
        "It is read as no gesture. Bo says that it is 'line'."
    )


def test_a_take_that_is_read_with_doubt_is_added_once_it_is_confirmed(
    client: httpx.Client,
    guest: httpx.Client,
    studio: Studio,
    made: dict[str, Any],
    pool: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(invited_takes, "DOUBT", 1.1)
    take = show(studio, made, recording_of("circle"))
    assert take.reason == "This looks like 'circle', but not clearly. Is it 'circle'?"
    assert divers_of(client, pool, "circle") == [""]
    assert say(guest, take, confirmed=True) == ("added", None)
    assert divers_of(client, pool, "circle") == ["", "Bo"]


def test_the_owner_sees_what_the_language_would_read_with_it(
    client: httpx.Client, studio: Studio, pool: str, place: str, doubted: InvitedTake
) -> None:
    takes = [
        {"clip_id": add_recorded_clip(studio, recording_of(label)), "expected": label}
        for label in ("line", "circle")
    ]
    client.post(f"{LANGUAGES}/{pool}/test-set", json={"takes": takes})
    outlook = client.get(place).json()
    assert outlook["image"].startswith("data:image/png;base64,")
    assert 0 < outlook["start"] < outlook["end"]
    assert (outlook["known"], outlook["repaired"]) == (2, 0)
    assert outlook["broken"] == 1


def test_only_held_takes_of_the_language_can_be_decided_about(
    client: httpx.Client,
    server: Running,
    studio: Studio,
    made: dict[str, Any],
    pool: str,
    doubted: InvitedTake,
    place: str,
) -> None:
    unread = studio.invitations.receive(made["id"], label="circle", diver="Cy", size=1)
    other = client.post(LANGUAGES, json={"name": "reef"}).json()["id"]
    cases = {
        place.replace(doubted.id, unread.id): (409, "take_not_held"),
        place.replace(doubted.id, "x"): (404, "not_found"),
        place.replace(pool, other): (404, "not_found"),
    }
    for address, (status, code) in cases.items():
        assert_problem(client.put(address, json={"status": "added"}), status, code)
        assert_problem(client.get(address), status, code)
    assert_problem(client.put(place, json={"status": "returned"}), 422, "request_invalid")
    with client_with(server, token_of(invite(client, pool))) as stranger:
        answer = stranger.put(f"{INVITED}/takes/{doubted.id}/answer", json={"confirmed": True})
        assert_problem(answer, 404, "not_found")
    assert studio.invitations.take(made["id"], doubted.id).status == "asked"


def test_the_only_demonstration_of_a_gesture_is_not_removed(
    client: httpx.Client, place: str, pool: str
) -> None:
    assert client.put(place, json={"status": "added"}).status_code == 200
    where = f"{LANGUAGES}/{pool}/demonstrations/0"
    assert client.delete(where, params={"label": "circle"}).status_code == 200
    refused = client.put(place, json={"status": "removed"})
    assert_problem(refused, 409, "demonstration_needed")
    assert divers_of(client, pool, "circle") == ["Bo"]


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"size": (4400, 2200), "frames": 1}, "frames are 4400 x 2200 pixels"),
        ({"frames": 70, "times": [*range(70)]}, "more than the limit of 60 s"),
    ],
)
def test_a_take_is_seconds_long_and_its_pictures_are_those_of_a_phone(
    client: httpx.Client, guest: httpx.Client, tmp_path: Path, wrong: dict[str, Any], words: str
) -> None:
    video = write_clip(tmp_path / "take.mp4", **wrong).read_bytes()
    sent = guest.post(TAKES, params=ASKED, files={"file": ("take.mp4", video)})
    refused = assert_problem(sent, 422, "video_unreadable")
    assert words in str(refused["detail"])
    assert client.post("/api/v1/clips", files={"file": ("own.mp4", video)}).status_code == 202


def test_the_job_of_a_take_ends_with_its_invitation(
    client: httpx.Client, studio: Studio, made: dict[str, Any], pool: str
) -> None:
    take = studio.invitations.receive(made["id"], label="circle", diver="Bo", size=1024)
    add_recorded_clip(studio, recording_of("circle"), clip_id=take.clip_id, running=True)
    job = studio.clips.get(take.clip_id).job
    assert client.delete(f"{LANGUAGES}/{pool}/invitations/{made['id']}").status_code == 204
    until(lambda: studio.invitations.take(made["id"], take.id).status == "returned")
    with studio.jobs._database.reading() as session:
        assert session.get_one(Job, job.id).status == "cancelled"


def test_takes_wait_with_those_of_their_invitation(
    client: httpx.Client, guest: httpx.Client, studio: Studio, small_clip: Path
) -> None:
    video = {"file": ("take.mkv", small_clip.read_bytes())}
    sent = guest.post(TAKES, params=ASKED, files=video).json()["id"]
    own = client.post("/api/v1/clips", files=video)
    with studio.jobs._database.reading() as session:
        take = session.get_one(InvitedTake, sent)
        owned = session.get_one(Job, own.json()["job_id"])
        (job,) = session.exec(select(Job).where(Job.clip_id == take.clip_id))
    assert job.client == f"invitation {take.invitation_id}" != owned.client
