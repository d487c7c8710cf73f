"""Events: one stream informs every page of changes."""

import json
from contextlib import ExitStack
from typing import Any

import httpx
from sqlalchemy import event

from tests.api.recordings import add_recorded_clip, recording_of
from tests.api.routes.clips.test_clips import CLIPS
from tests.api.running import Running


def test_all_pages_hear_of_changes(client: httpx.Client, server: Running) -> None:
    received: list[tuple[str, dict[str, Any]]] = []
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
                received.append((kind, json.loads(line.removeprefix("data:"))))
                if kind == "clips":
                    break
    assert ("languages", {"id": language["id"]}) in received
    assert received[-1] == ("clips", {"id": clip_id})


def test_the_database_is_read_once_for_all_streams(client: httpx.Client, server: Running) -> None:
    clip_id = add_recorded_clip(server.studio, recording_of("circle"))
    job = client.get(f"{CLIPS}/{clip_id}").json()["job_id"]
    reads: list[str] = []
    engine = server.studio.jobs._database.engine

    @event.listens_for(engine, "before_cursor_execute")
    def count(_connection: Any, _cursor: Any, statement: str, *_: Any) -> None:
        if statement.startswith("SELECT") and "FROM job" in statement:
            reads.append(statement)

    with ExitStack() as opened:
        address = f"{server.address}/api/v1/events"
        streams = [
            opened.enter_context(httpx.stream("GET", address, timeout=60)).iter_lines()
            for _ in range(20)
        ]
        for lines in streams:
            while "listening" not in next(lines):
                pass
        server.studio.broadcast.publish("jobs", id=job, clip_id=clip_id)
        for lines in streams:
            line = next(line for line in lines if line.startswith("data:"))
            assert json.loads(line.removeprefix("data:"))["status"] == "done"
    assert len(reads) == 1
