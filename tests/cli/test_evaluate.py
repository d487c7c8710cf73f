"""``osg-studio evaluate``, run as a user runs it."""

import json
from pathlib import Path
from xml.etree import ElementTree

import pytest

from tests.command_line import OsgStudio
from tests.conftest import ROOT
from tests.evaluation.test_labelled_takes import save_swipes
from tests.recognition.demonstrations import pool
from tests.recognition.strategies import circle

TABLE_1 = ROOT / "languages" / "osg-table-1.json"


def test_a_language_names_variants_of_its_own_gestures(
    osg_studio: OsgStudio, tmp_path: Path
) -> None:
    picture = tmp_path / "confusion.svg"
    ended = osg_studio(
        "evaluate", TABLE_1, "--variants", 3, "--profile", "full", "--picture", picture
    )
    assert ended.code == 0, ended.error
    assert "of 9 correct" in ended.out
    assert [line.split()[0] for line in ended.out.splitlines()[3:6]] == ["circle", "wedge", "three"]
    ElementTree.parse(picture)


def test_what_is_asked_back_is_counted_on_its_own(osg_studio: OsgStudio, tmp_path: Path) -> None:
    pool(circle=circle, ring=circle).save(tmp_path / "pool.json")
    arguments = ("evaluate", tmp_path / "pool.json", "--variants", 3, "--profile", "full")
    (finding,) = json.loads(osg_studio(*arguments, "--json").out)["findings"]
    asked = finding["asked_back"]
    assert asked["asked"] == asked["correct"] > 3
    assert sum(map(sum, finding["confusion"]["pairs"])) == asked["asked"]
    told = f"{asked['asked']} asked back, {asked['asked']} of them with the right gesture"
    assert told in osg_studio(*arguments).out


def test_json_has_a_finding_for_each_profile(osg_studio: OsgStudio) -> None:
    ended = osg_studio("evaluate", TABLE_1, "--variants", 2, "--seed", 4, "--json")
    report = json.loads(ended.out)
    assert list(report) == ["source", "findings", "problems"]
    assert [finding["profile"] for finding in report["findings"]] == ["paper", "full"]
    for finding in report["findings"]:
        assert finding["correct"]["asked"] == 6
        assert sum(map(sum, finding["confusion"]["counts"])) == 6
        assert "seed 4" in finding["asked"]


def test_a_folder_of_takes_is_asked_for_one_shot_and_by_a_given_language(
    osg_studio: OsgStudio, tmp_path: Path
) -> None:
    save_swipes(tmp_path / "takes")
    ended = osg_studio("evaluate", tmp_path / "takes", "--profile", "full")
    assert ended.code == 0, ended.error
    assert "profile full, any person, 2 languages of one take: 100.0%" in ended.out
    ended = osg_studio(
        "evaluate", tmp_path / "takes", "--profile", "paper", "--language", TABLE_1, "--json"
    )
    (finding,) = json.loads(ended.out)["findings"]
    assert finding["correct"]["correct"] == 0
    assert finding["correct"]["asked"] == 6
    assert finding["confusion"]["labels"] == ["circle", "wedge", "three", "left", "right", "up"]


def test_a_broken_file_is_told_and_the_rest_is_evaluated(
    osg_studio: OsgStudio, tmp_path: Path
) -> None:
    save_swipes(tmp_path)
    (tmp_path / "person 0" / "up" / "broken.npz").write_bytes(b"")
    ended = osg_studio("evaluate", tmp_path, "--profile", "full", "--json")
    assert ended.code == 0
    report = json.loads(ended.out)
    assert len(report["problems"]) == 1
    assert report["findings"][0]["correct"]["asked"] == 6
    assert "broken.npz" in " ".join(ended.error.split())


@pytest.mark.parametrize(
    ("arguments", "what"),
    [
        (["no-such-folder"], "no-such-folder"),
        ([str(TABLE_1), "--profile", "best"], "no profile 'best'"),
        (["."], "holds no clip"),
        ([".", "--layout", "{person}"], "{label}"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_two(
    osg_studio: OsgStudio,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    arguments: list[str],
    what: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    ended = osg_studio("evaluate", *arguments)
    assert ended.code == 2
    assert what in ended.error
    assert ended.error.count("\n") == 1
