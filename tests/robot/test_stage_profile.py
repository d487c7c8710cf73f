"""The profile: every stage is counted on the same frames, and recognition hardly costs anything."""

from __future__ import annotations

import json
from contextlib import closing
from pathlib import Path

import pytest

from app.recognition.estimation import create_estimator
from app.robot import Listener, open_source
from app.robot.energy import RaplMeter
from app.robot.stage_profile import STAGES, WARM_UP, Cost, StageProfile, StageProfiler
from tests.recognition.damaged_clips import write_clip
from tests.robot.languages import spoken


def test_rates_are_cumulative_and_the_share_is_what_recognition_takes_off() -> None:
    profile = StageProfile(frames=100, takes=1, energy="meter")
    for stage, seconds in zip(STAGES, (1.0, 3.0, 0.5, 0.25, 0.25), strict=True):
        profile.costs[stage] += Cost(seconds, 10 * seconds, 2 * seconds)
    rates = [profile.frames_per_second(stage) for stage in STAGES]
    assert rates == pytest.approx([100, 25, 100 / 4.5, 100 / 4.75, 20])
    assert profile.share == pytest.approx(1 - 4.5 / 5)
    assert profile.joules_per_frame("pose") == pytest.approx(0.4)
    assert profile.processor_share == pytest.approx(2 * 0.5 / (2 * 5))
    assert json.loads(json.dumps(profile.to_dict()))["share_of_recognition"] == profile.share


def test_a_profile_of_nothing_is_empty() -> None:
    assert StageProfile().share == StageProfile().processor_share == 0
    assert StageProfile().joules_per_frame("grab") is None


@pytest.mark.slow
def test_every_frame_passes_every_stage(installed_models: None, tmp_path: Path) -> None:
    clip = write_clip(tmp_path / "dive.mp4", frames=WARM_UP + 5)
    counters = tmp_path / "intel-rapl:0"
    counters.mkdir()
    for name, text in {"name": "package-0", "energy_uj": "5", "max_energy_range_uj": "9"}.items():
        (counters / name).write_text(text)
    with (
        closing(open_source(str(clip))) as source,
        closing(create_estimator(hands="none")) as body,
        closing(create_estimator()) as whole,
    ):
        listener = Listener(spoken("circle"))
        profiler = StageProfiler(body, whole, listener, meter=RaplMeter(tmp_path))
        profile = profiler.run(source, lambda: False)
    assert (profile.frames, profile.takes, len(listener)) == (5, 0, WARM_UP + 5)
    assert all(profile.costs[stage].seconds > 0 for stage in ("grab", "pose", "salute"))
    assert 0 < profile.processor_share < 1
    assert profile.energy == "processor packages, RAPL"
    assert profile.joules_per_frame("recognition") == 0
