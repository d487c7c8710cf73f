"""Dive recordings given to the command line in place of clips."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from pathlib import Path

import pytest

from app.recognition import Language
from tests.api.recordings import recording_of
from tests.bags.bag_files import (
    START,
    Row,
    compressed,
    file_of,
    our_rows,
    published_rows,
    write_bag,
    zipped,
)
from tests.bags.exports import checked
from tests.command_line import OsgStudio
from tests.documented import documented
from tests.recognition.damaged_clips import picture

pytestmark = pytest.mark.slow


@pytest.fixture
def language(tmp_path: Path, osg_studio: OsgStudio) -> Path:
    """Return a language that was defined from bags of keypoints."""
    demonstrations = []
    for shape in ("circle", "line"):
        bag = write_bag(tmp_path / shape, our_rows(recording_of(shape)))
        demonstrations.append(f"{shape}={bag}@/osg/body")
    output = tmp_path / "shapes.json"
    ended = osg_studio("define", *demonstrations, "--name", "shapes", "--output", output)
    assert ended.code == 0, ended.error
    return output


def test_a_bag_is_recognised_like_a_clip(
    tmp_path: Path, osg_studio: OsgStudio, language: Path
) -> None:
    assert Language.load(language).labels == ("circle", "line")
    folder = write_bag(tmp_path / "dive", published_rows(recording_of("line", "circle")))
    for bag in (folder, file_of(folder), zipped(folder)):
        ended = osg_studio("recognize", bag, "--language", language, "--json")
        assert ended.code == 0, ended.error
        report = json.loads(ended.out)
        assert report["clip"] == str(bag)
        assert [take["label"] for take in report["takes"]] == ["line", "circle"]
        assert "the skeleton is drawn" not in ended.out


def test_the_topic_is_named_where_there_are_several(
    tmp_path: Path, osg_studio: OsgStudio, language: Path
) -> None:
    rows = [
        *as_another_diver("buddy", published_rows(recording_of("line"))),
        *as_another_diver("leader", published_rows(recording_of("circle"))),
    ]
    bag = write_bag(tmp_path / "dive", sorted(rows, key=lambda row: row[2]))
    ended = osg_studio("recognize", bag, "--language", language)
    assert ended.code == 2
    assert ended.error.count("\n") == 1
    assert "2 topics to choose from" in ended.error
    assert "--topic /buddy/pose_keypoints" in ended.error
    for diver, label in (("buddy", "line"), ("leader", "circle")):
        arguments = (bag, "--language", language, "--topic", f"/{diver}/pose_keypoints", "--json")
        ended = osg_studio("recognize", *arguments)
        assert [take["label"] for take in json.loads(ended.out)["takes"]] == [label]


def test_the_session_is_written_as_mcap(
    tmp_path: Path, osg_studio: OsgStudio, language: Path
) -> None:
    bag = write_bag(tmp_path / "dive", published_rows(recording_of("line", "circle")))
    session = tmp_path / "session.mcap"
    ended = osg_studio("recognize", bag, "--language", language, "--mcap", session)
    assert ended.code == 0, ended.error
    # A line may be broken anywhere, depending on how long the folder's name is.
    assert re.search(r"session.mcap:\d+\.\dkB,opensinFoxglove", "".join(ended.error.split()))
    found = checked(session)
    assert [content["label"] for _, content in found["/recognitions"]] == ["line", "circle"]
    assert len(found["/video"]) == len(found["/pose"]) > 0
    ended = osg_studio("recognize", session, "--language", language, "--json")
    assert [take["label"] for take in json.loads(ended.out)["takes"]] == ["line", "circle"]
    left = {each.name for each in tmp_path.iterdir()}
    assert left == {"circle", "dive", "line", "session.mcap", "shapes.json"}


def as_another_diver(diver: str, rows: Iterable[Row]) -> list[Row]:
    """Return rows with their topics in a namespace."""
    return [(f"/{diver}{topic}", content, received) for topic, content, received in rows]


def test_the_documented_commands_do_what_they_say(
    tmp_path: Path, osg_studio: OsgStudio, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "dives").mkdir()
    for shape in ("circle", "line"):
        write_bag(tmp_path / "dives" / shape, our_rows(recording_of(shape)))
    divers = [
        *as_another_diver("buddy", published_rows(recording_of("line"))),
        *as_another_diver("leader", published_rows(recording_of("circle"))),
    ]
    write_bag(tmp_path / "dives" / "reef", sorted(divers, key=lambda row: row[2]))
    defining = documented("define", page="guides/dive-recordings.md")
    for command in (*defining, *documented("recognize", page="guides/dive-recordings.md")):
        ended = osg_studio(*command)
        assert ended.code == 0, ended.error
    assert ended.out.split("\t")[2] == "line"
    assert checked(tmp_path / "session.mcap")["/recognitions"]


@pytest.mark.usefixtures("installed_models")
def test_the_documented_robot_looks_at_the_pictures_of_a_bag(
    tmp_path: Path, osg_studio: OsgStudio, language: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "dives").mkdir()
    rows: list[Row] = [
        ("/camera/image_raw/compressed", compressed(picture(i), ".jpg", START + i), START + i)
        for i in range(0, 10**9, 10**8)
    ]
    write_bag(tmp_path / "dives" / "camera", rows)
    language.rename(tmp_path / "pool.json")
    (command,) = documented("robot", page="guides/dive-recordings.md")
    ended = osg_studio(*command)
    assert ended.code == 1, ended.error  # nobody is in these pictures
    events = [json.loads(line) for line in ended.out.splitlines()]
    assert (events[0]["event"], events[0]["live"]) == ("source_opened", False)
    assert (events[-1]["event"], events[-1]["frames"]) == ("source_ended", 10)


def test_what_is_no_bag_is_told_in_one_line(
    tmp_path: Path, osg_studio: OsgStudio, language: Path
) -> None:
    (tmp_path / "empty").mkdir()
    for arguments, words in (
        (
            (tmp_path / "empty",),
            "empty holds neither a dive recording (metadata.yaml) nor frames of OpenPose",
        ),
        ((tmp_path / "absent", "--topic", "/camera"), "absent is not a file"),
        ((language, "--topic", "/camera"), "shapes.json is no dive recording"),
    ):
        ended = osg_studio("recognize", *arguments, "--language", language)
        assert ended.code == 2
        assert words in ended.error
        assert ended.error.count("\n") == 1
