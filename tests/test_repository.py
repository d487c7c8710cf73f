"""The checkout: what its files must and must not contain."""

import re
import subprocess
import tomllib
from collections import Counter
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from app import __version__
from tests.conftest import ROOT
from tests.test_packaging import WEB_APP

LOCKS = (
    "requirements.txt",
    "requirements-test.txt",
    "requirements-mediapipe.txt",
    "requirements-robot.txt",
    "requirements-vehicle.txt",
)

# Where packages come from is the user's pip configuration, mirrors and all, never ours. The words
# are put together here, so that this file holds none of them.
HOSTS = (
    ("py" + "pi", "org"),
    ("python" + "hosted", "org"),
    ("ana" + "conda", "org"),
    ("npm" + "js",),
)
INDEX_OPTION = "-".join(("index", "url"))
REGISTRY = re.compile(
    "|".join(
        [*(re.escape(".".join(host)) for host in HOSTS), f"--(extra-)?{INDEX_OPTION}"]
    ).encode()
)

MOST_LINES = 500
"""A file of more lines is seldom about one thing."""

MOST_MODULES = 20
"""A folder of more modules is not taken in at a glance."""

CODE = {".py", ".js"}


def tracked_files() -> list[Path]:
    # safe.directory: in CI the checkout may belong to another user than the one who tests.
    listed = subprocess.run(
        ["git", "-c", "safe.directory=*", "ls-files", "-z"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    if listed.returncode != 0:
        pytest.skip("needs a git checkout: " + listed.stderr.strip())
    return [path for name in listed.stdout.split("\0") if name and (path := ROOT / name).is_file()]


def pins(lock: str) -> dict[str, list[Requirement]]:
    """Pinned requirements of a lock by name; several where platforms differ."""
    found: dict[str, list[Requirement]] = {}
    for line in (ROOT / lock).read_text().splitlines():
        if re.match(r"[a-z0-9]", line):
            requirement = Requirement(line.removesuffix("\\"))
            found.setdefault(canonicalize_name(requirement.name), []).append(requirement)
    return found


def declared(*extras: str) -> list[Requirement]:
    """Return what `pyproject.toml` declares for the core and `extras`."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    lines = [*project["dependencies"]]
    for extra in extras:
        lines += project["optional-dependencies"][extra]
    return [Requirement(line) for line in lines]


def test_no_tracked_file_names_a_package_registry() -> None:
    naming = [path for path in tracked_files() if REGISTRY.search(path.read_bytes())]
    assert naming == []


def test_no_source_file_is_too_long_to_read() -> None:
    too_long = {
        str(path.relative_to(ROOT)): lines
        for path in tracked_files()
        if path.suffix in CODE
        and (lines := len(path.read_text(encoding="utf-8").splitlines())) > MOST_LINES
    }
    assert too_long == {}


@pytest.mark.parametrize("root", ["app", "static", "ros2", "languages", "benchmarks"])
def test_no_folder_has_more_modules_than_can_be_taken_in_at_a_glance(root: str) -> None:
    modules = Counter(
        str(path.parent.relative_to(ROOT))
        for path in tracked_files()
        if path.suffix in CODE
        and path.name != "__init__.py"
        and path.relative_to(ROOT).parts[0] == root
    )
    assert modules
    assert {folder: count for folder, count in modules.items() if count > MOST_MODULES} == {}


@pytest.mark.parametrize("lock", LOCKS)
def test_every_pin_carries_hashes(lock: str) -> None:
    entries = re.split(r"\n(?=[a-z0-9])", (ROOT / lock).read_text())[1:]
    without = [entry.splitlines()[0] for entry in entries if "--hash=sha256:" not in entry]
    assert len(entries) > 20
    assert without == []


@pytest.mark.parametrize(
    ("lock", "extras"),
    [
        ("requirements.txt", ["studio"]),
        ("requirements-test.txt", ["studio", "test"]),
        ("requirements-mediapipe.txt", ["mediapipe"]),
        ("requirements-robot.txt", ["robot"]),
        ("requirements-vehicle.txt", ["robot", "mavlink"]),
    ],
)
def test_a_lock_pins_what_the_project_declares(lock: str, extras: list[str]) -> None:
    pinned = pins(lock)
    stale = [
        str(requirement)
        for requirement in declared(*extras)
        if not any(
            requirement.specifier.contains(specifier.version)
            for pin in pinned.get(canonicalize_name(requirement.name), [])
            for specifier in pin.specifier
        )
    ]
    assert stale == [], "run `make lock`"


def test_the_locks_agree_so_that_what_is_tested_is_what_runs() -> None:
    tested = pins("requirements-test.txt")
    for name, requirements in pins("requirements.txt").items():
        assert [r.specifier for r in tested[name]] == [r.specifier for r in requirements]
    for name, requirements in pins("requirements-mediapipe.txt").items():
        if name in tested:
            assert [r.specifier for r in tested[name]] == [r.specifier for r in requirements]


def chosen(lock: str, python: str, machine: str) -> dict[str, str]:
    """Return the versions that a lock gives Linux with that Python and processor."""
    environment = {
        "python_version": python,
        "python_full_version": f"{python}.0",
        "sys_platform": "linux",
        "platform_machine": machine,
    }
    fitting = [
        (name, str(requirement.specifier))
        for name, requirements in pins(lock).items()
        for requirement in requirements
        if requirement.marker is None or requirement.marker.evaluate(environment)
    ]
    assert len(dict(fitting)) == len(fitting)
    return dict(fitting)


@pytest.mark.parametrize("machine", ["x86_64", "aarch64"])
@pytest.mark.parametrize("python", ["3.10", "3.11", "3.12", "3.13"])
def test_a_robot_gets_what_the_studio_is_tested_with_and_nothing_of_the_web_app(
    python: str, machine: str
) -> None:
    robot = chosen("requirements-robot.txt", python, machine)
    assert robot.keys() >= {canonicalize_name(each.name) for each in declared("robot")}
    assert not robot.keys() & WEB_APP
    if python != "3.10":
        assert robot.items() <= chosen("requirements.txt", python, machine).items()


def test_an_old_name_says_in_which_version_it_goes_and_is_gone_by_then() -> None:
    """The words are "until version 1.2"; "for one more version" would be forgotten."""
    now = tuple(map(int, re.findall(r"\d+", __version__)[:2]))
    for path in sorted((ROOT / "app").rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        assert "one more version" not in text, path
        for major, minor in re.findall(r"until version (\d+)\.(\d+)", text):
            assert now < (int(major), int(minor)), path
