"""Workspaces over HTTP: opened per tab, told what to show."""

from pathlib import Path

import httpx
import pytest

from app.api.services.running_studio import Studio
from app.settings import Settings
from tests.api.recordings import add_recorded_clip, recording_of
from tests.api.running import assert_problem, client_of, running

WORKSPACES = "/api/v1/workspaces"


@pytest.fixture
def workspace_id(client: httpx.Client) -> str:
    """Return the id of an open workspace."""
    answer = client.post(WORKSPACES, json={"dark": False})
    assert answer.status_code == 201
    return str(answer.json()["id"])


def test_a_workspace_has_a_page_of_its_own(client: httpx.Client, workspace_id: str) -> None:
    found = client.get(f"{WORKSPACES}/{workspace_id}").json()
    assert found == {"id": workspace_id, "url": f"/viser/{workspace_id}/"}
    page = client.get(found["url"])
    assert page.status_code == 200
    assert page.headers["content-type"].startswith("text/html")


def test_without_a_body_a_workspace_is_dark(client: httpx.Client) -> None:
    assert client.post(WORKSPACES).status_code == 201


def test_a_workspace_shows_a_clip(
    client: httpx.Client, workspace_id: str, circle_clip: str
) -> None:
    view = f"{WORKSPACES}/{workspace_id}/view"
    assert client.put(view, json={"clip_id": circle_clip}).status_code == 204
    shown = client.put(view, json={"clip_id": circle_clip, "start": 0.5, "end": 1.5})
    assert shown.status_code == 204
    assert client.patch(f"{WORKSPACES}/{workspace_id}", json={"dark": True}).status_code == 204


def test_what_is_not_there_cannot_be_shown(
    client: httpx.Client, workspace_id: str, circle_clip: str
) -> None:
    view = f"{WORKSPACES}/{workspace_id}/view"
    assert_problem(client.put(view, json={"clip_id": "none"}), 404, "not_found")
    outside = client.put(view, json={"clip_id": circle_clip, "start": 90, "end": 91})
    assert outside.status_code == 422
    assert "between 90 s and 91 s" in outside.json()["detail"]


@pytest.mark.parametrize(
    "body",
    [
        {},
        {"clip_id": "x" * 65},
        {"clip_id": "x", "start": -1},
        {"clip_id": "x", "end": "soon"},
        {"clip_id": "x", "colour": "red"},
    ],
)
def test_a_malformed_view_is_refused(
    client: httpx.Client, workspace_id: str, body: dict[str, object]
) -> None:
    assert client.put(f"{WORKSPACES}/{workspace_id}/view", json=body).status_code == 422


def test_a_closed_workspace_is_gone(client: httpx.Client, workspace_id: str) -> None:
    assert client.delete(f"{WORKSPACES}/{workspace_id}").status_code == 204
    assert client.get(f"{WORKSPACES}/{workspace_id}").status_code == 404
    assert client.get(f"/viser/{workspace_id}/").status_code == 404
    assert client.delete(f"{WORKSPACES}/{workspace_id}").status_code == 404


def test_a_server_that_ends_closes_its_workspaces(tmp_path: Path) -> None:
    with running(Settings(data_dir=tmp_path / "data", samples_dir=tmp_path)) as server:
        studio: Studio = server.studio
        clip = add_recorded_clip(studio, recording_of("circle"))
        with client_of(server.address) as client:
            name = client.post(WORKSPACES).json()["id"]
            client.put(f"{WORKSPACES}/{name}/view", json={"clip_id": clip})
    with pytest.raises(httpx.ConnectError):
        httpx.get(f"{server.address}/viser/{name}/")
