"""Plugin that writes what each test and each fixture took: seconds, and seconds of a processor.

`make durations` loads it. A child process counts for the test or fixture that waits for its end.
"""

import os
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from pathlib import Path
from time import monotonic
from typing import Any

import pytest

COLUMNS = ("seconds", "processor", "waiting", "kind", "name")


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the option that names the file."""
    parser.addoption("--durations-file", type=Path, default=Path("build", "durations.tsv"))


class Durations:
    """Measures in each worker, and collects the lines in the process that writes the file."""

    def __init__(self) -> None:
        self._here: list[tuple[float, float, str, str]] = []
        self.lines: list[tuple[float, float, str, str]] = []

    @contextmanager
    def _measured(self, kind: str, name: str) -> Iterator[None]:
        began, used = monotonic(), sum(os.times()[:4])
        yield
        seconds, processor = monotonic() - began, sum(os.times()[:4]) - used
        self._here.append((seconds, processor, kind, name))

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(
        self, fixturedef: Any, request: pytest.FixtureRequest
    ) -> Generator[None, object, object]:
        """Measure a fixture, without those that it uses."""
        where = request.node.nodeid or "session"
        with self._measured(f"{fixturedef.scope} fixture", f"{where} {fixturedef.argname}"):
            return (yield)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_call(self, item: pytest.Item) -> Generator[None, object, object]:
        """Measure a test itself."""
        with self._measured("test", item.nodeid):
            return (yield)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_teardown(self, item: pytest.Item) -> Generator[None, object, object]:
        """Measure the ends of fixtures after a test."""
        with self._measured("end of fixtures", item.nodeid):
            return (yield)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(self) -> Generator[None, Any, Any]:
        """Send the lines with the report, which goes from a worker to the process that writes."""
        report = yield
        report.durations, self._here = self._here, []
        return report

    def pytest_runtest_logreport(self, report: Any) -> None:
        """Collect the lines of a report."""
        self.lines += [(*line,) for line in report.durations]


def pytest_configure(config: pytest.Config) -> None:
    """Measure from here on."""
    config.pluginmanager.register(Durations(), "tests-durations")


def pytest_unconfigure(config: pytest.Config) -> None:
    """Write the file, longest first, once all workers are done."""
    measured = config.pluginmanager.getplugin("tests-durations")
    if measured is None or hasattr(config, "workerinput"):
        return
    lines = ["\t".join(COLUMNS)]
    for seconds, processor, kind, name in sorted(measured.lines, reverse=True):
        waiting = max(seconds - processor, 0)
        lines.append(f"{seconds:.3f}\t{processor:.3f}\t{waiting:.3f}\t{kind}\t{name}")
    file = config.getoption("--durations-file")
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
