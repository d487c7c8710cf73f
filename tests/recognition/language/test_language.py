"""A language keeps distinct gestures, and its file keeps everything about them."""

import json
from dataclasses import replace
from datetime import datetime, timedelta, timezone
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.recognition import Gesture, Language, LanguageError, PoseSequence, Recognizer
from app.recognition.gestures.demonstration import MAX_LANDMARKS
from app.recognition.language.file_schema import MAX_GESTURES
from tests.recognition.strategies import SHAPES, circle, line, recording, recordings, wedge

GOLDEN = Path(__file__).parents[2] / "golden" / "language.json"
GOLDEN_OF_DIVERS = GOLDEN.with_name("language-of-two-divers.json")
KILOBYTES_A_GESTURE = 40


def gesture(label: str) -> Gesture:
    return Gesture.from_demonstration(label, recording(SHAPES[label], jitter=0.01))


@pytest.fixture(scope="module")
def language() -> Language:
    return Language("pool", [gesture(label) for label in SHAPES], author="A. Diver")


def test_a_language_is_a_name_and_gestures_in_order(language: Language) -> None:
    assert language.labels == ("circle", "wedge", "line", "infinity", "square")
    assert language.gesture("line").label == "line"
    assert language.revision == 1
    assert language.created is not None
    assert language.created.utcoffset() == timedelta(0)


def test_an_unknown_label_is_named_with_the_known_ones(language: Language) -> None:
    with pytest.raises(LanguageError, match=r"no gesture 'wave' in 'pool'; it has .*circle"):
        language.gesture("wave")


def test_every_edit_is_the_next_revision_and_leaves_the_old_one() -> None:
    first = Language("pool", [gesture("circle")])
    second = first.with_gesture(gesture("line"))
    third = second.without("circle")
    assert [one.labels for one in (first, second, third)] == [
        ("circle",),
        ("circle", "line"),
        ("line",),
    ]
    assert [one.revision for one in (first, second, third)] == [1, 2, 3]
    assert third.created == first.created
    with pytest.raises(LanguageError, match="no gesture 'circle'"):
        third.without("circle")


def test_a_changed_gesture_takes_the_place_of_the_old_one() -> None:
    first = Language("pool", [gesture("circle"), gesture("line")])
    changed = gesture("circle").with_demonstration(recording(wedge), "Ben")
    second = first.with_changed(changed)
    assert second.labels == first.labels
    assert second.revision == 2
    assert second.gesture("circle") is changed
    with pytest.raises(LanguageError, match="no gesture 'square'"):
        first.with_changed(gesture("square"))


def test_a_label_cannot_occur_twice() -> None:
    with pytest.raises(LanguageError, match="'circle' occurs twice: rename") as refusal:
        Language("pool", [gesture("circle"), gesture("line"), gesture("circle")])
    assert refusal.value.pointer == "/gestures/2/label"


@pytest.mark.withstands(row="H34")
def test_a_new_label_must_not_look_like_another_one(
    caplog: pytest.LogCaptureFixture, tmp_path: Path
) -> None:
    language = Language("pool", [replace(gesture("circle"), label="down"), gesture("line")])
    alike = replace(language.gesture("down"), label="d\u043ewn")
    with pytest.raises(LanguageError, match="looks like 'down'"):
        language.with_gesture(alike)
    with pytest.raises(LanguageError, match="looks like 'down'"):
        language.renamed("line", "\uff44own")
    assert language.renamed("line", "zuru\u0308ck").labels == ("down", "zur\u00fcck")
    # A file that was accepted earlier is loaded as it is, with a warning.
    kept = replace(language, gestures=(*language.gestures, alike))
    kept.save(tmp_path / "pool.json")
    assert Language.load(tmp_path / "pool.json").to_json() == kept.to_json()
    assert "pool.json: the labels 'down' and 'd\u043ewn' look alike" in caplog.text


def test_a_language_beyond_what_its_file_may_hold_is_refused() -> None:
    one = gesture("circle")
    many = [replace(one, label=f"gesture {number}") for number in range(MAX_GESTURES + 1)]
    with pytest.raises(LanguageError, match="1001 gestures, the limit is 1000"):
        Language("many", many)


@pytest.mark.parametrize(
    ("changes", "pointer"),
    [
        ({"name": ""}, "/name"),
        ({"name": "a\nb"}, "/name"),
        ({"name": "x" * 81}, "/name"),
        ({"author": "x" * 201}, "/author"),
        ({"revision": 0}, "/revision"),
        ({"created": datetime(2026, 1, 1)}, "/created"),  # no zone
    ],
)
def test_a_field_that_the_file_could_not_hold_is_refused(
    changes: dict[str, object], pointer: str
) -> None:
    with pytest.raises(LanguageError) as refusal:
        replace(Language("pool"), **changes)  # type: ignore[arg-type]
    assert refusal.value.pointer == pointer


def test_created_is_kept_in_utc_to_the_second() -> None:
    there = timezone(timedelta(hours=-4))
    language = Language("pool", created=datetime(2026, 5, 1, 20, 30, 15, 999, tzinfo=there))
    assert language.created == datetime(2026, 5, 2, 0, 30, 15, tzinfo=timezone.utc)


def test_loading_and_saving_again_gives_the_same_bytes(language: Language, tmp_path: Path) -> None:
    language.save(tmp_path / "one.json")
    Language.load(tmp_path / "one.json").save(tmp_path / "two.json")
    assert (tmp_path / "two.json").read_bytes() == (tmp_path / "one.json").read_bytes()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["one.json", "two.json"]


divers = st.text(st.characters(codec="utf-8", categories=("L", "N")), max_size=8)


@given(st.lists(st.tuples(recordings(), divers), min_size=1, max_size=3))
@settings(max_examples=15, deadline=None)
def test_all_demonstrations_come_back_from_the_file(takes: list[tuple[PoseSequence, str]]) -> None:
    (poses, diver), *others = takes
    command = {"speed": 0.5, "then": ["stop"]}
    before = Gesture.from_demonstration("stroke", poses, diver=diver, command=command)
    for poses, diver in others:
        before = before.with_demonstration(poses, diver)
    language = Language("pool", [before])
    text = language.to_json()
    again = Language.from_json(text)
    assert again.to_json() == text
    assert again.gesture("stroke").command == command
    after = again.gesture("stroke").single_demonstrations()
    for one, other in zip(after, before.single_demonstrations(), strict=True):
        assert (one.diver, one.salient) == (other.diver, other.salient)
        np.testing.assert_array_equal(one.image, other.image)
        assert one.trajectory is not None
        assert other.trajectory is not None
        np.testing.assert_array_equal(one.trajectory.xy, other.trajectory.xy)
        np.testing.assert_array_equal(one.trajectory.time, other.trajectory.time)
        np.testing.assert_equal(dict(one.descriptors), dict(other.descriptors))


def test_a_file_without_further_demonstrations_does_not_mention_them() -> None:
    one = gesture("circle")
    plain = Language("pool", [one])
    (entry,) = json.loads(plain.to_json())["gestures"]
    assert not {"diver", "demonstrations"} & set(entry)
    two = one.with_demonstration(recording(circle, jitter=0.02)).without_demonstration(1)
    assert replace(plain, gestures=[two]).to_json() == plain.to_json()


def test_five_demonstrations_take_40_kilobytes_each_at_most() -> None:
    several = gesture("wedge")
    for seed in range(4):
        poses = recording(wedge, frames=3000, jitter=0.02, torso=33.3, seed=seed)
        several = several.with_demonstration(poses, "x" * 80)
    text = Language("pool", [several]).to_json()
    assert len(text.encode()) < 5 * KILOBYTES_A_GESTURE * 1000


def test_a_language_beyond_its_limit_of_demonstrations_is_refused() -> None:
    several = gesture("circle")
    for _ in range(4):
        several = several.with_demonstration(recording(circle))
    many = [replace(several, label=f"gesture {number}") for number in range(MAX_GESTURES // 5 + 1)]
    with pytest.raises(LanguageError, match="1005 demonstrations of all gestures, the limit is"):
        Language("many", many)


def test_landmarks_not_seen_come_back_as_not_seen() -> None:
    poses = recording(circle)
    xy = poses.xy.copy()
    xy[:40, poses.landmarks.index("left_wrist")] = np.nan
    language = Language("pool", [Gesture.from_demonstration("circle", replace(poses, xy=xy))])
    trajectory = Language.from_json(language.to_json()).gesture("circle").trajectory
    assert trajectory is not None
    left = trajectory.select(["left_wrist"]).xy[:, 0, 0]
    np.testing.assert_array_equal(np.isnan(left), np.arange(60) < 40)


def test_a_loaded_language_decides_exactly_as_before_saving(language: Language) -> None:
    before, after = Recognizer(language), Recognizer(Language.from_json(language.to_json()))
    for shape in SHAPES.values():
        query = recording(shape, frames=77, torso=90, jitter=0.02, seed=5)
        np.testing.assert_array_equal(
            after.recognize(query).distances, before.recognize(query).distances
        )


@pytest.mark.parametrize("frames", [20, 300, 3000])
def test_a_gesture_takes_at_most_40_kilobytes_whatever_its_length(frames: int) -> None:
    poses = recording(wedge, frames=frames, jitter=0.02, torso=33.3)
    text = Language("pool", [Gesture.from_demonstration("wedge", poses)]).to_json()
    assert len(text.encode()) < KILOBYTES_A_GESTURE * 1000


def test_a_gesture_of_many_landmarks_takes_at_most_40_kilobytes() -> None:
    names = tuple(f"marker_{index}" for index in range(MAX_LANDMARKS + 20))
    poses = recording(line, frames=500, jitter=0.3, landmarks=names, hand="marker_3")
    made = Gesture.from_demonstration("line", poses, salient=("marker_3",))
    text = Language("pool", [made]).to_json()
    assert len(text.encode()) < KILOBYTES_A_GESTURE * 1000


def test_descriptors_of_a_file_made_with_these_settings_are_taken_as_they_are(
    language: Language,
) -> None:
    content = json.loads(language.to_json())
    content["gestures"][0]["descriptors"]["hu"] = [0.5] * 7
    del content["sha256"]
    loaded = Language.from_json(json.dumps(content))
    np.testing.assert_array_equal(loaded.gestures[0].descriptors["hu"], [0.5] * 7)


def test_a_file_made_with_other_settings_is_described_anew(language: Language) -> None:
    content = json.loads(language.to_json())
    content["settings"]["stroke_width"] = 2
    del content["sha256"]
    for entry in content["gestures"]:
        entry["descriptors"]["hu"] = [0.0] * 7
    assert Language.from_json(json.dumps(content)).to_json() == language.to_json()


def test_the_golden_file_is_read_and_written_as_it_stands() -> None:
    text = GOLDEN.read_text("utf-8")
    language = Language.load(GOLDEN)
    assert language.to_json() == text
    assert language.labels == ("circle", "sweep")
    assert language.gesture("sweep").salient == ("left_wrist", "right_wrist")
    assert language.gesture("circle").command == {"action": "hold", "seconds": 10}


def test_the_golden_file_of_two_divers_is_read_and_written_as_it_stands() -> None:
    text = GOLDEN_OF_DIVERS.read_text("utf-8")
    language = Language.load(GOLDEN_OF_DIVERS)
    assert language.to_json() == text
    several = language.gesture("circle").single_demonstrations()
    assert [(each.diver, each.salient) for each in several] == [
        ("Ana", ("right_wrist",)),
        ("Ben", ("left_wrist",)),
        ("", ("right_wrist",)),
    ]
    assert language.gesture("line").further == ()


def test_the_golden_file_still_recognises() -> None:
    result = Recognizer(Language.load(GOLDEN)).recognize(recording(circle, frames=45, torso=80))
    assert result.label == "circle"


def test_a_file_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    with pytest.raises(LanguageError, match=r"cannot read .*missing\.json: No such file"):
        Language.load(tmp_path / "missing.json")
    with pytest.raises(LanguageError, match=r"cannot read .*: Is a directory"):
        Language.load(tmp_path)


def test_saving_replaces_the_file_in_one_step_or_leaves_it(
    language: Language, tmp_path: Path
) -> None:
    target = tmp_path / "pool.json"
    target.mkdir()  # a folder cannot be replaced by a file
    with pytest.raises(OSError, match="directory"):
        language.save(target)
    assert [path.name for path in tmp_path.iterdir()] == ["pool.json"]


def test_a_label_is_found_however_its_accents_are_written(language: Language) -> None:
    gesture = replace(language.gestures[0], label="\u00e9")
    named = Language("pool", (gesture,))
    assert named.gesture("e\u0301").label == named.gesture("\u00e9").label == "\u00e9"
