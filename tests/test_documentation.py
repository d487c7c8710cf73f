"""The documentation's examples run, and what it points to exists."""

import re
import runpy
import tomllib
from importlib.metadata import distribution
from importlib.util import find_spec
from pathlib import Path

import pytest

from app.recognition.gestures.demonstration import MAX_DEMONSTRATIONS
from tests.conftest import ROOT

PAGES = sorted(
    [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"), *(ROOT / "benchmarks").rglob("*.md")]
)
EXAMPLES = [
    pytest.param(
        code,
        id=f"{page.relative_to(ROOT).with_suffix('')}-{number}",
        # Examples that find poses in a video.
        marks=[pytest.mark.slow] if ".mp4" in code else [],
    )
    for page in PAGES
    for number, code in enumerate(re.findall(r"```python\n(.*?)```", page.read_text(), re.DOTALL))
]


@pytest.mark.parametrize("code", EXAMPLES)
def test_an_example_runs(
    code: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    (tmp_path / "languages").symlink_to(ROOT / "languages")
    monkeypatch.chdir(tmp_path)
    script = tmp_path / "example.py"
    script.write_text(code)
    runpy.run_path(str(script))
    assert bool(capsys.readouterr().out) == ("print(" in code)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_inside_the_repository_lead_somewhere(page: Path) -> None:
    links = re.findall(r"\]\(([^)#]+)[^)]*\)", page.read_text())
    inside = [link for link in links if "://" not in link]
    assert [link for link in inside if not (page.parent / link).exists()] == []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_row_of_a_table_has_the_cells_of_its_head(page: Path) -> None:
    text = re.sub(r"```.*?```", "", page.read_text(), flags=re.DOTALL)
    torn = []
    for table in re.findall(r"(?:^\|.*\n)+", text, re.MULTILINE):
        head, *rows = table.splitlines()
        torn += [row for row in rows if _count_cells(row) != _count_cells(head)]
    assert torn == []


def _count_cells(row: str) -> int:
    return len(re.findall(r"(?<!\\)\|", row)) - 1


def test_the_glossary_tells_how_many_demonstrations_a_gesture_may_have() -> None:
    numbers = {"five": 5, "six": 6, "seven": 7, "eight": 8, "nine": 9, "ten": 10}
    (word,) = re.findall(
        r"one is enough, (\w+) are the most", (ROOT / "docs/glossary.md").read_text()
    )
    assert numbers[word] == MAX_DEMONSTRATIONS


def test_constants_of_the_page_that_name_one_of_the_package_equal_it() -> None:
    copied = [
        found
        for script in (ROOT / "static/js").rglob("*.js")
        for found in re.findall(r"const \w+ = (\d+); // `(\w+)` in (\S+\.py)", script.read_text())
    ]
    assert copied
    for value, name, module in copied:
        source = (ROOT / "app/recognition" / module).read_text()
        assert re.search(rf"^{name}(?:: Final)? = {value}$", source, re.MULTILINE), name


def test_extras_modules_and_files_that_commands_name_exist() -> None:
    # The history of changes names commands and files of its time.
    text = "".join(page.read_text() for page in PAGES if page.name != "CHANGELOG.md")
    extras = {
        extra for names in re.findall(r"osg-studio\[(.+?)\]", text) for extra in names.split(",")
    }
    assert extras >= {"robot", "dds"}
    assert extras <= set(distribution("osg-studio").metadata.get_all("Provides-Extra") or [])
    modules = set(re.findall(r"python -m ((?:benchmarks|languages)[.\w]*)", text))
    assert modules
    assert {module for module in modules if find_spec(module) is None} == set()
    files = set(
        re.findall(
            r"(?<![\w/])(?:languages/[\w/-]+|requirements[\w-]*|benchmarks/[\w/-]+|docs/[\w/-]+)"
            r"\.(?:json|mp4|txt|md|py)",
            text,
        )
    )
    assert files
    assert {file for file in files if not (ROOT / file).is_file()} == set()


def test_whatever_is_installed_comes_from_a_release_folder_for_there_is_no_index() -> None:
    text = "".join(page.read_text() for page in PAGES if page.name != "CHANGELOG.md")
    commands = re.findall(r"pip install [^\n`]*osg-studio\[[^\n`]*", text)
    assert len(commands) > 4
    assert [command for command in commands if "--find-links dist" not in command] == []


@pytest.mark.parametrize("page", ["on-the-boat", "bluerov2", "jetson", "laptop"])
def test_what_the_robot_is_said_to_say_is_in_its_source(page: str) -> None:
    text = (ROOT / "docs" / "robots" / f"{page}.md").read_text(encoding="utf-8")
    wrong = text.partition("## When something is wrong")[2]
    lines = re.findall(r"^\| `([^`]+)`", wrong, re.MULTILINE)
    assert len(lines) > 1
    folders = (ROOT / "app", ROOT / "ros2")
    source = " ".join(
        file.read_text("utf-8") for folder in folders for file in folder.rglob("*.py")
    )
    # Python joins strings of several lines.
    source = re.sub(r'"\s+f?"', "", source)
    parts = [part for line in lines for part in re.split(r" ?\.\.\. ?|\d+|\(\w+\)", line)]
    said = [part.strip(" :") for part in parts if len(part.strip(" :")) > 4]
    assert [part for part in said if part not in source] == []


def test_every_voter_is_documented() -> None:
    from app.recognition.gestures.profile import PROFILES

    text = (ROOT / "docs" / "recognizer.md").read_text()
    voters = {voter.name for profile in PROFILES.values() for voter in profile.voters}
    assert {voter for voter in voters if f"`{voter}`" not in text} == set()


def test_every_command_is_documented() -> None:
    from app.cli.application import command_line

    pages = "".join(page.read_text() for page in PAGES)
    names = [
        command.callback.__name__
        for command in command_line.registered_commands
        if command.callback
    ]
    assert [name for name in names if f"osg-studio {name}" not in pages] == []


def test_no_folder_of_pages_is_long_and_every_page_begins_with_its_title() -> None:
    for folder in {page.parent for page in PAGES}:
        assert len([page for page in PAGES if page.parent == folder]) < 20
    for page in PAGES:
        assert page.read_text(encoding="utf-8").startswith("# ")


def test_the_architecture_names_every_layer_in_its_order() -> None:
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["importlinter"]
    page = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    picture = (ROOT / "docs" / "images" / "rooms.svg").read_text(encoding="utf-8")
    layered = {
        container: contract["layers"]
        for contract in contracts["contracts"]
        for container in contract.get("containers", ())
    }
    assert layered.keys() == {"app.recognition", "app.api"}
    for container, layers in layered.items():
        rooms = [re.findall(r"\w+", layer) for layer in layers]
        section = page.split(f"`{container.replace('.', '/')}`", 2)[2].split("## ")[0]
        places = [[section.index(f"`{room}") for room in layer] for layer in rooms]
        assert [sorted(layer) for layer in places] == places
        assert places == sorted(places)
        if container == "app.recognition":
            drawn = re.findall(r'class="n">(\w+)<', picture)
            in_order = [room for layer in rooms for room in layer]
            assert drawn[-len(in_order) :] == in_order
