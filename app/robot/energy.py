"""Energy meters: read a machine's energy use from RAPL on PCs or tegrastats on Jetsons."""

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
"""Folder of Linux with the energy counters of Intel's and AMD's processors (RAPL)."""

TEGRASTATS: Final = "tegrastats"

INTERVAL_MS: Final = 100
"""Milliseconds between two lines of tegrastats, a few frames; a shorter interval uses energy
itself."""

RAIL: Final = re.compile(r"(\w+) (\d+)(?:mW)?/\d+(?:mW)?(?=\s|$)")
"""Matches ``NAME now/average`` in milliwatts, with or without the unit."""

WHOLE_BOARD: Final = ("VDD_IN", "POM_5V_IN")
"""Rails that feed all others; on a board without them the sum of all rails is used."""


class EnergyMeter(Protocol):
    """Protocol of a meter that counts energy from its creation on."""

    name: str
    """Name of the measured device and of the tool."""

    def read_joules(self) -> float:
        """Return the energy used since the meter was created."""
        ...

    def close(self) -> None:
        """Stop counting."""
        ...


class RaplMeter:
    """Energy of all processors of a PC, from their own counters; an `EnergyMeter`.

    Parameters
    ----------
    folder
        Folder of the counters.

    Raises
    ------
    OSError
        When there are no counters, or this user may not read them.

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

    def read_joules(self) -> float:
        """Return the energy used since creation; call it at least once per wrap of a counter."""
        now = self._read()
        for before, after, span in zip(self._last, now, self._ranges, strict=True):
            self._microjoules += (after - before) % (span + 1)
        self._last = now
        return self._microjoules / 1e6

    def close(self) -> None:
        """Do nothing: the system keeps the counters."""

    def _read(self) -> list[int]:
        return [int(counter.read_text()) for counter in self._counters]


class TegrastatsMeter:
    """Energy of a Jetson, from NVIDIA's tool tegrastats; an `EnergyMeter`.

    Parameters
    ----------
    command
        Name or path of the tool.

    Raises
    ------
    OSError
        When the tool is not installed.

    """

    name = "board, tegrastats"

    def __init__(self, command: str = TEGRASTATS) -> None:
        self._joules = 0.0
        self._process = subprocess.Popen(
            [command, "--interval", str(INTERVAL_MS)], stdout=subprocess.PIPE, text=True
        )
        self._thread = threading.Thread(target=self._read, name="tegrastats", daemon=True)
        self._thread.start()

    def read_joules(self) -> float:
        """Return the energy used since creation, up to the tool's last line."""
        return self._joules

    def close(self) -> None:
        """Stop the tool."""
        self._process.terminate()
        self._process.wait()
        self._thread.join()

    def _read(self) -> None:
        assert self._process.stdout is not None
        before = clock.monotonic()
        with self._process.stdout as lines:
            for line in lines:
                now = clock.monotonic()
                self._joules += parse_watts(line) * (now - before)
                before = now


def parse_watts(line: str) -> float:
    """Return the power in a line of tegrastats, in watts."""
    rails = {name: int(power) for name, power in RAIL.findall(line)}
    whole = [rails[name] for name in WHOLE_BOARD if name in rails]
    return (whole[0] if whole else sum(rails.values())) / 1000


def open_energy_meter() -> EnergyMeter | None:
    """Open the energy meter of this machine; None where it has none."""
    if shutil.which(TEGRASTATS):
        return TegrastatsMeter()
    with suppress(OSError, ValueError):
        return RaplMeter()
    return None
