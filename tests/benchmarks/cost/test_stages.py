"""The profile: every stage is counted on the same frames, and recognition hardly costs anything."""

from __future__ import annotations

import json
import os
import stat
import sys
import time as clock
from contextlib import closing
from pathlib import Path

import pytest

from app.recognition.estimation.factory import create_estimator
from app.resources import samples_dir
from app.robot import TriggerListener, open_source
from benchmarks.cost.stages import (
    STAGES,
    WARM_UP,
    Cost,
    RaplMeter,
    StageProfile,
    StageProfiler,
    TegrastatsMeter,
    main,
    parse_watts,
)
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
        listener = TriggerListener(spoken("circle"))
        profiler = StageProfiler(body, whole, listener, meter=RaplMeter(tmp_path))
        profile = profiler.run(source, lambda: False)
    assert (profile.frames, profile.takes, len(listener)) == (5, 0, WARM_UP + 5)
    assert all(profile.costs[stage].seconds > 0 for stage in ("grab", "pose", "salute"))
    assert 0 < profile.processor_share < 1
    assert profile.energy == "processor packages, RAPL"
    assert profile.joules_per_frame("recognition") == 0


ORIN = (
    "11-21-2026 13:00:01 RAM 3122/7620MB (lfb 3x4MB) SWAP 0/3810MB (cached 0MB) "
    "CPU [12%@1510,0%@1510,off,off] EMC_FREQ 0% GR3D_FREQ 35% cpu@48.5C soc2@47.6C "
    "VDD_IN 5120mW/4966mW VDD_CPU_GPU_CV 1203mW/1100mW VDD_SOC 1402mW/1390mW"
)
XAVIER = (
    "RAM 2454/15700MB (lfb 2771x4MB) SWAP 0/7850MB (cached 0MB) CPU [0%@1190,off] EMC_FREQ 0% "
    "GR3D_FREQ 0% AO@35C GPU 310/155 CPU 622/544 SOC 932/932 CV 0/0 VDDRQ 155/155 SYS5V 2085/2000"
)


def counter(folder: Path, number: int, microjoules: int, name: str = "package-0") -> Path:
    zone = folder / f"intel-rapl:{number}"
    zone.mkdir()
    (zone / "name").write_text(f"{name}\n")
    (zone / "max_energy_range_uj").write_text("999999\n")
    (zone / "energy_uj").write_text(f"{microjoules}\n")
    return zone / "energy_uj"


def test_counters_are_added_up_and_may_lap(tmp_path: Path) -> None:
    first, second = counter(tmp_path, 0, 900_000), counter(tmp_path, 1, 0)
    counter(tmp_path, 2, 0, name="psys")  # counts the packages once more
    meter = RaplMeter(tmp_path)
    assert meter.read_joules() == 0
    first.write_text("100000\n")
    second.write_text("50000\n")
    assert meter.read_joules() == pytest.approx(0.25)
    assert meter.read_joules() == pytest.approx(0.25)


def test_a_machine_without_counters_says_so(tmp_path: Path) -> None:
    with pytest.raises(OSError, match="no RAPL counter"):
        RaplMeter(tmp_path)


@pytest.mark.parametrize(
    ("line", "watts"), [(ORIN, 5.12), (XAVIER, 4.104), ("RAM 1/2MB", 0.0)], ids=["whole", "sum", ""]
)
def test_power_is_read_from_the_rails(line: str, watts: float) -> None:
    assert parse_watts(line) == pytest.approx(watts)


@pytest.mark.skipif(os.name != "posix", reason="writes a shell script")
def test_power_is_summed_over_time(tmp_path: Path) -> None:
    tool = tmp_path / "tegrastats"
    tool.write_text(
        f"#!{sys.executable}\nimport time\nwhile True:\n"
        f"    print({ORIN!r}, flush=True)\n    time.sleep(0.02)\n"
    )
    tool.chmod(tool.stat().st_mode | stat.S_IXUSR)
    with closing(TegrastatsMeter(str(tool))) as meter:
        began = clock.monotonic()
        while meter.read_joules() == 0:
            clock.sleep(0.01)
        assert 0 < meter.read_joules() <= 5.12 * (clock.monotonic() - began + 1)


@pytest.mark.slow
def test_the_cost_of_each_stage_is_one_object_and_a_table(
    installed_models: None, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    clip = write_clip(tmp_path / "dive.mp4", frames=WARM_UP + 2)
    language = str(samples_dir() / "osg-table-2.json")
    main(["--language", language, "--source", str(clip)])
    printed = capfd.readouterr()
    profile = json.loads(printed.out)
    assert profile["frames"] == 2
    assert [stage["up_to"] for stage in profile["stages"]] == list(STAGES)
    assert "+ recognition" in printed.err
    assert f"2 frames, {profile['takes']} take" in " ".join(printed.err.split())
