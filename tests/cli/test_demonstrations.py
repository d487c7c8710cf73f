"""Several demonstrations on the command line: defined at once, listed, added and removed."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from app.cli.clip_argument import clip_and_span
from app.cli.demonstrations import (
    DemonstrationArgument,
    describe_shown,
    parse_demonstrations,
)
from app.recognition import Gesture, GestureError, Language
from tests.command_line import OsgStudio
from tests.keypoint_files.files import write_openpose
from tests.recognition.held_takes import FIST, FLAT, follow, hold
from tests.recognition.moving_takes import circle as drawn_circle
from tests.recognition.moving_takes import draw, without_hands
from tests.recognition.strategies import BODY, Shape, circle, line, recording, rest, square

ARMS = tuple(BODY)
RATE = ("--frame-rate", "30")


def folder(path: Path, shape: Shape, *, hand: str = "right_wrist", seed: int = 0) -> Path:
    poses = recording(shape, landmarks=ARMS, hand=hand, jitter=0.004, seed=seed)
    return write_openpose(path, poses)


@pytest.fixture
def clips(tmp_path: Path) -> dict[str, Path]:
    return {
        "ana": folder(tmp_path / "ana", circle),
        "ben": folder(tmp_path / "ben", circle, hand="left_wrist", seed=1),
        "line": folder(tmp_path / "line", line),
        "still": folder(tmp_path / "still", rest),
        "square": folder(tmp_path / "square", square),
    }


@pytest.fixture
def pool(osg_studio: OsgStudio, tmp_path: Path, clips: dict[str, Path]) -> Path:
    """Return the file of a language of a circle by two divers, and a line."""
    file = tmp_path / "pool.json"
    given = [f"circle={clips['ana']},{clips['ben']}", f"line={clips['line']}"]
    ended = osg_studio(
        "define", *given, "--name", "pool", "--output", file, "--diver", "Ana", *RATE
    )
    assert ended.code == 0, ended.error
    assert ended.error.count("circle: 60 poses") == 2
    return file


def listed(osg_studio: OsgStudio, file: Path) -> list[list[str]]:
    ended = osg_studio("demonstrations", "list", file)
    assert ended.code == 0, ended.error
    return [line.split("\t") for line in ended.out.splitlines()]


def test_a_gesture_is_defined_by_several_clips(osg_studio: OsgStudio, pool: Path) -> None:
    circled = Language.load(pool).gesture("circle").single_demonstrations()
    assert [each.salient for each in circled] == [("right_wrist",), ("left_wrist",)]
    assert listed(osg_studio, pool) == [
        ["circle", "1", "Ana", "right_wrist", "1.97"],
        ["circle", "2", "Ana", "left_wrist", "1.97"],
        ["line", "1", "Ana", "right_wrist", "1.97"],
    ]


def test_a_demonstration_of_another_diver_is_added_and_removed(
    osg_studio: OsgStudio, pool: Path, clips: dict[str, Path], tmp_path: Path
) -> None:
    before = Language.load(pool)
    given = ("demonstrations", "add", pool, f"line={clips['square']}", "--diver", "Ben", *RATE)
    ended = osg_studio(*given)
    assert ended.code == 0, ended.error
    after = Language.load(pool)
    assert after.revision == before.revision + 1
    assert [each.diver for each in after.gesture("line").single_demonstrations()] == ["Ana", "Ben"]

    copy = tmp_path / "copy.json"
    ended = osg_studio("demonstrations", "remove", pool, "line", "1", "--output", copy)
    assert ended.code == 0, ended.error
    assert Language.load(pool).to_json() == after.to_json()
    assert Language.load(copy).gesture("line").diver == "Ben"
    assert [row[:2] for row in listed(osg_studio, copy)] == [
        ["circle", "1"],
        ["circle", "2"],
        ["line", "1"],
    ]


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["add", "{pool}", "wave={clip}"], "no gesture 'wave' in 'pool'"),
        (["add", "{pool}", "line"], "LABEL=CLIP"),
        (["add", "{pool}", "line={still}"], "nothing moves in the demonstration of 'line'"),
        (["add", "{pool}", "line=" + ",".join(["{clip}"] * 8)], "the limit is 8"),
        (["remove", "{pool}", "circle", "0"], "no demonstration 0: it has 2, counted from 1"),
        (["remove", "{pool}", "circle", "3"], "no demonstration 3: it has 2, counted from 1"),
        (["remove", "{pool}", "line", "1"], "the only demonstration of 'line' cannot be removed"),
        (["list", "{clip}"], "cannot read"),
    ],
)
def test_bad_input_is_one_line_and_changes_nothing(
    osg_studio: OsgStudio,
    pool: Path,
    clips: dict[str, Path],
    arguments: list[str],
    complaint: str,
) -> None:
    before = pool.read_bytes()
    places = {"pool": pool, "clip": clips["line"], "still": clips["still"]}
    options = RATE if arguments[0] == "add" else ()
    ended = osg_studio("demonstrations", *(each.format(**places) for each in arguments), *options)
    assert ended.code == 2
    assert complaint in ended.error
    assert pool.read_bytes() == before


def test_both_hands_are_recognised_after_two_demonstrations(
    osg_studio: OsgStudio, pool: Path, tmp_path: Path
) -> None:
    for hand in ("left_wrist", "right_wrist"):
        clip = folder(tmp_path / hand, circle, hand=hand, seed=7)
        ended = osg_studio("recognize", clip, "--language", pool, "--profile", "paper", *RATE)
        assert ended.code == 0, ended.error
        assert ended.out.split("\t")[2] == "circle"


def test_a_format_of_one_demonstration_keeps_the_first_and_says_so(
    osg_studio: OsgStudio, pool: Path, tmp_path: Path
) -> None:
    target = tmp_path / "reference.json"
    ended = osg_studio("convert", pool, target, "--format", "osg-reference")
    assert ended.code == 0, ended.error
    assert "keeps only the first demonstration of circle" in " ".join(ended.error.split())
    first = Language.load(pool).gesture("circle")
    written = json.loads(target.read_text())["circle"]
    assert written["image"] == first.image.tolist()
    assert written["salient_keypoints"] == ["RIGHT_WRIST"]
    copy = tmp_path / "copy.json"
    ended = osg_studio("convert", pool, copy)
    assert "first demonstration" not in ended.error
    assert copy.read_bytes() == pool.read_bytes()


def test_a_demonstration_is_a_label_and_a_clip() -> None:
    (parsed,) = parse_demonstrations("circle=a.mp4")
    assert parsed == DemonstrationArgument("circle", Path("a.mp4"))


def test_a_demonstration_may_give_its_range_in_seconds() -> None:
    (parsed,) = parse_demonstrations("circle=dive 1.mp4@1.5-3")
    assert parsed == DemonstrationArgument("circle", Path("dive 1.mp4"), (1.5, 3.0))


def test_a_file_whose_name_looks_like_a_range_is_taken_as_it_is(tmp_path: Path) -> None:
    clip = tmp_path / "dive@1-2"
    clip.touch()
    assert clip_and_span(str(clip)) == (clip, None)


def test_a_gesture_may_have_several_clips_each_with_its_own_range() -> None:
    assert parse_demonstrations("come here=ana.mp4@1-2.5, ben.mp4,dive.mcap@/camera") == [
        DemonstrationArgument("come here", Path("ana.mp4"), (1.0, 2.5)),
        DemonstrationArgument("come here", Path("ben.mp4")),
        DemonstrationArgument("come here", Path("dive.mcap@/camera")),
    ]


@pytest.mark.parametrize("ending", ["", "@1-2"])
def test_a_file_whose_name_has_a_comma_is_taken_as_it_is(tmp_path: Path, ending: str) -> None:
    clip = tmp_path / "ana,ben.mp4"
    clip.touch()
    (parsed,) = parse_demonstrations(f"circle={clip}{ending}")
    assert parsed.clip == clip


def test_a_bag_whose_name_has_a_comma_is_taken_as_it_is(tmp_path: Path) -> None:
    bag = tmp_path / "ana,ben.mcap"
    bag.touch()
    (parsed,) = parse_demonstrations(f"circle={bag}@/camera")
    assert parsed.clip == Path(f"{bag}@/camera")


@pytest.mark.parametrize(
    "text", ["circle", "=clip.mp4", "circle=", " =clip.mp4", "circle=a.mp4,", "circle=,a.mp4"]
)
def test_what_is_no_demonstration_is_refused_with_an_example(text: str) -> None:
    with pytest.raises(GestureError, match="LABEL=CLIP"):
        parse_demonstrations(text)


def test_what_a_gesture_is_made_of_is_told() -> None:
    drawn = draw(FIST, drawn_circle())
    for poses, words in (
        (hold(FIST), "held hand shape: right hand"),
        (follow(hold(FLAT), hold(FIST)), "held hand shapes: right hand, two in sequence"),
        (drawn, "salient: right_wrist; hand shape seen: right hand"),
        (without_hands(drawn), "salient: right_wrist"),
    ):
        assert describe_shown(Gesture.from_demonstration("fist", poses)) == words
