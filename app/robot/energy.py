"""What energy a machine says it used: RAPL on PCs, tegrastats on Jetsons."""

from __future__ import annotations

import re
import shutil
import subprocess
import threading
import time as clock
from contextlib import suppress
from pathlib import Path
from typing import Final, Protocol

POWERCAP: Final = Path("/sys/class/powercap")
"""Where Linux shows the counters of Intel's and AMD's processors (RAPL)."""

TEGRASTATS: Final = "tegrastats"

INTERVAL_MS: Final = 100
"""Between two lines of tegrastats: a few frames; more often costs energy itself."""

RAIL: Final = re.compile(r"(\w+) (\d+)(?:mW)?/\d+(?:mW)?(?=\s|$)")
"""``NAME now/average`` in milliwatts, with or without the unit."""

WHOLE_BOARD: Final = ("VDD_IN", "POM_5V_IN")
"""Rails that feed all others, where a board measures them; else the others are added up."""


class EnergyMeter(Protocol):
    """Counts energy."""

    name: str
    """What is measured, and by what."""

    def joules(self) -> float:
        """Return the energy used since the meter was made."""
        ...

    def close(self) -> None:
        """Stop counting."""
        ...


class RaplMeter:
    """The energy of all processors of a PC, by their own counters; an `EnergyMeter`.

    Parameters
    ----------
    folder
        Where the system shows them.

    Raises
    ------
    OSError
        When there are none, or this user may not read them.

    """

    name = "processor packages, RAPL"

    def __init__(self, folder: Path = POWERCAP) -> None:
        packages = [
            zone
            for zone in sorted(folder.glob("*-rapl:*"))
            if (zone / "name").read_text().startswith("package")
        ]
        if not packages:
            raise FileNotFoundError(f"no RAPL counter in {folder}")
        self._counters = [zone / "energy_uj" for zone in packages]
        self._ranges = [int((zone / "max_energy_range_uj").read_text()) for zone in packages]
        self._last = self._read()
        self._microjoules = 0

    def joules(self) -> float:
        """Return the energy used since the meter was made; to be asked before a counter laps."""
        now = self._read()
        for before, after, span in zip(self._last, now, self._ranges, strict=True):
            self._microjoules += (after - before) % (span + 1)
        self._last = now
        return self._microjoules / 1e6

    def close(self) -> None:
        """Do nothing: the counters go on by themselves."""

    def _read(self) -> list[int]:
        return [int(counter.read_text()) for counter in self._counters]


class TegrastatsMeter:
    """The energy of a Jetson, by NVIDIA's tool; an `EnergyMeter`.

    Parameters
    ----------
    command
        The tool.

    Raises
    ------
    OSError
        When it is not there.

    """

    name = "board, tegrastats"

    def __init__(self, command: str = TEGRASTATS) -> None:
        self._joules = 0.0
        self._process = subprocess.Popen(
            [command, "--interval", str(INTERVAL_MS)], stdout=subprocess.PIPE, text=True
        )
        self._thread = threading.Thread(target=self._read, name="tegrastats", daemon=True)
        self._thread.start()

    def joules(self) -> float:
        """Return the energy used since the meter was made, up to the tool's last line."""
        return self._joules

    def close(self) -> None:
        """End the tool."""
        self._process.terminate()
        self._process.wait()
        self._thread.join()

    def _read(self) -> None:
        assert self._process.stdout is not None
        before = clock.monotonic()
        with self._process.stdout as lines:
            for line in lines:
                now = clock.monotonic()
                self._joules += watts_in(line) * (now - before)
                before = now


def watts_in(line: str) -> float:
    """Return the power that a line of tegrastats tells, in watts."""
    rails = {name: int(power) for name, power in RAIL.findall(line)}
    whole = [rails[name] for name in WHOLE_BOARD if name in rails]
    return (whole[0] if whole else sum(rails.values())) / 1000


def energy_meter() -> EnergyMeter | None:
    """Return a meter of this machine, or None where it does not tell."""
    if shutil.which(TEGRASTATS):
        return TegrastatsMeter()
    with suppress(OSError, ValueError):
        return RaplMeter()
    return None
