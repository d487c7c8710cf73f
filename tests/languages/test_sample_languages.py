"""The sample languages and clips together: what a new user tries first works."""

from collections.abc import Callable, Mapping

import numpy as np
import pytest

from app.recognition import Gesture, Language, Recognizer, Recording, Take, takes_in
from app.recognition.poses.sequence import FloatArray
from languages.build import FOLDER, LANGUAGES, TABLE_2

LABELS = tuple(entry.label for entry in TABLE_2)
KINDS = ("demonstration", "test-1", "test-2")

AT_LEAST = {"paper": 12, "full": 16}
"""Number of sixteen test takes by other divers that each profile must recognise correctly."""

SAME_PATH = 0.03
"""Torso lengths (1.5 cm of a diver) by which a path may differ between two processors."""

SAME_TRIM = 1
"""Frames by which the ends of a take may differ between two processors."""

Takes = Mapping[str, tuple[Take, ...]]


@pytest.fixture(scope="module")
def takes(sample_recording: Callable[[str], Recording]) -> Takes:
    names = [f"{label}-{kind}" for label in LABELS for kind in KINDS]
    return {name: takes_in(sample_recording(name)) for name in names}


@pytest.fixture(scope="module")
def table_2(takes: Takes) -> Language:
    gestures = [
        Gesture.from_demonstration(label, takes[f"{label}-demonstration"][0].poses)
        for label in LABELS
    ]
    return Language(name="from clips", gestures=gestures)


def test_every_clip_holds_exactly_one_closed_take(takes: Takes) -> None:
    unlike = {name: found for name, found in takes.items() if [t.closed for t in found] != [True]}
    assert unlike == {}


@pytest.mark.parametrize("profile", AT_LEAST)
def test_takes_of_other_divers_are_named(takes: Takes, table_2: Language, profile: str) -> None:
    recognizer = Recognizer(table_2, profile=profile)
    named = {
        name: recognizer.recognize(takes[name][0].poses).label
        for name in takes
        if not name.endswith("demonstration")
    }
    right = [name for name, label in named.items() if name.startswith(f"{label}-")]
    assert len(named) == 16
    assert len(right) >= AT_LEAST[profile], named


@pytest.mark.parametrize("profile", AT_LEAST)
def test_a_triangle_without_its_third_side_is_misread(
    sample_recording: Callable[[str], Recording], table_2: Language, profile: str
) -> None:
    """The recogniser behaves as the user guide explains to new users."""
    (take,) = takes_in(sample_recording("unfinished-triangle"))
    assert take.closed
    assert Recognizer(table_2, profile).recognize(take.poses).nearest == "wedge"


def test_the_shipped_recording_of_the_misread_triangle_is_what_its_clip_shows(
    sample_recording: Callable[[str], Recording],
) -> None:
    shipped = Recording.load(FOLDER / "clips" / "unfinished-triangle.npz")
    read = sample_recording("unfinished-triangle")
    np.testing.assert_allclose(shipped.poses.time, read.poses.time)
    (take,), (other,) = takes_in(shipped), takes_in(read)
    assert abs(take.stroke_start - other.stroke_start) <= 0.1
    assert abs(take.stroke_end - other.stroke_end) <= 0.1
    near = np.abs(shipped.poses.xy - read.poses.xy)
    assert np.nanmedian(near) < 0.01 * read.poses.frame_size[1]


@pytest.mark.parametrize("stem", ["osg-table-1", "osg-table-2"])
def test_the_shipped_file_is_what_its_clips_show(table_2: Language, stem: str) -> None:
    shipped = Language.load(FOLDER / f"{stem}.json")
    sample = LANGUAGES[stem]
    assert shipped.labels == tuple(entry.label for entry in sample.entries)
    assert shipped.grammar == sample.grammar
    for gesture in shipped.gestures:
        rebuilt = table_2.gesture(gesture.label)
        assert gesture.salient == rebuilt.salient
        assert gesture.trajectory is not None
        assert rebuilt.trajectory is not None
        shown = gesture.trajectory.select(gesture.salient).xy
        again = rebuilt.trajectory.select(gesture.salient).xy
        assert abs(len(shown) - len(again)) <= SAME_TRIM, gesture.label
        assert largest_deviation(shown, again) <= SAME_PATH, gesture.label


def largest_deviation(one: FloatArray, other: FloatArray) -> float:
    """Slide the shorter path along the longer one, and return the best match's worst moment."""
    short, long = sorted((one, other), key=len)
    return min(
        float(np.abs(long[first : first + len(short)] - short).max())
        for first in range(len(long) - len(short) + 1)
    )


def test_two_handed_sweep_follows_both_wrists(table_2: Language) -> None:
    assert table_2.gesture("sweep").salient == ("left_wrist", "right_wrist")
    assert table_2.gesture("circle").salient == ("right_wrist",)


@pytest.mark.parametrize("stem", LANGUAGES)
def test_a_gesture_takes_at_most_forty_kilobytes(stem: str) -> None:
    file = FOLDER / f"{stem}.json"
    assert file.stat().st_size <= 40_000 * len(Language.load(file).gestures)
