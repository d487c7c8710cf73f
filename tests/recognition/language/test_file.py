"""The language file's text: strict to read, sealed, and the same for the same content."""

import json
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from app.recognition import Gesture, Language, LanguageError
from app.recognition.language.file import seal, short_code
from app.recognition.language.file_schema import MAX_FILE_BYTES, MAX_GESTURES
from tests.conftest import ROOT
from tests.recognition.held_takes import TWO, hold
from tests.recognition.strategies import circle, in_space, line, recording

Content = dict[str, Any]
Change = Callable[[Content], object]
Case = tuple[Change, str, str]
"""A change of a file, where its fault is told, and how."""


@pytest.fixture(scope="module")
def text() -> str:
    gestures = [
        Gesture.from_demonstration("circle", recording(circle), command="come here"),
        Gesture.from_demonstration("line", recording(line))
        .with_demonstration(recording(line, jitter=0.01), "Ben")
        .with_demonstration(recording(line, hand="left_wrist")),
    ]
    return Language("pool", gestures).to_json()


def resealed(text: str, change: Change) -> str:
    """Change a file's content, and seal it again as a program would."""
    content = json.loads(text)
    change(content)
    if "sha256" in content:
        content["sha256"] = seal(content)
    return json.dumps(content)


def refusal_of(text: str | bytes) -> LanguageError:
    with pytest.raises(LanguageError) as refusal:
        Language.from_json(text)
    return refusal.value


def first(content: Content) -> Content:
    gesture: Content = content["gestures"][0]
    return gesture


def test_format_and_version_come_first_and_the_seal_last(text: str) -> None:
    keys = list(json.loads(text))
    assert keys[:2] == ["format", "version"]
    assert keys[-1] == "sha256"
    assert json.loads(text)["format"] == "osg-studio/gesture-language"
    assert json.loads(text)["version"] == 1


def test_a_gesture_takes_one_line_so_that_revisions_can_be_compared(text: str) -> None:
    lines = [line for line in text.splitlines() if line.startswith('{"label":')]
    assert len(lines) == 2


def test_a_language_without_gestures_has_a_file(text: str) -> None:
    empty = Language("empty").to_json()
    assert Language.from_json(empty).to_json() == empty


def test_bytes_and_text_are_read_alike(text: str) -> None:
    assert Language.from_json(text.encode()).to_json() == Language.from_json(text).to_json()


def test_the_order_of_keys_and_the_spacing_do_not_break_the_seal(text: str) -> None:
    content = json.loads(text)
    rearranged = json.dumps(dict(reversed(content.items())), indent=2, ensure_ascii=True)
    assert Language.from_json(rearranged).to_json() == text


def test_a_file_changed_since_it_was_sealed_is_refused_with_a_way_out(text: str) -> None:
    error = refusal_of(text.replace("come here", "go away"))
    assert error.pointer == "/sha256"
    assert "edited by hand" in str(error)
    assert 'remove the line "sha256"' in str(error)


def test_a_file_edited_on_purpose_is_read_without_its_seal_and_saved_with_one(text: str) -> None:
    content = json.loads(text.replace("come here", "go away"))
    del content["sha256"]
    language = Language.from_json(json.dumps(content))
    assert language.gesture("circle").command == "go away"
    assert len(json.loads(language.to_json())["sha256"]) == 64


def drop(key: str) -> Change:
    return lambda content: content.pop(key)


def put(key: str, value: object) -> Change:
    return lambda content: content.update({key: value})


def put_label(label: str) -> Change:
    return lambda content: first(content).update({"label": label})


def in_gesture(key: str, value: object, complaint: str, *, below: str = "") -> Case:
    """Return the case of a wrong value in the first gesture, and where it is told."""
    pointer = f"/gestures/0/{key}{below}"
    return lambda content: first(content).update({key: value}), pointer, complaint


def in_trajectory(key: str, value: object, complaint: str, *, below: str = "") -> Case:
    pointer = f"/gestures/0/trajectory/{key}{below}"
    return lambda content: first(content)["trajectory"].update({key: value}), pointer, complaint


def in_demonstration(key: str, value: object, complaint: str, *, below: str = "") -> Case:
    def change(content: Content) -> None:
        content["gestures"][1]["demonstrations"][1].update({key: value})

    return change, f"/gestures/1/demonstrations/1/{key}{below}", complaint


def repeat_demonstrations(content: Content) -> None:
    content["gestures"][1]["demonstrations"] *= 4


def in_path(key: str, value: object, complaint: str, *, below: str = "") -> Case:
    def change(content: Content) -> None:
        first(content)["trajectory"]["paths"][1].update({key: value})

    return change, f"/gestures/0/trajectory/paths/1/{key}{below}", complaint


@pytest.mark.parametrize(
    ("change", "pointer", "complaint"),
    [
        (drop("format"), "/format", "not a language file"),
        (put("format", "something/else"), "/format", "not a language file"),
        (drop("version"), "/version", "Field required"),
        (put("version", 0), "/version", "Input should be 1"),
        (put("version", "1"), "/version", "Input should be 1"),
        (put("version", True), "/version", "must be a number"),
        (put("version", 2), "/version", r"version 2 is newer than this program reads \(1\)"),
        (drop("gestures"), "/gestures", "Field required"),
        (put("colour", "blue"), "/colour", "Extra inputs are not permitted"),
        (put("revision", "3"), "/revision", "valid integer"),
        (put("revision", 0), "/revision", "greater than or equal to 1"),
        (put("created", "yesterday"), "/created", "match pattern"),
        (put("created", "2026-02-30T00:00:00Z"), "/created", "no such date"),
        (put("name", " "), "/name", "needs a name"),
        (put("skeleton", [["nose"]]), "/skeleton/0", "at least 2 items"),
        (put_label("line"), "/gestures/1/label", "'line' occurs twice"),
        (put_label("l\u200cine"), "/gestures/1/label", "'line' occurs twice"),
        in_gesture("label", "", "at least 1 character"),
        in_gesture("label", "a\nb", "printable"),
        in_gesture("label", "می\u200c", "printable"),
        in_gesture("command", 7, "string"),
        in_gesture("command", {"text": "x" * 5000}, "too large: 5,012 bytes"),
        in_gesture("mood", 7, "Extra inputs"),
        in_gesture("salient", ["tail"], "has no path", below="/0"),
        in_gesture("salient", ["nose", "nose"], "a landmark occurs twice"),
        in_gesture("image", "!", "not a PNG in base64"),
        in_gesture("image", "AAAA", "not a PNG"),
        in_gesture("descriptors", {"hu": [1.0]}, "1 values, expected 7", below="/hu"),
        in_gesture("descriptors", {"hu": ["1"]}, "valid number", below="/hu/0"),
        in_gesture("diver", 7, "valid string"),
        in_gesture("diver", "a\nb", "printable"),
        in_gesture("diver", "x" * 81, "at most 80 characters"),
        in_gesture("demonstrations", {}, "valid list"),
        (repeat_demonstrations, "/gestures/1/demonstrations", "at most 7 items"),
        in_trajectory("unit", "inch", "torso_length"),
        in_trajectory("axes", "y up", "x right, y down"),
        in_trajectory("time", [], "at least 1 item"),
        in_trajectory("time", [0.0, 0.0], "time does not increase: 0 s, then 0 s", below="/1"),
        in_trajectory("paths", [], "at least 1 item"),
        in_path("landmark", "nose", "a second path of 'nose'"),
        in_path("y", [1.0], "1 values, but time has 60"),
        in_path("x", [True] * 60, "valid number", below="/0"),
        in_demonstration("trajectory", None, "valid dictionary"),
        in_demonstration("salient", [], "no salient landmark and no held hand"),
        in_demonstration("salient", ["left_wrist", "tail"], "has no path", below="/1"),
        in_demonstration("salient", ["nose", "nose"], "a landmark occurs twice"),
        in_demonstration("image", "!", "not a PNG"),
        in_demonstration("descriptors", {"hu": [1.0]}, "1 values, expected 7", below="/hu"),
        in_demonstration("diver", "a\nb", "printable"),
        in_demonstration("label", "line", "Extra inputs"),
    ],
)
@pytest.mark.withstands(row="H13")
def test_what_breaks_the_format_is_refused_with_a_pointer(
    text: str, change: Change, pointer: str, complaint: str
) -> None:
    error = refusal_of(resealed(text, change))
    assert error.pointer == pointer
    assert str(error).startswith(pointer)
    assert "\n" not in str(error)
    with pytest.raises(LanguageError, match=complaint):
        raise error


def test_every_fault_is_listed_with_its_pointer(text: str) -> None:
    def spoil(content: Content) -> None:
        content["revision"] = None
        first(content)["description"] = 3
        content["gestures"][1]["salient"] = "nose"

    message = str(refusal_of(resealed(text, spoil)))
    for pointer in ("/revision", "/gestures/0/description", "/gestures/1/salient"):
        assert pointer + ": " in message


def test_a_hundred_faults_are_counted_not_listed(text: str) -> None:
    noise = {f"key {number}": 0 for number in range(100)}
    assert str(refusal_of(resealed(text, lambda content: content.update(noise)))).endswith(
        "and 80 more"
    )


@pytest.mark.parametrize(
    ("content", "complaint"),
    [
        (b"", "not JSON"),
        (b"\x00\x01\x02", "not JSON"),
        (b"<html>", "not JSON"),
        (b"[]", "not a language file"),
        (b"null", "not a language file"),
        (b'{"circle": {"image": [], "salient_keypoints": []}}', "osg-studio convert"),
        (b'{"format": 1, "format": 2}', "/format: this key occurs twice"),
        (b'{"version": 1e400}', "/version: not a number"),
        (b"[" * 10_000, "nested 10000 deep"),
        (b" " * (MAX_FILE_BYTES + 1), "the file is too large"),
    ],
    ids=lambda value: repr(value[:20]),
)
def test_what_is_no_language_file_is_refused(content: bytes, complaint: str) -> None:
    with pytest.raises(LanguageError, match=complaint):
        Language.from_json(content)


def test_text_with_a_lone_surrogate_is_refused(text: str) -> None:
    assert "not UTF-8" in str(refusal_of(text.replace("pool", "po\ud800l")))
    assert "surrogate" in str(refusal_of(text.replace("pool", r"po\ud800l")))


@pytest.mark.withstands(row="H13")
def test_ten_thousand_gestures_are_refused_before_they_are_looked_at(text: str) -> None:
    many = resealed(text, put("gestures", [{}] * 10_000))
    error = refusal_of(many)
    assert error.pointer == "/gestures"
    assert f"10000 gestures, the limit is {MAX_GESTURES}" in str(error)


@pytest.mark.parametrize("label", ["../../x", "<script>alert(1)</script>", "CON", "sígueme 🤿"])
def test_any_readable_label_goes_through_the_file(label: str) -> None:
    language = Language("pool", [Gesture.from_demonstration(label, recording(circle))])
    assert Language.from_json(language.to_json()).labels == (label,)


@pytest.mark.withstands(row="H12")
def test_a_gesture_that_matches_nothing_does_not_keep_the_file_from_loading(text: str) -> None:
    still = resealed(text, in_gesture("salient", [], "")[0])
    assert Language.from_json(still).labels == ("circle", "line")


def test_depth_survives_a_file_and_is_left_out_where_there_is_none(text: str) -> None:
    gesture = Gesture.from_demonstration("circle", in_space(recording(circle), 20.0))
    written = Language("pool", [gesture]).to_json()
    read = Language.from_json(written).gestures[0].trajectory
    assert gesture.trajectory is not None
    assert read is not None
    np.testing.assert_array_equal(read.depth, gesture.trajectory.depth)
    assert '"z"' in written
    assert '"z"' not in text


def test_a_path_with_fewer_depths_than_moments_is_refused() -> None:
    gesture = Gesture.from_demonstration("circle", in_space(recording(circle)))
    written = Language("pool", [gesture]).to_json()
    shorter = resealed(written, lambda content: first(content)["trajectory"]["paths"][1]["z"].pop())
    assert refusal_of(shorter).pointer == "/gestures/0/trajectory/paths/1/z"


def held_language() -> Language:
    return Language(name="signs", gestures=[Gesture.from_demonstration("two", hold(TWO))])


def test_a_held_shape_is_a_key_of_its_trajectory() -> None:
    entry = json.loads(held_language().to_json())["gestures"][0]
    assert entry["salient"] == []
    (hand,) = entry["trajectory"]["hands"]
    assert hand["side"] == "right"
    assert len(hand["x"]) == len(hand["y"]) == 21


def test_a_language_without_held_shapes_has_no_key_of_them(text: str) -> None:
    assert '"hands"' not in text


@pytest.mark.parametrize(
    ("change", "pointer", "message"),
    [
        ({"side": "upper"}, "/gestures/0/trajectory/hands/0/side", "left"),
        ({"x": [0.0] * 20}, "/gestures/0/trajectory/hands/0/x", "at least 21 items"),
        ({"y": [9.0] * 21}, "/gestures/0/trajectory/hands/0/y/0", "less than or equal to 5"),
        (
            {"x": [0.0] * 21, "y": [0.0] * 21},
            "/gestures/0/trajectory/hands/0",
            "not all at one point",
        ),
    ],
)
def test_a_broken_hand_is_refused_with_a_pointer(
    change: dict[str, object], pointer: str, message: str
) -> None:
    content = json.loads(held_language().to_json())
    del content["sha256"]
    content["gestures"][0]["trajectory"]["hands"][0].update(change)
    with pytest.raises(LanguageError, match=message) as caught:
        Language.from_json(json.dumps(content))
    assert caught.value.pointer == pointer


def test_two_hands_of_one_side_and_a_moving_held_shape_are_refused() -> None:
    content = json.loads(held_language().to_json())
    del content["sha256"]
    trajectory = content["gestures"][0]["trajectory"]
    trajectory["hands"] *= 2
    with pytest.raises(LanguageError, match="two right hands"):
        Language.from_json(json.dumps(content))
    del trajectory["hands"][1]
    content["gestures"][0]["salient"] = ["right_wrist"]
    with pytest.raises(LanguageError, match="a held hand shape has no salient landmarks"):
        Language.from_json(json.dumps(content))


FILE = ROOT / "languages" / "osg-table-1.json"


def test_the_code_is_the_beginning_of_the_files_checksum() -> None:
    sha256 = json.loads(FILE.read_text("utf-8"))["sha256"]
    code = short_code(sha256)
    assert len(code) == 9
    assert code.replace("-", "").lower() == sha256[:8]


def test_another_revision_has_another_code() -> None:
    language = Language.load(FILE)
    texts = (language.to_json(), replace(language, revision=language.revision + 1).to_json())
    codes = {short_code(json.loads(text)["sha256"]) for text in texts}
    assert len(codes) == 2
