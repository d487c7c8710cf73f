"""The sample clips: complete, small, playable, and showing what their names say."""

import json
from collections.abc import Callable
from pathlib import Path

import av
import numpy as np
import numpy.typing as npt
import pytest

from app.recognition import Language, Recognizer, Recording, find_takes, takes_in
from languages.build import FOLDER, TABLE_2

GESTURES = [entry.label for entry in TABLE_2]
TAKES = [
    f"{gesture}-{kind}" for gesture in GESTURES for kind in ("demonstration", "test-1", "test-2")
] + ["unfinished-triangle"]
CLIPS = [*TAKES, "ordinary-movement"]
SIZE_LIMIT = 150_000
"""Largest clip in bytes, so that twenty-six clips stay small beside the code."""


@pytest.fixture(scope="module")
def phases(sample_clips: Path) -> dict[str, list[tuple[str, float, float]]]:
    """Return the true phases of every clip: names with their start and end."""
    read: dict[str, list[tuple[str, float, float]]] = json.loads(
        (sample_clips / "phases.json").read_text()
    )
    return read


def test_there_is_a_demonstration_and_two_test_takes_of_every_gesture(sample_clips: Path) -> None:
    assert sorted(path.stem for path in sample_clips.glob("*.mp4")) == sorted(CLIPS)


@pytest.mark.parametrize("name", CLIPS)
def test_a_clip_is_small_and_plays_in_every_browser(sample_clips: Path, name: str) -> None:
    path = sample_clips / f"{name}.mp4"
    assert path.stat().st_size <= SIZE_LIMIT
    with av.open(str(path)) as container:
        (stream,) = container.streams
        assert isinstance(stream, av.VideoStream)
        assert (stream.width, stream.height) == (640, 480)
        assert (stream.codec_context.name, stream.pix_fmt) == ("h264", "yuv420p")
        assert stream.average_rate == 25
        assert 5 <= stream.frames / 25 <= 10


@pytest.mark.parametrize("name", CLIPS)
def test_a_clip_starts_to_play_before_all_of_it_is_loaded(sample_clips: Path, name: str) -> None:
    file = (sample_clips / f"{name}.mp4").read_bytes()
    assert 0 < file.find(b"moov") < file.find(b"mdat")


@pytest.mark.slow
def test_the_clips_are_different_pictures(sample_clips: Path) -> None:
    colours = [_mean_colours(sample_clips / f"{name}.mp4") for name in TAKES if "test" in name]
    nearest = [
        min(float(np.abs(one - other).max()) for k, other in enumerate(colours) if k != number)
        for number, one in enumerate(colours)
    ]
    # Grey levels in some sixteenth of the image: a copy with other noise would stay below one.
    assert min(nearest) > 5


def test_both_salutes_are_held_long_enough_to_be_seen(
    phases: dict[str, list[tuple[str, float, float]]],
) -> None:
    for name in TAKES:
        held = [end - start for phase, start, end in phases[name] if phase == "salute"]
        assert len(held) == 2, name
        assert min(held) >= 0.6, name


@pytest.mark.parametrize("name", ["circle-demonstration", "sweep-test-2", "wedge-test-2"])
def test_a_take_is_found_where_it_truly_is(
    sample_recording: Callable[[str], Recording],
    phases: dict[str, list[tuple[str, float, float]]],
    name: str,
) -> None:
    recording = sample_recording(name)
    # Raised arms and a quick turn may cost a few frames; a second body would cost many more.
    assert recording.poses.seen.any(axis=1).mean() > 0.9
    (take,) = takes_in(recording)
    first, second = [(start, end) for phase, start, end in phases[name] if phase == "salute"]
    (stroke,) = [(start, end) for phase, start, end in phases[name] if phase == "stroke"]
    assert take.closed
    assert first[1] - 0.2 < take.start < stroke[0]
    assert stroke[1] < take.end < second[0] + 0.2
    assert _overlap((take.stroke_start, take.stroke_end), stroke) > 0.6


def test_ordinary_movement_is_no_take(sample_recording: Callable[[str], Recording]) -> None:
    assert takes_in(sample_recording("ordinary-movement")) == ()


@pytest.mark.slow
@pytest.mark.parametrize("label", ["line", "three"])
def test_a_clip_is_recognized_on_this_processor(
    sample_clips: Path, installed_models: None, label: str
) -> None:
    """Landmarks are found here, the step that the recordings leave out; *three* swaps sides."""
    (take,) = find_takes(sample_clips / f"{label}-test-2.mp4")
    language = Language.load(FOLDER / "osg-table-2.json")
    assert Recognizer(language).recognize(take.poses).label == label


def _mean_colours(path: Path) -> npt.NDArray[np.float64]:
    """Return the mean colours of the sixteen parts of the first frame, ``(4, 4, 3)``."""
    with av.open(str(path)) as container:
        image = next(container.decode(video=0)).to_ndarray(format="rgb24").astype(np.float64)
    colours: npt.NDArray[np.float64] = image.reshape(4, 120, 4, 160, 3).mean(axis=(1, 3))
    return colours


def _overlap(one: tuple[float, float], other: tuple[float, float]) -> float:
    """Return the common time of two spans over the time of either."""
    common = min(one[1], other[1]) - max(one[0], other[0])
    return common / (max(one[1], other[1]) - min(one[0], other[0]))
