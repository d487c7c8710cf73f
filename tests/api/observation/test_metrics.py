"""Metrics: the values that Prometheus scrapes."""

from __future__ import annotations

from pathlib import Path

import httpx
import pytest
from prometheus_client.parser import text_string_to_metric_families

from tests.api.running import Running, until


def scraped(client: httpx.Client) -> dict[tuple[str, tuple[str, ...]], float]:
    answer = client.get("/metrics")
    assert answer.status_code == 200
    assert answer.headers["content-type"].startswith("text/plain")
    return {
        (sample.name, tuple(sample.labels.values())): sample.value
        for family in text_string_to_metric_families(answer.text)
        for sample in family.samples
    }


def test_requests_are_counted_by_route_and_never_by_what_a_client_invents(
    client: httpx.Client,
) -> None:
    for number in range(3):
        client.get(f"/api/v1/clips/{number}")
        client.get(f"/nothing/{number}")
        client.request(f"INVENTED{number}", "/healthz")
    counts = scraped(client)
    assert counts["osg_requests_total", ("GET", "/clips/{clip_id}", "404")] == 3
    assert counts["osg_requests_total", ("GET", "other", "404")] == 3
    routes = {labels for name, labels in counts if name == "osg_requests_total"}
    assert not any("INVENTED" in label for labels in routes for label in labels)
    assert counts["osg_request_seconds_count", ("GET", "other")] == 3


@pytest.mark.slow
def test_jobs_queue_disk_and_connections_are_told(
    client: httpx.Client, server: Running, small_clip: Path
) -> None:
    before = scraped(client)
    assert before["osg_jobs_open", ("queued",)] == before["osg_jobs_open", ("running",)] == 0
    assert before["osg_disk_free_bytes", ()] > 0
    assert before["osg_worker_stalls_total", ()] == 0
    added = client.post("/api/v1/clips", files={"file": ("a.mp4", small_clip.read_bytes())})
    job = f"/api/v1/jobs/{added.json()['job_id']}"
    until(lambda: client.get(job).json()["status"] in ("done", "failed"))
    ended = "done" if client.get(job).json()["status"] == "done" else "failed"
    until(lambda: ("osg_job_seconds_count", ("extraction", ended)) in scraped(client))
    headers = {"Tus-Resumable": "1.0.0", "Upload-Length": "1000"}
    client.post("/api/v1/uploads", headers=headers)
    after = scraped(client)
    assert after["osg_uploads_open", ()] == 1
    assert after["osg_upload_bytes_to_come", ()] == 1000
    until(lambda: scraped(client)["osg_event_loop_lag_seconds_count", ()] > 0)
