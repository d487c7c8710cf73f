"""The layers: which may import which, and the packages that a robot needs."""

import subprocess
import sys
from importlib.metadata import packages_distributions, requires

import pytest
from importlinter.cli import EXIT_STATUS_SUCCESS, lint_imports
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from tests.conftest import ROOT

# Whatever else is installed, these must not be needed to recognise a gesture on a robot.
OPTIONAL_EXTRAS = ("studio", "mediapipe", "test", "dds", "mavlink", "bench")

IMPORT_EVERY_MODULE_OF_THE_CORE = """
import importlib, pkgutil
import app.recognition
for module in pkgutil.walk_packages(app.recognition.__path__, "app.recognition."):
    importlib.import_module(module.name)
"""

WANTED_BY_OPTIONS = {
    "app.robot.publishing.dds",
    "app.robot.mavlink",
}
"""Modules that `osg-studio robot` needs only where it is asked to publish or command."""

SHOW_THE_HELP = """
import app.cli.application
sys.argv[1:] = ["--help"]
app.cli.application.main()
"""


def requirements_of(extra: str) -> set[str]:
    """Names of the distributions that `extra` adds to the core."""
    declared = [Requirement(line) for line in requires("osg-studio") or []]
    core: set[str] = {canonicalize_name(r.name) for r in declared if r.marker is None}
    added: set[str] = {
        canonicalize_name(r.name)
        for r in declared
        if r.marker is not None and r.marker.evaluate({"extra": extra})
    }
    return added - core


def modules_of(distributions: set[str]) -> set[str]:
    """Top-level modules that the installed ones among `distributions` provide."""
    return {
        module
        for module, owners in packages_distributions().items()
        if distributions & {canonicalize_name(owner) for owner in owners}
    }


def run_without(modules: set[str], code: str) -> subprocess.CompletedProcess[str]:
    """Run `code` in a fresh interpreter in which importing any of `modules` fails."""
    absent = f"import sys; sys.modules.update(dict.fromkeys({sorted(modules)!r}))"
    return subprocess.run(
        [sys.executable, "-c", f"{absent}\n{code}"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )


def test_every_import_contract_is_kept(capsys: pytest.CaptureFixture[str]) -> None:
    status = lint_imports(config_filename=str(ROOT / "pyproject.toml"), no_cache=True)
    assert status == EXIT_STATUS_SUCCESS, capsys.readouterr().out


@pytest.mark.slow
def test_the_core_needs_nothing_but_its_own_dependencies() -> None:
    optional = set().union(*map(requirements_of, OPTIONAL_EXTRAS))
    finished = run_without(modules_of(optional), IMPORT_EVERY_MODULE_OF_THE_CORE)
    assert finished.returncode == 0, finished.stderr


@pytest.mark.slow
def test_the_command_line_starts_without_the_web_app_and_what_options_want() -> None:
    finished = run_without(
        modules_of(requirements_of("studio")) | WANTED_BY_OPTIONS,
        SHOW_THE_HELP,
    )
    assert finished.returncode == 0, finished.stderr
    assert "recognize" in finished.stdout


@pytest.mark.slow
def test_recognising_does_not_load_the_model_converter() -> None:
    # onnx and its protobuf cost a robot 60 MB and a second, and are used once, at installation.
    finished = run_without({"onnx"}, "import app.recognition")
    assert finished.returncode == 0, finished.stderr
