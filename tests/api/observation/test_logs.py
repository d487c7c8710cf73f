"""Logs: one line an entry whatever clients send, with the ids of request and job."""

from __future__ import annotations

import json
import logging
import os
import signal
import subprocess
import sys
from pathlib import Path

import httpx
import pytest

from app.api.observation.logs import FIELDS, JsonFormatter, TextFormatter, job_id, request_id
from tests.api.running import client_of, until
from tests.api.shared_server import server, settings

__all__ = ["server", "settings"]


def record(message: str, **fields: object) -> logging.LogRecord:
    made = logging.makeLogRecord({"name": "app", "levelname": "INFO", "msg": message})
    setattr(made, FIELDS, fields)
    return made


def test_an_entry_is_one_line_whatever_it_says() -> None:
    request, job = request_id.set("r1"), job_id.set("")
    try:
        line = JsonFormatter().format(record("x\n{}", path="/a\nb"))
        assert "\n" not in line
        content = json.loads(line)
        assert content["message"] == "x\n{}"
        assert (content["path"], content["request_id"]) == ("/a\nb", "r1")
        assert "job_id" not in content
        assert 'path="/a\\nb"' in TextFormatter().format(record("x", path="/a\nb"))
    finally:
        request_id.reset(request)
        job_id.reset(job)


def test_an_exception_is_part_of_its_line() -> None:
    try:
        raise KeyError("gone")
    except KeyError:
        made = record("failed")
        made.exc_info = sys.exc_info()
    assert "KeyError: 'gone'" in json.loads(JsonFormatter().format(made))["exception"]
    assert TextFormatter().format(made).endswith("KeyError: 'gone'")


@pytest.mark.parametrize("given", ["trace-1.2_3", "x" * 64])
def test_an_id_of_the_client_is_taken_over(client: httpx.Client, given: str) -> None:
    answer = client.get("/healthz", headers={"X-Request-ID": given})
    assert answer.headers["x-request-id"] == given


@pytest.mark.parametrize("given", ["", "x" * 65, "a b", 'a"b', "<b>"])
def test_any_other_id_is_replaced(client: httpx.Client, given: str) -> None:
    answer = client.get("/healthz", headers={"X-Request-ID": given})
    assert len(answer.headers["x-request-id"]) == 32
    assert answer.headers["x-request-id"] != client.get("/healthz").headers["x-request-id"]


def test_refusals_of_the_guards_have_an_id_too(client: httpx.Client) -> None:
    answer = client.get("/healthz", headers={"Host": "evil.example"})
    assert answer.status_code == 403
    assert len(answer.headers["x-request-id"]) == 32


@pytest.mark.slow
def test_a_server_logs_requests_and_jobs_as_json(tmp_path: Path, small_clip: Path) -> None:
    settings = {
        "OSG_LOG_FORMAT": "json",
        "OSG_LOG_LEVEL": "info",
        "OSG_DATA_DIR": str(tmp_path / "data"),
        "OSG_SAMPLES_DIR": str(tmp_path / "none"),
    }
    command = [sys.executable, "-m", "app", "serve", "--port", "0", "--no-browser"]
    log = tmp_path / "log"
    with (
        log.open("w") as errors,
        subprocess.Popen(
            command,
            env=os.environ | settings,
            stdout=subprocess.PIPE,
            stderr=errors,
            text=True,
        ) as process,
    ):
        try:
            assert process.stdout is not None
            address = next(
                word for word in process.stdout.readline().split() if word.startswith("http")
            )
            with client_of(address) as client:
                added = client.post(
                    "/api/v1/clips",
                    files={"file": ("a.mp4", small_clip.read_bytes())},
                    headers={"X-Request-ID": "the-upload"},
                ).json()
                job = f"/api/v1/jobs/{added['job_id']}"
                until(lambda: client.get(job).json()["status"] in ("done", "failed"))
                until(lambda: "job ended" in log.read_text())
        finally:
            process.send_signal(signal.SIGTERM)
            process.wait(30)
    entries = [json.loads(line) for line in log.read_text().splitlines()]
    (request,) = [each for each in entries if each.get("request_id") == "the-upload"]
    assert (request["method"], request["path"], request["status"]) == ("POST", "/api/v1/clips", 202)
    (ended,) = [each for each in entries if each["message"] == "job ended"]
    assert ended["job_id"] == added["job_id"]
    assert ended["kind"] == "extraction"
