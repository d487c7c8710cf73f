"""Defects of the published implementation (2025-03-01, head bf8232a), which this one must not have.

Defects of its video traversal and of its salutes are tested with clips and takes.
"""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.recognition import Gesture, GestureError, Language, PoseSequence, Recognizer
from app.recognition.decision.majority_vote import MajorityVote
from app.recognition.features.contour import Contour
from app.recognition.features.trajectory_image import draw
from app.recognition.gestures.demonstration import condense
from app.recognition.gestures.profile import PROFILES
from app.recognition.poses.trajectory import Trajectory
from app.recognition.voters.registry import PAPER_VOTERS
from app.recognition.voters.shape_voters import describe_drawing
from tests.recognition.demonstrations import drawn_language
from tests.recognition.strategies import SHAPES, circle, line, recording, rest, wedge
from tests.recognition.voters.figures import drawing_of


def test_a_gesture_without_a_salient_keypoint_does_not_break_the_language() -> None:
    """There: an empty contour, an IndexError, and no gesture of the language loads."""
    with pytest.raises(GestureError, match="nothing moves"):
        Gesture.from_demonstration("still", recording(rest))
    content = json.loads(drawn_language().to_json())
    content["gestures"][0]["salient"] = []
    content["gestures"][1]["image"] = json.loads(_blank().to_json())["gestures"][0]["image"]
    del content["sha256"]
    language = Language.from_json(json.dumps(content))
    assert Recognizer(language).recognize(recording(line, frames=45)).label == "line"


def _blank() -> Language:
    image = np.zeros((224, 224), dtype=np.uint8)
    return Language("blank", [Gesture(label="blank", salient=(), image=image)])


def _adrift(poses: PoseSequence) -> PoseSequence:
    return replace(poses, xy=poses.xy + np.linspace((0, 0), (200, 90), len(poses))[:, None])


def _farther(poses: PoseSequence) -> PoseSequence:
    return replace(poses, xy=poses.xy * 0.3)


def _in_a_wide_frame(poses: PoseSequence) -> PoseSequence:
    return replace(poses, frame_size=(1920, 480))


@pytest.mark.parametrize("change", [_adrift, _farther, _in_a_wide_frame])
def test_drift_distance_and_the_cameras_aspect_do_not_change_the_shape(
    change: Callable[[PoseSequence], PoseSequence],
) -> None:
    """There: no centring, no scale, and x and y divided by the frame's width and height."""
    query = recording(circle, jitter=0.004)
    before, after = (
        draw(condense(Trajectory.from_poses(poses)).select(["right_wrist"])).image
        for poses in (query, change(query))
    )
    np.testing.assert_array_equal(after, before)


@pytest.mark.parametrize("name", SHAPES)
def test_reference_and_query_go_through_one_pipeline(name: str) -> None:
    """There: other Canny thresholds, a second blur and a binarisation on one side only."""
    for profile in PROFILES:
        result = Recognizer(drawn_language(), profile).recognize(recording(SHAPES[name]))
        distances = result.distances[:, result.gestures.index(name)]
        np.testing.assert_array_equal(distances[np.isfinite(distances)], 0.0)


def test_hu_and_zernike_keep_their_magnitudes() -> None:
    """There: each vector is z-scored within itself, which forgets how large its entries are."""
    for name in ("hu", "zernike"):
        vectors = [gesture.descriptors[name] for gesture in drawn_language().gestures]
        assert len({round(float(np.std(vector)), 3) for vector in vectors}) > 1
        assert any(abs(vector.mean()) > 0.1 for vector in vectors)


def test_every_contour_counts_in_a_defined_order() -> None:
    """There: the first contour found is taken, which may be a speck."""
    image = drawn_language().gesture("line").image.copy()
    image[2:5, 2:5] = 255
    contours = Contour.of(image).contours
    assert len(contours) == 2
    assert contours[0][:, 0].mean() < contours[1][:, 0].mean()
    line_alone = Contour.of(drawn_language().gesture("line").image)
    assert Contour.of(image).area == pytest.approx(line_alone.area, rel=0.01)


def test_fourier_descriptors_are_real_numbers_of_one_length_for_any_contour() -> None:
    """There: complex numbers with the DC term, and a mismatch below twelve contour points."""
    tiny = drawn_language().gestures[0].image.copy()
    tiny[:] = 0
    tiny[100:102, 100:102] = 255
    speck = Gesture(label="speck", salient=("right_wrist",), image=tiny).redraw()
    assert speck.descriptors["fourier"].dtype == np.float64
    assert (
        speck.descriptors["fourier"].shape
        == drawn_language().gestures[0].descriptors["fourier"].shape
    )
    result = Recognizer(drawn_language().with_gesture(speck)).recognize(
        recording(wedge, jitter=0.01)
    )
    assert result.label == "wedge"


def test_the_outline_lies_anywhere_and_the_descriptor_is_the_same() -> None:
    """There: the DC term keeps the place, and nothing divides by the scale."""
    corner = drawing_of(np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)]))
    moved = replace(corner, image=np.roll(corner.image, (9, -7), axis=(0, 1)))
    here, there = (
        describe_drawing(drawing, PAPER_VOTERS)["fourier"] for drawing in (corner, moved)
    )
    np.testing.assert_allclose(here, there, atol=1e-6)


def test_a_tie_does_not_go_to_whichever_gesture_comes_first() -> None:
    """There: ties go to the first entry of a dictionary."""
    distances = np.full((7, 2), 1.0)
    distances[:3, 0], distances[3:6, 1] = 0.9, 0.1
    distances[6] = np.inf  # one voter abstains, so that three votes stand against three
    for gestures in (("circle", "wedge"), ("wedge", "circle")):
        language = Language("two", [drawn_language().gesture(label) for label in gestures])
        two = Recognizer(language, "paper")
        assert isinstance(two.vote, MajorityVote)
        assert two.vote.count_votes(distances).label == gestures[1]


def test_recognition_writes_no_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """There: an image named after the label is written on every recognition."""
    monkeypatch.chdir(tmp_path)
    hostile = Gesture.from_demonstration("../escaped", recording(circle))
    language = Language("pool", [hostile])
    Recognizer(Language.from_json(language.to_json())).recognize(recording(circle))
    assert list(tmp_path.iterdir()) == []
    assert not (tmp_path.parent / "escaped.png").exists()


def test_the_file_says_who_made_it_when_how_and_from_which_motion() -> None:
    """There: 850 kB of pixels a gesture, and no trajectory, units, author or versions."""
    text = drawn_language().to_json()
    assert len(text) < 40_000 * len(drawn_language().gestures)
    content = json.loads(text)
    assert {"format", "version", "author", "created", "revision", "settings"} <= set(content)
    for entry in content["gestures"]:
        assert entry["trajectory"]["unit"] == "torso_length"
        assert entry["trajectory"]["axes"] == "x right, y down"
        assert len(entry["trajectory"]["time"]) == 60
        assert "command" in entry
        assert "thresholds" in entry
