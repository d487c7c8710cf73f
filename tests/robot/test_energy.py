"""Energy: counters that lap, and lines of NVIDIA's tool as the boards print them."""

from __future__ import annotations

import os
import stat
import sys
import time as clock
from contextlib import closing
from pathlib import Path

import pytest

from app.robot.energy import RaplMeter, TegrastatsMeter, parse_watts

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
