"""Container recipes keep what they claim: users, health checks, files, commands, labels."""

from __future__ import annotations

import json
import re
from typing import Annotated, Any, Literal

import cv2
import pytest
from pydantic import BaseModel, ConfigDict, Field, HttpUrl, TypeAdapter
from typer.main import get_command

from app import __version__
from app.cli.application import command_line
from app.robot.publishing.status_page import SERVICE
from tests.conftest import ROOT
from tests.release.containerfile import lineage, read_command, read_labels, read_stages
from tests.test_repository import pins

RECIPE = ROOT / "release" / "containers" / "Containerfile"
STAGES = read_stages(RECIPE)
IMAGES = ["studio", "robot", "blueos"]


@pytest.mark.parametrize("image", IMAGES)
def test_an_image_runs_as_nobody_with_a_health_check_and_a_volume(image: str) -> None:
    stages = lineage(STAGES, image)
    users = [user for stage in stages for user in stage.values("USER")]
    assert users == ["10001:10001"]
    assert [volume for stage in stages for volume in stage.values("VOLUME")] == ["/data"]
    (check,) = [each for stage in stages for each in stage.values("HEALTHCHECK")]
    port = re.search(r"127\.0\.0\.1:(\d+)/healthz", check)
    assert port is not None
    assert f"{port[1]}/tcp" in " ".join(each for s in stages for each in s.values("EXPOSE"))
    assert f"0.0.0.0:{port[1]}" in " ".join(read_command(stages)) or image == "studio"


@pytest.mark.parametrize("image", IMAGES)
def test_an_image_builds_nothing_itself_and_installs_what_is_pinned(image: str) -> None:
    runtime = [stage for stage in lineage(STAGES, image) if stage.name != "runtime"]
    assert not [run for stage in runtime for run in stage.values("RUN")]
    (copied,) = [copy for stage in runtime for copy in stage.values("COPY")]
    build, _, _ = copied.removeprefix("--from=").partition(" ")
    commands = " ".join(STAGES[build].values("RUN"))
    assert "--require-hashes" in commands


def test_opencv_is_built_by_pinned_tools_against_the_numpy_that_runs() -> None:
    tools, runs = pins("requirements-opencv.txt"), pins("requirements-vehicle.txt")
    assert {"scikit-build", "setuptools", "wheel"} <= set(tools)
    assert {str(pin.specifier) for pin in tools["numpy"]} <= {
        str(pin.specifier) for pin in runs["numpy"]
    }
    lock = (ROOT / "requirements-opencv.txt").read_text(encoding="utf-8")
    entries = re.split(r"\n(?=[a-z0-9])", lock)[1:]
    assert [entry for entry in entries if "--hash=sha256:" not in entry] == []


def test_what_is_copied_is_there_and_let_through() -> None:
    wanted = {
        each.split()[0]
        for stage in STAGES.values()
        for each in stage.values("COPY")
        if not each.startswith("--from=")
    }
    allowed = (ROOT / ".dockerignore").read_text(encoding="utf-8").splitlines()
    assert {line.removeprefix("!") for line in allowed if line.startswith("!")} == wanted
    assert [name for name in wanted - {"dist/*.whl"} if not (ROOT / name).is_file()] == []


@pytest.mark.parametrize("image", IMAGES)
def test_what_an_image_runs_is_a_command(image: str) -> None:
    stages = lineage(STAGES, image)
    assert stages[-1].values("ENTRYPOINT") == ['["osg-studio"]']
    name, *arguments = read_command(stages)
    group = get_command(command_line)
    with group.make_context("osg-studio", [name], resilient_parsing=True) as context:
        command = group.get_command(context, name)  # type: ignore[attr-defined]
    command.make_context(name, arguments)


class Author(BaseModel):
    """As the store of BlueOS reads it."""

    model_config = ConfigDict(extra="forbid")

    name: str
    email: Annotated[str, Field(pattern=r"^[^@ ]+@[^@ ]+$")]


class Company(BaseModel):
    """As the store of BlueOS reads it."""

    model_config = ConfigDict(extra="forbid")

    name: str
    about: str
    email: Annotated[str, Field(pattern=r"^[^@ ]+@[^@ ]+$")]


class Links(BaseModel):
    """As the store of BlueOS reads it."""

    model_config = ConfigDict(extra="forbid")

    website: HttpUrl


class Extension(BaseModel):
    """The labels of an extension, by the models of BlueOS' store."""

    model_config = ConfigDict(extra="forbid")

    version: str
    type: Literal["device-integration", "example", "theme", "other", "tool"]
    requirements: str
    readme: HttpUrl
    permissions: dict[str, Any]
    authors: list[Author]
    company: Company
    tags: list[str]
    links: Links


class Metadata(BaseModel):
    """The card of an extension in BlueOS' store, which lies beside its logos."""

    model_config = ConfigDict(extra="forbid")

    name: str
    website: HttpUrl
    docker: Annotated[str, Field(pattern=r"^[a-z0-9._/-]+$")]
    description: Annotated[str, Field(max_length=200)]


STORE = ROOT / "release" / "containers" / "blueos"


def test_the_stores_card_names_the_image_and_the_service() -> None:
    text = (STORE / "metadata.json").read_text("utf-8")
    for name, value in (("WEBSITE", "https://pages.example/"), ("IMAGE", "crew/osg-blueos")):
        assert f"${{{name}}}" in text
        text = text.replace(f"${{{name}}}", value)
    card = Metadata.model_validate_json(text)
    assert card.name == SERVICE["name"]
    for logo in ("extension_logo.png", "company_logo.png"):
        picture = cv2.imread(str(STORE / logo))
        assert picture is not None
        assert picture.shape[:2] == (256, 256)


def test_the_stores_page_says_what_the_answers_are_and_what_was_not_tested() -> None:
    page = " ".join((STORE / "README.md").read_text("utf-8").split())
    assert "once listening, twice *show it again*, three times *which of two?*" in page
    assert "not yet with ArduSub itself" in page


def test_the_labels_are_those_of_a_blueos_extension() -> None:
    declared = " ".join(STAGES["blueos"].values("ARG"))
    pages = {
        "README": "https://pages.example/README.md",
        "WEBSITE": "https://pages.example/",
        "EMAIL": "crew@pages.example",
    }
    assert all(f'{name}=""' in declared for name in pages)
    labels = read_labels(STAGES["blueos"], pages)
    parsed = {
        key: json.loads(value) if value[:1] in ("{", "[") else value
        for key, value in labels.items()
    }
    extension = TypeAdapter(Extension).validate_python(parsed)
    assert extension.version == __version__ == SERVICE["version"]
    assert all(re.fullmatch(r"[a-z0-9-]+", tag) for tag in extension.tags)
    assert len(extension.tags) <= 10
    host = extension.permissions["HostConfig"]
    assert host["ReadonlyRootfs"] is True
    assert "Privileged" not in host
    volume, _, place = host["Binds"][0].partition(":")
    assert (host["Binds"][1:], place) == ([], "/data")
    assert "/" not in volume  # a folder of the vehicle would belong to root, and this is nobody
    assert "--upload" in read_command([STAGES["blueos"]])
    ports = extension.permissions["ExposedPorts"]
    assert [f"0.0.0.0:{port.removesuffix('/tcp')}" for port in ports] == [
        word for word in read_command([STAGES["blueos"]]) if word.startswith("0.0.0.0:")
    ]
