"""The list of clips: whole, or in pages that a search and the states of jobs narrow."""

from __future__ import annotations

import re

import httpx
import pytest

from app.api.services.running_studio import Studio
from app.store import ClipWithJob, JobStatus
from tests.store.conftest import add_clip

CLIPS = "/api/v1/clips"
NAMES = ("Ölfass.mp4", "reef.mp4", "100%_sure.mp4", "REEF two.mp4", "wreck.mp4")


@pytest.fixture
def added(studio: Studio) -> list[ClipWithJob]:
    """Return clips with these names, newest first."""
    return [add_clip(studio.clips, name=name) for name in NAMES][::-1]


def names(answer: httpx.Response) -> list[str]:
    assert answer.status_code == 200, answer.text
    return [each["name"] for each in answer.json()]


def next_page(answer: httpx.Response) -> str | None:
    found = re.fullmatch(r'<(.*)>; rel="next"', answer.headers.get("Link", ""))
    return None if found is None else found[1]


def test_pages_hold_every_clip_once_though_others_come_and_go(
    client: httpx.Client, studio: Studio, added: list[ClipWithJob]
) -> None:
    whole = client.get(CLIPS)
    assert names(whole) == [*reversed(NAMES)]
    assert "Link" not in whole.headers
    page = client.get(CLIPS, params={"limit": 2})
    assert (names(page), page.headers["X-Total-Count"]) == (["wreck.mp4", "REEF two.mp4"], "5")
    add_clip(studio.clips, name="newer.mp4")
    studio.clips.delete(added[1].clip.id)  # the one that the next page follows
    page = client.get(f"{CLIPS}{next_page(page)}")
    assert names(page) == ["100%_sure.mp4", "reef.mp4"]
    page = client.get(f"{CLIPS}{next_page(page)}")
    assert (names(page), next_page(page)) == (["Ölfass.mp4"], None)
    assert client.get(CLIPS, params={"limit": 2, "after": "none"}).status_code == 404


def test_clips_are_found_by_a_part_of_their_name_in_any_case(
    client: httpx.Client, added: list[ClipWithJob]
) -> None:
    found = client.get(CLIPS, params={"q": "reef", "limit": 1})
    assert names(found) == ["REEF two.mp4"]
    assert names(client.get(f"{CLIPS}{next_page(found)}")) == ["reef.mp4"]
    assert names(client.get(CLIPS, params={"q": "öL"})) == ["Ölfass.mp4"]
    assert names(client.get(CLIPS, params={"q": "0%_S"})) == ["100%_sure.mp4"]
    assert names(client.get(CLIPS, params={"q": "_"})) == ["100%_sure.mp4"]


def test_clips_are_listed_by_the_state_of_their_newest_job_and_by_id(
    client: httpx.Client, studio: Studio, added: list[ClipWithJob]
) -> None:
    for found in added:
        studio.jobs.finish(found.job.id, JobStatus.FAILED, code="decoder", error="broke")
    studio.jobs.retry(added[0].clip.id, "diver")
    assert names(client.get(CLIPS, params={"status": ["queued", "running"]})) == ["wreck.mp4"]
    assert len(names(client.get(CLIPS, params={"status": "failed"}))) == 4
    wanted = [added[2].clip.id, added[0].clip.id, "none"]
    assert names(client.get(CLIPS, params={"id": wanted})) == ["wreck.mp4", "100%_sure.mp4"]


def test_a_page_that_has_not_changed_is_not_sent_again(
    client: httpx.Client, studio: Studio, added: list[ClipWithJob]
) -> None:
    page = client.get(CLIPS, params={"limit": 2})
    known = {"If-None-Match": page.headers["ETag"]}
    assert client.get(CLIPS, params={"limit": 2}, headers=known).status_code == 304
    studio.clips.delete(added[0].clip.id)
    changed = client.get(CLIPS, params={"limit": 2}, headers=known)
    assert names(changed) == ["REEF two.mp4", "100%_sure.mp4"]
