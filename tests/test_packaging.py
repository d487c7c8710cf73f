"""The wheel: that an installed package has what a checkout has."""

import subprocess
import sys
import zipfile
from email.message import Message
from email.parser import Parser
from importlib.metadata import distribution
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from tests.conftest import ROOT

WEB_APP = {"fastapi", "starlette", "uvicorn", "viser", "sqlmodel", "sqlalchemy"}


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build the wheel, as `pip wheel` does it, with the build backend that is installed."""
    directory = tmp_path_factory.mktemp("wheel")
    subprocess.run(
        [sys.executable, "-m", "hatchling", "build", "--target", "wheel", "--directory", directory],
        cwd=ROOT,
        check=True,
        capture_output=True,
    )
    (built,) = directory.glob("*.whl")
    return built


@pytest.fixture(scope="module")
def contents(wheel: Path) -> set[str]:
    return set(zipfile.ZipFile(wheel).namelist())


@pytest.fixture(scope="module")
def metadata(wheel: Path) -> Message:
    archive = zipfile.ZipFile(wheel)
    (name,) = [name for name in archive.namelist() if name.endswith(".dist-info/METADATA")]
    return Parser().parsestr(archive.read(name).decode())


def files_below(directory: Path, pattern: str = "**/*") -> set[Path]:
    return {
        path
        for path in directory.glob(pattern)
        if path.is_file() and "__pycache__" not in path.parts
    }


def requirements(metadata: Message, extra: str) -> set[str]:
    """Names of the distributions that installing the wheel with `extra` asks for."""
    lines = metadata.get_all("Requires-Dist") or []
    return {
        canonicalize_name(requirement.name)
        for requirement in map(Requirement, lines)
        if requirement.marker is None or requirement.marker.evaluate({"extra": extra})
    }


def closure(names: set[str]) -> set[str]:
    """`names` and whatever they ask for in turn, among what is installed here."""
    reached: set[str] = set()
    pending = set(names)
    while pending:
        name = pending.pop()
        reached.add(name)
        for line in distribution(name).requires or []:
            requirement = Requirement(line)
            if requirement.marker is None or requirement.marker.evaluate({"extra": ""}):
                pending |= {canonicalize_name(requirement.name)} - reached
    return reached


def test_the_wheel_has_every_file_of_the_package_but_the_bundles(contents: set[str]) -> None:
    expected = {path.relative_to(ROOT).as_posix() for path in files_below(ROOT / "app")}
    expected = {name for name in expected if not name.endswith(".task")}
    assert "app/recognition/models/files/pose_detection.onnx" in expected
    assert expected <= contents
    assert not [name for name in contents if name.endswith(".task")]


def test_the_wheel_has_the_page(contents: set[str]) -> None:
    static = ROOT / "static"
    expected = {f"app/static/{p.relative_to(static).as_posix()}" for p in files_below(static)}
    assert "app/static/index.html" in expected
    assert expected <= contents


def test_the_wheel_has_the_sample_languages_and_their_clips(contents: set[str]) -> None:
    languages = ROOT / "languages"
    samples = files_below(languages, "*.json") | files_below(languages / "clips")
    expected = {f"app/samples/{p.relative_to(languages).as_posix()}" for p in samples}
    assert "app/samples/osg-table-1.json" in expected
    assert expected <= contents


def test_the_wheel_has_nothing_else(contents: set[str]) -> None:
    assert {name.split("/")[0] for name in contents if ".dist-info/" not in name} == {"app"}
    assert not [name for name in contents if name.startswith("app/samples/") and ".py" in name]
    assert not [name for name in contents if "__pycache__" in name]


def test_the_licence_and_its_notices_travel_with_the_wheel(contents: set[str]) -> None:
    assert {Path(name).name for name in contents if "/licenses/" in name} == {"LICENSE", "NOTICE"}


def test_a_robot_installs_no_part_of_the_web_app(metadata: Message) -> None:
    assert "robot" in (metadata.get_all("Provides-Extra") or [])
    assert not closure(requirements(metadata, "robot")) & WEB_APP


def test_the_studio_installs_all_of_the_web_app(metadata: Message) -> None:
    assert closure(requirements(metadata, "studio")) >= WEB_APP


@pytest.mark.slow
def test_the_installed_package_serves_its_own_page_and_samples(wheel: Path, tmp_path: Path) -> None:
    installed = tmp_path / "site-packages"
    zipfile.ZipFile(wheel).extractall(installed)
    serve = f"""
from fastapi.testclient import TestClient
import app
from app.resources import samples_dir
from app.server import create_app
from app.settings import Settings

assert app.__file__.startswith({str(installed)!r}), app.__file__
studio = create_app(Settings(data_dir={str(tmp_path / "data")!r}))
with TestClient(studio, base_url="http://127.0.0.1:8000") as client:
    assert client.get("/healthz").status_code == 200
    assert "<html" in client.get("/").text
    assert samples_dir().is_relative_to({str(installed)!r}), samples_dir()
    languages = client.get("/api/v1/languages").json()
    assert len(languages) == len(list(samples_dir().glob("*.json"))), languages
"""
    # Isolated from the checkout: there `app` would be the one of the working directory.
    finished = subprocess.run(
        [sys.executable, "-c", serve],
        cwd=tmp_path,
        env={"PYTHONPATH": str(installed), "PATH": ""},
        capture_output=True,
        text=True,
        check=False,
    )
    assert finished.returncode == 0, finished.stderr
