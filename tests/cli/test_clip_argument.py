"""How clips are named on the command line."""

from pathlib import Path

import pytest

from app.cli.clip_argument import Demonstration, clip_and_span
from app.recognition import GestureError


def test_a_demonstration_is_a_label_and_a_clip() -> None:
    assert Demonstration.parse("circle=a.mp4") == Demonstration("circle", Path("a.mp4"))


def test_a_demonstration_may_give_its_range_in_seconds() -> None:
    parsed = Demonstration.parse("circle=dive 1.mp4@1.5-3")
    assert parsed == Demonstration("circle", Path("dive 1.mp4"), (1.5, 3.0))


def test_a_file_whose_name_looks_like_a_range_is_taken_as_it_is(tmp_path: Path) -> None:
    clip = tmp_path / "dive@1-2"
    clip.touch()
    assert clip_and_span(str(clip)) == (clip, None)


@pytest.mark.parametrize("text", ["circle", "=clip.mp4", "circle=", " =clip.mp4"])
def test_what_is_no_demonstration_is_refused_with_an_example(text: str) -> None:
    with pytest.raises(GestureError, match="LABEL=CLIP"):
        Demonstration.parse(text)
