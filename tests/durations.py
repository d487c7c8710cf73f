"""Plugin that writes what each test and each fixture took: seconds, and seconds of a processor.

`make durations` loads it. A child process counts for the test or fixture that waits for its end.
The names of the long tests are written beside it; `make check` leaves out those that are listed in
`tests/long_tests.txt`.
"""

import os
from collections import Counter
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from pathlib import Path
from time import monotonic
from typing import Any

import pytest

COLUMNS = ("seconds", "processor", "waiting", "kind", "name")

LONG_SECONDS = 0.3
"""A test is long if all its cases with their own fixtures take more."""

OF_A_TEST = ("test", "function fixture")


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the option that names the file."""
    parser.addoption("--durations-file", type=Path, default=Path("build", "durations.tsv"))


class Durations:
    """Measures in each worker, and collects the lines in the process that writes the file."""

    def __init__(self) -> None:
        self._here: list[tuple[float, float, str, str]] = []
        self.lines: list[tuple[float, float, str, str]] = []
        self._seconds_of_quick: Counter[str] = Counter()

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
        lines = [(*line,) for line in report.durations]
        self.lines += lines
        if not {"slow", "models"} & set(report.keywords):
            of_test = (seconds for seconds, _, kind, _ in lines if kind in OF_A_TEST)
            self._seconds_of_quick[report.nodeid.partition("[")[0]] += sum(of_test)

    def list_long(self) -> list[str]:
        """Return the names of the long tests among those without a mark that leaves them out."""
        took = self._seconds_of_quick
        return sorted(name for name, seconds in took.items() if seconds > LONG_SECONDS)


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
    long = "\n".join(measured.list_long()) + "\n"
    file.with_name("long_tests.txt").write_text(long, encoding="utf-8")
