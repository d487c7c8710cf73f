"""Fixtures that several parts of the suite share."""

import gc
import os
from collections import Counter
from collections.abc import Callable, Collection, Iterator
from pathlib import Path
from typing import get_args

import pytest
from hypothesis import settings
from xdist.remote import Producer  # type: ignore[import-untyped]
from xdist.scheduler import LoadFileScheduling  # type: ignore[import-untyped]
from xdist.workermanage import WorkerController  # type: ignore[import-untyped]

from app.recognition import Recording
from app.recognition.errors import ModelError
from app.recognition.models.storage import ModelName, model_path
from tests.command_line import OsgStudio
from tests.postgres import Cluster, postgres_cluster
from tests.s3 import S3Server, s3_server
from tests.short_clips import thinned

# An example takes as long as a loaded machine needs.
settings.register_profile("without a deadline", deadline=None)
settings.load_profile("without a deadline")

ROOT = Path(__file__).resolve().parents[1]
RECORDINGS = ROOT / "tests" / "recordings"
"""Landmarks of the sample clips as `languages.record` wrote them, one folder a processor."""

PROCESSORS = ("avx2", "avx512")
"""Processors that round differently: results equal on both do not depend on rounding."""

UPDATES_IMAGES = bool(os.environ.get("OSG_UPDATE_IMAGES"))
"""Whether the pictures that tests take go into the documentation."""

WITHOUT_BROWSER = "needs Chromium: apt-get install chromium"
"""Why a test in a browser is left out."""

SHARED_DATA = Path(os.environ.get("OSG_SHARED_DATA", ROOT.parent / "shared" / "data"))


GIB = 2**30

WORKER_GIB = 2
"""Memory of a worker with a server that finds poses, and a browser."""


def workers(cores: int, memory: int) -> int:
    """Return how many workers test at once, on a machine with some cores and bytes of memory.

    More than cores, for tests wait; half of them take the tests with a browser (`TwoGroups`).
    """
    return max(1, min(2 * cores, memory // (WORKER_GIB * GIB)))


def pytest_xdist_auto_num_workers(config: pytest.Config) -> int:
    """Choose the workers by what the machine or its container has; of `-n logical`, one a core."""
    from dask.system import CPU_COUNT
    from distributed.system import MEMORY_LIMIT

    if config.option.numprocesses == "logical":
        return CPU_COUNT
    return workers(CPU_COUNT, MEMORY_LIMIT)


WITH_BROWSER = "tests/browser/"

LONG_TESTS = frozenset((ROOT / "tests" / "long_tests.txt").read_text("utf-8").splitlines())
"""Names of the tests that are too long for `make check`; `tests.durations` wrote them."""


class TwoGroups(LoadFileScheduling):  # type: ignore[misc]
    """Gives half of the workers the files with a browser first, the others the rest.

    A browser computes as long as it is open: several on one core slow each other down. Most other
    tests wait, for processes and links.
    """

    def _assign_work_unit(self, node: WorkerController) -> None:
        nodes = self.nodes
        browses = 2 * nodes.index(node) < len(nodes)
        self.workqueue.move_to_end(choose_file(self.workqueue, browses=browses), last=False)
        super()._assign_work_unit(node)


def choose_file(files: Collection[str], *, browses: bool) -> str:
    """Return the first file of a worker's own group, the first of all where none is left."""
    own = (file for file in files if file.startswith(WITH_BROWSER) is browses)
    return next(own, next(iter(files)))


def pytest_xdist_make_scheduler(config: pytest.Config, log: Producer) -> LoadFileScheduling | None:
    """Distribute files by `TwoGroups`; anything else as xdist does."""
    return TwoGroups(config, log) if config.option.dist == "loadfile" else None


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """List the reasons for which tests were left out, each in one line."""
    for reason, count in _left_out(terminalreporter).most_common():
        terminalreporter.write_line(f"left out {count}: {reason}")


LINES_OF_ERROR = 16
_internal_errors: list[str] = []


def pytest_internalerror(excrepr: object) -> None:
    """Keep what went wrong in pytest itself, or in a worker between two tests."""
    _internal_errors.append(str(excrepr))


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_sessionfinish(session: pytest.Session) -> Iterator[None]:
    """End with the first internal error and how to bring the browser tests, after pytest's line."""
    yield
    reporter = session.config.pluginmanager.get_plugin("terminalreporter")
    if not isinstance(reporter, pytest.TerminalReporter):
        return
    # What follows from it is printed after it, and a log is read from its end.
    for error in _internal_errors[:1]:
        reporter.write_line("the first internal error ends with:")
        for line in error.splitlines()[-LINES_OF_ERROR:]:
            reporter.write_line(line)
    if _left_out(reporter)[WITHOUT_BROWSER]:
        count, command = _left_out(reporter)[WITHOUT_BROWSER], WITHOUT_BROWSER.partition(": ")[2]
        reporter.write_line(f"{count} browser tests were left out; this brings them: {command}")


def _left_out(reporter: pytest.TerminalReporter) -> Counter[str]:
    """Count the tests that were skipped, by reason."""
    reports = reporter.stats.get("skipped", [])
    return Counter(str(report.longrepr[2]).removeprefix("Skipped: ") for report in reports)


def pytest_collection() -> None:
    """Disable garbage collection while tests are collected, since these objects stay to the end.

    It would take a fifth of the collection's time, and more in each test that makes much garbage.
    """
    gc.disable()


def pytest_collection_finish() -> None:
    """Enable garbage collection for objects of the tests."""
    gc.freeze()
    gc.enable()


def pytest_itemcollected(item: pytest.Item) -> None:
    """Mark tests that need models, as slow those that use PostgreSQL or S3, and those listed."""
    fixtures = getattr(item, "fixturenames", ())
    if "postgresql" in item.name or "s3" in fixtures:
        item.add_marker("slow")
    if "installed_models" in fixtures:
        item.add_marker("models")
    if item.nodeid.partition("[")[0] in LONG_TESTS:
        item.add_marker("long")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Sort the files that take long to the front, so that no worker is left with one at the end.

    Files with a time limit of their own take minutes and come first; then come the parts of the
    suite, and in them the folders, with most slow tests first.
    """
    tests = ROOT / "tests"
    # The tests of one part stay together, so that a browser is started only once.
    parts = {item: item.path.relative_to(tests).parts[0] for item in items}
    slow = Counter(parts[item] for item in items if item.get_closest_marker("slow"))
    in_folder = Counter(item.path.parent for item in items if item.get_closest_marker("slow"))
    items.sort(
        key=lambda item: (
            not item.get_closest_marker("timeout"),
            -slow[parts[item]],
            parts[item],
            -in_folder[item.path.parent],
        )
    )


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """Return the folder of real recordings by other people; skip if it is missing."""
    if not SHARED_DATA.is_dir():
        pytest.skip(f"needs the shared recordings, and there is no {SHARED_DATA}")
    return SHARED_DATA


@pytest.fixture(scope="session")
def sample_clips() -> Path:
    """Return the folder of our own rendered sample clips."""
    return ROOT / "languages" / "clips"


@pytest.fixture(scope="session")
def installed_models() -> None:
    """Skip where the models are not installed; `make test` installs them first."""
    try:
        for name in get_args(ModelName):
            model_path(name)
    except ModelError as error:
        pytest.skip(f"needs the pose and hand models: {error}")


@pytest.fixture(scope="session")
def thin_clip(
    sample_clips: Path, installed_models: None, tmp_path_factory: pytest.TempPathFactory
) -> Callable[[str], Path]:
    """Return a function that copies every third frame of a sample clip, given its name.

    Its poses are found in a third of the time; takes and gestures are the same. The documentation's
    images show the whole clip.
    """
    folder = tmp_path_factory.mktemp("thin")

    def make(name: str) -> Path:
        if UPDATES_IMAGES:
            return sample_clips / f"{name}.mp4"
        copy = folder / f"{name}.mp4"
        return copy if copy.exists() else thinned(sample_clips / copy.name, copy)

    return make


@pytest.fixture(scope="session", params=PROCESSORS)
def sample_recording(request: pytest.FixtureRequest) -> Callable[[str], Recording]:
    """Return a function that loads the landmark recording of a sample clip by the clip's name.

    A test that uses it runs once for each processor on which the clips were recorded.
    """
    folder = RECORDINGS / request.param
    return lambda name: Recording.load(folder / f"{name}.npz")


@pytest.fixture
def osg_studio(capsys: pytest.CaptureFixture[str]) -> OsgStudio:
    """Return a runner of command lines, which reports how each ended."""
    return OsgStudio(capsys)


@pytest.fixture(scope="session")
def postgres() -> Iterator[Cluster]:
    """Return a PostgreSQL server; skip where none is installed."""
    with postgres_cluster() as cluster:
        yield cluster


@pytest.fixture
def s3(monkeypatch: pytest.MonkeyPatch) -> Iterator[S3Server]:
    """Return an S3 server with an empty bucket, as the environment names it; skip without moto."""
    with s3_server(monkeypatch) as server:
        yield server
