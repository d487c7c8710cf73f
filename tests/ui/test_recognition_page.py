"""A recognition as one file: complete, closed, and without markup of its users."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from app.ui.recognition_page import MAX_PICTURES, POLICY, analysis_page
from app.ui.workspace import Range, WorkspaceView
from tests.recognition.damaged_clips import write_clip
from tests.ui.views import view_in


@pytest.fixture
def view(tmp_path: Path) -> WorkspaceView:
    made = view_in(tmp_path, recognised=True, expected="line")
    write_clip(made.video, frames=len(made.recording.poses))
    return made


def page_of(view: WorkspaceView) -> str:
    assert view.recognition is not None
    return analysis_page(view, view.recognition, None)


def recording_in(page: str) -> dict[str, Any]:
    found = re.search(r"id='recording'>(.*?)</script>", page)
    assert found is not None
    recording: dict[str, Any] = json.loads(found[1])
    return recording


def test_the_file_needs_nothing_from_anywhere(view: WorkspaceView) -> None:
    page = page_of(view)
    assert POLICY in page
    assert not re.search(r"(src|href)=[\"'](?!data:)", page)
    assert "http" not in page.replace("http-equiv", "")


def test_the_title_of_a_pair_is_the_question(view: WorkspaceView) -> None:
    assert view.recognition is not None
    asked = view.recognition.model_copy(update={"label": None, "pair": ("circle", "<ring>")})
    page = analysis_page(view, asked, None)
    assert "circle or &lt;ring&gt;?</title>" in page


def test_every_picture_has_its_moment_and_pose(view: WorkspaceView) -> None:
    recording = recording_in(page_of(view))
    shown = Range.of(view)
    assert len(recording["frames"]) == len(recording["times"]) == len(recording["poses"])
    assert 2 <= len(recording["frames"]) <= min(MAX_PICTURES, len(shown.poses))
    assert recording["times"][0] == pytest.approx(float(shown.poses.time[0]), abs=1e-3)
    assert recording["trails"] == [shown.poses.landmarks.index("right_wrist")]


def test_no_name_becomes_markup(view: WorkspaceView) -> None:
    page = page_of(replace(view, title="</script><img src=x onerror=alert(1)>"))
    assert "<img src=x" not in page
    assert page.count("</script>") == 2
