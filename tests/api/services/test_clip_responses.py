"""What the page is told of a clip."""

from __future__ import annotations

import pytest

from app.api.services.clip_responses import view_clip
from app.store import Clip, ClipWithJob, Job


@pytest.mark.parametrize("missing", [[], ["the second one was not seen"]])
@pytest.mark.parametrize("name", ["GX010042.MP4", "dive.mp4"])
def test_a_chapter_without_both_salutes_names_the_next_one(name: str, missing: list[str]) -> None:
    clip = Clip(name=name, size=1, width=64, height=48, media_type="video/mp4")
    job = Job(clip_id=clip.id, client="local", salute_warnings=missing)
    told = " ".join(view_clip(ClipWithJob(clip, job)).salute_warnings)
    assert ("may go on in GX020042.MP4" in told) is (bool(missing) and name != "dive.mp4")
