"""One stream tells every page what changed."""

import json
from typing import Any

import httpx

from tests.api.recordings import add_recorded_clip, recording_of
from tests.api.routes.test_clips import CLIPS
from tests.api.running import Running


def test_all_pages_hear_of_changes(client: httpx.Client, server: Running) -> None:
    heard: list[tuple[str, dict[str, Any]]] = []
    with client.stream("GET", "/api/v1/events") as stream:
        lines = stream.iter_lines()
        while "listening" not in next(lines):
            pass
        language = httpx.post(f"{server.address}/api/v1/languages", json={"name": "pool"}).json()
        httpx.patch(f"{server.address}/api/v1/languages/{language['id']}", json={"name": "sea"})
        clip_id = add_recorded_clip(server.studio, recording_of("circle"))
        httpx.delete(f"{server.address}{CLIPS}/{clip_id}")
        kind = ""
        for line in lines:
            kind = line.removeprefix("event:").strip() if line.startswith("event:") else kind
            if line.startswith("data:"):
                heard.append((kind, json.loads(line.removeprefix("data:"))))
                if kind == "clips":
                    break
    assert ("languages", {"id": language["id"]}) in heard
    assert heard[-1] == ("clips", {"id": clip_id})
