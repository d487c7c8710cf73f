"""The packages: as colcon, rosdep and every supported distribution expect them."""

from __future__ import annotations

import ast
import re
import runpy
from pathlib import Path
from typing import Any

import pytest
import yaml
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from tests.ros2.workspace import NODES, PACKAGES, ROOT

DISTRIBUTIONS = (
    Stores.ROS2_HUMBLE,
    Stores.ROS2_JAZZY,
    Stores.ROS2_KILTED,
    Stores.ROS2_LYRICAL,
)
MESSAGES = [PACKAGES / "osg_interfaces", PACKAGES / "keypoints_interfaces"]
PUBLISHED = {
    "HandKeypoints": ["string name", "float32 x", "float32 y", "float32 z"],
    "HandKeypointsArray": ["HandKeypoints[] keypoints"],
    "PoseKeypoints": ["string name", "float32 x", "float32 y"],
    "PoseKeypointsArray": ["PoseKeypoints[] keypoints"],
}
"""The published port's definitions, field by field: what makes ours a replacement."""


@pytest.mark.parametrize("package", [*MESSAGES, NODES], ids=lambda path: path.name)
def test_a_package_describes_itself_without_fault_or_warning(package: Path) -> None:
    parse = pytest.importorskip("catkin_pkg.package")
    warnings: list[str] = []
    described = parse.parse_package(package, warnings=warnings)
    described.validate(warnings=warnings)
    assert warnings == []
    assert described.package_format == 3
    assert described.name == package.name
    assert described.licenses == ["Apache-2.0"]


@pytest.mark.parametrize("package", MESSAGES, ids=lambda path: path.name)
def test_cmake_generates_every_definition_and_finds_what_is_depended_on(package: Path) -> None:
    parse = pytest.importorskip("catkin_pkg.package")
    cmake = (package / "CMakeLists.txt").read_text(encoding="utf-8")
    generated = re.findall(r'"((?:msg|srv)/\w+\.(?:msg|srv))"', cmake)
    present = [path.relative_to(package).as_posix() for path in package.glob("*/*.*")]
    assert sorted(generated) == sorted(present)
    depended = parse.parse_package(package).buildtool_depends
    depended += parse.parse_package(package).build_depends
    found = set(re.findall(r"find_package\((\w+) REQUIRED\)", cmake))
    assert found == {dependency.name for dependency in depended}


@pytest.mark.parametrize("distribution", DISTRIBUTIONS, ids=lambda store: store.name)
def test_every_definition_is_one_in_every_distribution(distribution: Stores) -> None:
    store = get_typestore(distribution)
    types: dict[str, Any] = {}
    for package in MESSAGES:
        for path in package.glob("msg/*.msg"):
            name = f"{package.name}/msg/{path.stem}"
            types |= get_types_from_msg(path.read_text(encoding="utf-8"), name)
        for path in package.glob("srv/*.srv"):
            request, response = path.read_text(encoding="utf-8").split("\n---\n")
            for part, text in (("Request", request), ("Response", response)):
                types |= get_types_from_msg(text, f"{package.name}/srv/{path.stem}_{part}")
    store.register(types)
    for name in types:
        # Its hash needs every field's type, down to the last one.
        assert store.hash_rihs01(name).startswith("RIHS01_")


def test_the_published_messages_are_exactly_those() -> None:
    folder = PACKAGES / "keypoints_interfaces" / "msg"
    ours = {path.stem: path.read_text().splitlines() for path in folder.glob("*.msg")}
    assert ours == PUBLISHED


def setup_arguments() -> dict[str, Any]:
    """Return what setup.py passes on, as setuptools sees it."""
    given: dict[str, Any] = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("setuptools.setup", lambda **arguments: given.update(arguments))
        patch.chdir(NODES)
        runpy.run_path(str(NODES / "setup.py"))
    return given


def test_every_executable_is_a_main_function() -> None:
    scripts = setup_arguments()["entry_points"]["console_scripts"]
    assert len(scripts) == 7
    for script in scripts:
        module, function = script.split(" = ")[1].split(":")
        source = (NODES / f"{module.replace('.', '/')}.py").read_text(encoding="utf-8")
        defined = {each.name for each in ast.walk(ast.parse(source)) if hasattr(each, "name")}
        assert function in defined


def test_everything_that_is_read_at_run_time_is_installed() -> None:
    given = setup_arguments()
    installed = {file for _, files in given["data_files"] for file in files}
    assert installed == {
        "resource/osg_ros",
        "package.xml",
        "config/gestures.yaml",
        "launch/gestures.launch.py",
        "launch/separate_nodes.launch.py",
    }
    assert all((NODES / file).is_file() for file in installed)


def test_the_versions_agree() -> None:
    parse = pytest.importorskip("catkin_pkg.package")
    versions = {parse.parse_package(package).version for package in (*MESSAGES, NODES)}
    assert versions == {setup_arguments()["version"]}


def test_the_parameter_file_names_parameters_that_exist() -> None:
    content = yaml.safe_load((NODES / "config" / "gestures.yaml").read_text(encoding="utf-8"))
    named = set(content["/**"]["ros__parameters"])
    declared = set()
    for path in (NODES / "osg_ros").rglob("*.py"):
        declared |= set(re.findall(r'Setting\(\s*"(\w+)"', path.read_text(encoding="utf-8")))
    assert named <= declared
    assert declared - named == {"language", "autostart", "input", "image_width", "image_height"}


def documentation() -> str:
    """Return the text of the pages about the ROS 2 nodes."""
    pages = sorted((ROOT / "docs" / "robots").glob("ros2-*.md"))
    return "".join(page.read_text(encoding="utf-8") for page in pages)


def test_what_the_documentation_runs_exists() -> None:
    page = documentation()
    scripts = setup_arguments()["entry_points"]["console_scripts"]
    executables = {script.split(" = ")[0] for script in scripts}
    launching = (NODES / "osg_ros" / "launch_arguments.py").read_text(encoding="utf-8")
    run = re.findall(r"^ros2 run osg_ros (\w+)", page, re.MULTILINE)
    launched = re.findall(r"^ros2 launch osg_ros (\S+)(.*)$", page, re.MULTILINE)
    assert run
    assert set(run) <= executables
    assert {file for file, _ in launched} == {path.name for path in NODES.glob("launch/*.py")}
    for _, arguments in launched:
        for name in re.findall(r"(\w+):=", arguments):
            assert f'"{name}"' in launching


def test_every_topic_that_a_node_publishes_is_documented() -> None:
    page = documentation()
    for path in (NODES / "osg_ros").rglob("*.py"):
        source = path.read_text(encoding="utf-8")
        topics = re.findall(r'\.publisher\(\s*[^,]+,\s*f?"([^"]+)"', source)
        assert [
            topic for topic in topics if f"`{topic.replace('{DIVER}', 'diver')}`" not in page
        ] == []


@pytest.mark.parametrize("path", sorted(NODES.rglob("*.py")), ids=lambda path: path.name)
def test_the_nodes_are_written_for_the_python_of_humble(path: Path) -> None:
    ast.parse(path.read_text(encoding="utf-8"), feature_version=(3, 10))


def test_the_command_node_needs_ros_alone() -> None:
    seen, waiting = set(), ["nodes.command_node"]
    while waiting:
        name = waiting.pop()
        seen.add(name)
        source = (NODES / "osg_ros" / f"{name.replace('.', '/')}.py").read_text(encoding="utf-8")
        assert not re.search(r"^(from|import) app\b", source, re.MULTILINE), name
        found = re.findall(r"^from osg_ros\.([\w.]+) import", source, re.MULTILINE)
        waiting += [each for each in found if each not in seen]
    assert len(seen) > 3


def test_the_packages_are_no_part_of_the_wheel() -> None:
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert 'only-include = ["app", "static", "languages"]' in text
