"""How clips are named on the command line."""

from pathlib import Path

import pytest

from app.cli.clip_argument import (
    Demonstration,
    clip_and_span,
    describe_shown,
    parse_demonstrations,
)
from app.recognition import Gesture, GestureError
from tests.recognition.held_takes import FIST, FLAT, follow, hold
from tests.recognition.moving_takes import circle, draw, without_hands


def test_a_demonstration_is_a_label_and_a_clip() -> None:
    (parsed,) = parse_demonstrations("circle=a.mp4")
    assert parsed == Demonstration("circle", Path("a.mp4"))


def test_a_demonstration_may_give_its_range_in_seconds() -> None:
    (parsed,) = parse_demonstrations("circle=dive 1.mp4@1.5-3")
    assert parsed == Demonstration("circle", Path("dive 1.mp4"), (1.5, 3.0))


def test_a_file_whose_name_looks_like_a_range_is_taken_as_it_is(tmp_path: Path) -> None:
    clip = tmp_path / "dive@1-2"
    clip.touch()
    assert clip_and_span(str(clip)) == (clip, None)


def test_a_gesture_may_have_several_clips_each_with_its_own_range() -> None:
    assert parse_demonstrations("come here=ana.mp4@1-2.5, ben.mp4,dive.mcap@/camera") == [
        Demonstration("come here", Path("ana.mp4"), (1.0, 2.5)),
        Demonstration("come here", Path("ben.mp4")),
        Demonstration("come here", Path("dive.mcap@/camera")),
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
    drawn = draw(FIST, circle())
    for poses, words in (
        (hold(FIST), "held hand shape: right hand"),
        (follow(hold(FLAT), hold(FIST)), "held hand shapes: right hand, two in sequence"),
        (drawn, "salient: right_wrist; hand shape seen: right hand"),
        (without_hands(drawn), "salient: right_wrist"),
    ):
        assert describe_shown(Gesture.from_demonstration("fist", poses)) == words
