"""Dive recordings given to the command line in place of clips."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from app.recognition import Language
from tests.api.recordings import recording_of
from tests.bags.bag_files import Row, file_of, our_rows, published_rows, write_bag, zipped
from tests.bags.sessions import checked
from tests.command_line import OsgStudio


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
    rows: list[Row] = []
    for diver, shape in (("buddy", "line"), ("leader", "circle")):
        rows += [
            (f"/{diver}{topic}", content, received)
            for topic, content, received in published_rows(recording_of(shape))
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
    assert "opens in Foxglove" in ended.error
    found = checked(session)
    assert [content["label"] for _, content in found["/recognitions"]] == ["line", "circle"]
    assert len(found["/video"]) == len(found["/pose"]) > 0
    left = {each.name for each in tmp_path.iterdir()}
    assert left == {"circle", "dive", "line", "session.mcap", "shapes.json"}


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
