"""The published implementation's files: written as it reads them, read whatever their age."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.recognition import Gesture, Language, LanguageError, Recognizer
from app.recognition.language.export_format import from_reference, to_reference
from tests.recognition.strategies import SHAPES, circle, line, recording, wedge

GOLDEN = Path(__file__).parents[2] / "golden" / "osg-reference.json"
Content = dict[str, Any]


@pytest.fixture(scope="module")
def language() -> Language:
    shapes = {"circle": circle, "wedge": wedge, "line": line}
    return Language(
        "pool", [Gesture.from_demonstration(name, recording(shapes[name])) for name in shapes]
    )


def test_the_published_structure(language: Language) -> None:
    content = json.loads(to_reference(language))
    assert list(content) == ["circle", "wedge", "line"]
    for entry in content.values():
        assert set(entry) == {"image", "salient_keypoints"}
        assert entry["salient_keypoints"] == ["RIGHT_WRIST"]
        assert np.array(entry["image"]).shape == (224, 224)
        assert {type(value) for row in entry["image"] for value in row} == {int}
        assert set(np.unique(entry["image"])) == {0, 255}


def test_export_import_export_gives_the_same_bytes(language: Language) -> None:
    text = to_reference(language)
    assert to_reference(from_reference(text, "pool")) == text


def test_an_imported_language_is_lossy_and_still_recognises(language: Language) -> None:
    imported = from_reference(to_reference(language), "theirs")
    assert imported.name == "theirs"
    assert all(gesture.trajectory is None for gesture in imported.gestures)
    for name in imported.labels:
        query = recording(SHAPES[name], torso=70, frames=45, jitter=0.01)
        assert Recognizer(imported).recognize(query).label == name


def test_an_imported_language_decides_as_the_exported_one(language: Language) -> None:
    imported = from_reference(to_reference(language), "theirs")
    query = recording(wedge, torso=70, frames=45, jitter=0.02)
    np.testing.assert_array_equal(
        Recognizer(imported, "paper").recognize(query).distances,
        Recognizer(language, "paper").recognize(query).distances,
    )


def test_an_imported_language_can_be_saved_as_ours(language: Language) -> None:
    text = from_reference(to_reference(language), "theirs").to_json()
    again = Language.from_json(text)
    assert again.to_json() == text
    assert again.gesture("circle").trajectory is None


def recoloured(language: Language, paint: Callable[[np.ndarray[Any, Any]], Any]) -> str:
    content = json.loads(to_reference(language))
    for entry in content.values():
        entry["image"] = paint(np.array(entry["image"]) > 0).tolist()
    return json.dumps(content, indent=4)


def red_on_white(strokes: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    return np.where(strokes[..., None], (255, 0, 0), (255, 255, 255))


def green_on_black(strokes: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    return np.where(strokes[..., None], (0, 200, 0), (0, 0, 0))


def grey_on_black(strokes: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    return np.where(strokes, 76, 0)


def soft_edges(strokes: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    return np.where(strokes, 255, np.where(np.roll(strokes, 1, axis=0), 20, 0))


@pytest.mark.slow
@pytest.mark.parametrize("paint", [red_on_white, green_on_black, grey_on_black, soft_edges])
def test_strokes_are_found_whatever_their_colour_and_background(
    language: Language, paint: Callable[[np.ndarray[Any, Any]], Any]
) -> None:
    imported = from_reference(recoloured(language, paint), "old")
    for before, after in zip(language.gestures, imported.gestures, strict=True):
        np.testing.assert_array_equal(after.image, before.image)


def test_a_gesture_without_keypoints_or_strokes_is_kept_and_matches_nothing(
    language: Language,
) -> None:
    content = json.loads(to_reference(language))
    content["nothing"] = {"image": [[0] * 224] * 224, "salient_keypoints": ["RIGHT_WRIST"]}
    content["nowhere"] = {"image": content["line"]["image"], "salient_keypoints": []}
    text = json.dumps(content)
    imported = from_reference(text, "theirs")
    result = Recognizer(imported).recognize(recording(circle, frames=45))
    assert result.label == "circle"
    assert np.isinf(result.distances[:, 3:]).all()
    assert json.loads(to_reference(imported)) == content


def test_landmarks_it_does_not_know_cannot_be_exported() -> None:
    marker = recording(circle, hand="marker", landmarks=("marker",))
    language = Language("lab", [Gesture.from_demonstration("circle", marker)])
    with pytest.raises(LanguageError, match="'circle' uses the keypoint 'marker'"):
        to_reference(language)


BLACK = [[0] * 224] * 224


@pytest.mark.parametrize(
    ("content", "pointer", "complaint"),
    [
        ("[]", "", "it must be an object"),
        ("{", "", "not JSON"),
        ('{"a": 1}', "/a", 'an object with "image" and "salient_keypoints"'),
        ('{"a": {"image": []}}', "/a", "salient_keypoints"),
        ({"a/b": {"image": [], "salient_keypoints": "NOSE"}}, "/a~1b/salient_keypoints", "a list"),
        ({"a": {"image": BLACK, "salient_keypoints": ["TAIL"]}}, "/a/salient_keypoints/0", "TAIL"),
        (
            {"a": {"image": BLACK, "salient_keypoints": ["NOSE", "NOSE"]}},
            "/a/salient_keypoints/1",
            "occurs twice",
        ),
        ({"a": {"image": [[1], [1, 2]], "salient_keypoints": []}}, "/a/image", "differ in length"),
        ({"a": {"image": [[0] * 10] * 10, "salient_keypoints": []}}, "/a/image", r"\(10, 10\)"),
        ({"a": {"image": "x", "salient_keypoints": []}}, "/a/image", "integers, got shape"),
        (
            {"a": {"image": [[0.5] * 224] * 224, "salient_keypoints": []}},
            "/a/image",
            "of float64",
        ),
        ({"a": {"image": [[-1] * 224] * 224, "salient_keypoints": []}}, "/a/image", "outside 0"),
        ({" ": {"image": BLACK, "salient_keypoints": []}}, "/ ", "label must be"),
        ({str(number): 0 for number in range(1001)}, "", "1001 gestures, the limit is 1000"),
    ],
    ids=lambda value: repr(value)[:40],
)
def test_what_is_no_reference_file_is_refused_with_a_pointer(
    content: str | Content, pointer: str, complaint: str
) -> None:
    text = content if isinstance(content, str) else json.dumps(content)
    with pytest.raises(LanguageError, match=complaint) as refusal:
        from_reference(text, "theirs")
    assert refusal.value.pointer == pointer


def test_the_golden_file_is_read_and_written_as_it_stands() -> None:
    text = GOLDEN.read_text("utf-8")
    language = from_reference(text, "golden")
    assert to_reference(language) == text
    assert language.gesture("sweep").salient == ("left_wrist", "right_wrist")
