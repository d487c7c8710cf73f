"""Profile ``full``: direction, hand and posture count where the language needs them."""

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given

from app.recognition import (
    Gesture,
    GestureError,
    Language,
    PoseError,
    PoseSequence,
    Recognizer,
)
from app.recognition.decision.references import MOST_DEMONSTRATIONS_TRAVERSED
from app.recognition.gestures.switches import Switches
from app.recognition.poses.landmarks import other_side
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.registry import VOTER_NAMES
from tests.recognition.strategies import (
    SHAPES,
    Shape,
    circle,
    line,
    recording,
    recordings,
    rest,
    wedge,
)


def backwards(shape: Shape) -> Shape:
    return lambda share: shape(1 - share)


def begun_at(start: float, shape: Shape) -> Shape:
    return lambda share: shape((share + start) % 1.0)


def taught(**shapes: Shape) -> Recognizer:
    gestures = [
        Gesture.from_demonstration(name, recording(shape)) for name, shape in shapes.items()
    ]
    return Recognizer(Language("pool", gestures), profile="full")


@pytest.fixture(scope="module")
def recognizer() -> Recognizer:
    return taught(**SHAPES)


def test_a_circle_the_other_way_round_is_a_circle_where_there_is_only_one(
    recognizer: Recognizer,
) -> None:
    for shape in (circle, backwards(circle)):
        assert recognizer.recognize(recording(shape, jitter=0.01)).label == "circle"


def test_a_circle_begins_anywhere() -> None:
    shapes = taught(circle=circle, wedge=wedge, line=line)
    for start in (0.0, 0.3, 0.7):
        for shape in (circle, backwards(circle)):
            query = recording(begun_at(start, shape), jitter=0.01)
            assert shapes.recognize(query).label == "circle"


def test_two_circles_are_told_apart_by_the_way_round() -> None:
    both = taught(clockwise=circle, counter=backwards(circle), line=line)
    for start in (0.0, 0.15, 0.5):
        turned = recording(begun_at(start, backwards(circle)), jitter=0.01, frames=44)
        assert both.recognize(turned).label == "counter"
        shown = recording(begun_at(start, circle), jitter=0.01, frames=44)
        assert both.recognize(shown).label == "clockwise"


def test_two_swipes_are_told_apart_and_one_is_read_either_way() -> None:
    both = taught(right=line, left=backwards(line), circle=circle)
    one = taught(swipe=line, circle=circle)
    for shape, expected in ((line, "right"), (backwards(line), "left")):
        query = recording(shape, jitter=0.01, torso=80)
        assert both.recognize(query).label == expected
        assert one.recognize(query).label == "swipe"


def test_the_hand_is_told() -> None:
    gestures = [
        Gesture.from_demonstration(hand, recording(circle, hand=hand))
        for hand in ("left_wrist", "right_wrist")
    ]
    hands = Recognizer(Language("hands", gestures), profile="full")
    for hand in ("left_wrist", "right_wrist"):
        assert hands.recognize(recording(circle, hand=hand, jitter=0.01)).label == hand


@given(recordings())
def test_any_stroke_gets_a_label_a_confidence_and_plain_json(
    recognizer: Recognizer, poses: PoseSequence
) -> None:
    result = recognizer.recognize(poses)
    assert result.nearest in SHAPES
    assert 0.0 <= result.confidence <= 1.0
    assert result.profile == "full"
    assert result.voters == VOTER_NAMES
    assert result.distances.shape == (len(VOTER_NAMES), len(SHAPES))
    assert (result.distances >= 0).all()
    assert json.loads(json.dumps(result.to_dict(), allow_nan=False)) == result.to_dict()


def test_each_voter_with_a_say_votes_for_its_nearest(recognizer: Recognizer) -> None:
    result = recognizer.recognize(recording(wedge, jitter=0.01))
    assert "velocity" in result.counted
    assert "path" not in result.counted  # of whole arms
    assert "tempo" not in result.counted  # no gesture differs by its tempo alone
    assert sum(result.weights.values()) == pytest.approx(1.0)
    for voter, label in result.votes.items():
        row = result.distances[VOTER_NAMES.index(voter)]
        assert result.gestures[int(row.argmin())] == label


def test_an_imported_image_matches_nothing_and_alone_is_read_by_paper() -> None:
    shown = [
        Gesture.from_demonstration(name, recording(SHAPES[name])) for name in ("line", "wedge")
    ]
    drawn = Gesture.from_demonstration("circle", recording(circle))
    imported = Gesture(label="circle", salient=drawn.salient, image=drawn.image)
    query = recording(circle, jitter=0.01)
    mixed = Recognizer(Language("mixed", [*shown, imported]), profile="full").recognize(query)
    assert np.isinf(mixed.scores[mixed.gestures.index("circle")])
    alone = Recognizer(Language("alone", [imported]), profile="full").recognize(query)
    assert (alone.profile, alone.label) == ("paper", "circle")


def test_a_recording_in_which_nothing_moves_is_refused(recognizer: Recognizer) -> None:
    with pytest.raises(PoseError, match="moves in this take"):
        recognizer.recognize(recording(rest))


def turned_by(angle: float, shape: Shape) -> Shape:
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])

    def figure(share: FloatArray) -> FloatArray:
        return np.asarray(shape(share) @ turn)

    return figure


def test_among_many_gestures_each_is_taken_as_shown() -> None:
    count = MOST_DEMONSTRATIONS_TRAVERSED + 1
    angles = 2 * np.pi * np.arange(count) / count
    many = taught(**{f"wedge {n}": turned_by(angles[n], wedge) for n in range(count)})
    result = many.recognize(recording(turned_by(angles[40], wedge)))
    assert result.label == "wedge 40"


def with_switches(
    shape: Shape, label: str = "shown", rate: float = 30.0, **switches: str
) -> Gesture:
    gesture = Gesture.from_demonstration(label, recording(shape, rate=rate))
    return replace(gesture, switches=Switches(**switches))  # type: ignore[arg-type]


def label_of(gestures: list[Gesture], query: PoseSequence) -> str | None:
    return Recognizer(Language("pool", gestures), profile="full").recognize(query).label


def test_an_author_can_insist_on_a_direction() -> None:
    to_the_left = recording(backwards(line), jitter=0.01)
    up = Gesture.from_demonstration("up", recording(turned_by(np.pi / 2, line)))
    free, strict = (
        Recognizer(Language("one", [with_switches(line, direction=each), up]), "full")
        for each in ("auto", "on")
    )
    distances = [
        each.recognize(to_the_left).distances[VOTER_NAMES.index("path"), 0]
        for each in (free, strict)
    ]
    assert distances[0] < 0.1 < distances[1]


def test_an_author_can_waive_a_direction() -> None:
    pair = [
        with_switches(line, "right", direction="off"),
        with_switches(backwards(line), "left", direction="off"),
    ]
    result = Recognizer(Language("pair", pair), "full").recognize(recording(line, jitter=0.01))
    path = result.distances[VOTER_NAMES.index("path")]
    assert path[1] == pytest.approx(path[0], abs=0.05)


def with_both_hands(left: Shape, right: Shape, jitter: float = 0.0) -> PoseSequence:
    """Record two hands, each at its own figure, the left one mirrored to its own side."""

    def mirrored(share: FloatArray) -> FloatArray:
        return np.asarray(left(share) * (-1.0, 1.0))

    poses = recording(right, jitter=jitter)
    one_hand = recording(mirrored, hand="left_wrist", jitter=jitter, seed=1)
    xy, at = poses.xy.copy(), poses.landmarks.index("left_wrist")
    xy[:, at] = one_hand.xy[:, at]
    return replace(poses, xy=xy)


def with_sides_mistaken(poses: PoseSequence) -> PoseSequence:
    return replace(poses, landmarks=tuple(map(other_side, poses.landmarks)))


def test_a_two_handed_figure_is_known_when_left_and_right_were_exchanged_throughout() -> None:
    gestures = [
        Gesture.from_demonstration("round and up", with_both_hands(circle, wedge)),
        Gesture.from_demonstration("both round", with_both_hands(circle, circle)),
    ]
    query = with_sides_mistaken(with_both_hands(circle, wedge, jitter=0.01))
    result = Recognizer(Language("pool", gestures), profile="full").recognize(query)
    assert result.label == "round and up"
    assert result.distances[VOTER_NAMES.index("path"), 0] < 0.1


def test_sides_count_where_another_gesture_is_the_same_with_sides_exchanged() -> None:
    pair = [
        Gesture.from_demonstration("right one", with_both_hands(circle, wedge)),
        Gesture.from_demonstration("left one", with_sides_mistaken(with_both_hands(circle, wedge))),
        Gesture.from_demonstration("line", recording(line)),
    ]
    query = with_both_hands(circle, wedge, jitter=0.01)
    result = Recognizer(Language("pool", pair), profile="full").recognize(query)
    assert result.label == "right one"
    path = result.distances[VOTER_NAMES.index("path")]
    assert path[0] < 0.1 < path[1]


def test_an_author_can_insist_on_the_sides() -> None:
    shown = Gesture.from_demonstration("round and up", with_both_hands(circle, wedge))
    strict = replace(shown, switches=Switches(mirror="off"))
    query = with_sides_mistaken(with_both_hands(circle, wedge))
    both = Gesture.from_demonstration("both round", with_both_hands(circle, circle))
    result = Recognizer(Language("pool", [strict, both]), profile="full").recognize(query)
    assert result.distances[VOTER_NAMES.index("path"), 0] > 0.1


def test_tempo_counts_where_nothing_else_differs() -> None:
    quick, slow = with_switches(circle, "quick"), with_switches(circle, "slow", rate=10.0)
    for rate, expected in ((28.0, "quick"), (11.0, "slow")):
        query = recording(circle, rate=rate, jitter=0.01, torso=80)
        assert label_of([quick, slow], query) == expected
        assert label_of([slow, quick], query) == expected
        assert label_of([quick, with_switches(wedge, "slow")], query) == "quick"


def test_a_tempo_that_does_not_count_is_not_looked_at() -> None:
    waived = [
        with_switches(circle, "quick", tempo="off"),
        with_switches(circle, "slow", rate=10.0, tempo="off"),
    ]
    result = Recognizer(Language("pool", waived), "full").recognize(recording(circle))
    assert "tempo" not in result.counted


def test_a_mirror_image_counts_when_the_author_says_so() -> None:
    def wedge_of_the_left(share: FloatArray) -> FloatArray:
        return wedge(share) * (-1.0, 1.0)

    query = recording(wedge_of_the_left, hand="left_wrist", jitter=0.01)
    other = Gesture.from_demonstration("circle", recording(circle, hand="left_wrist"))
    assert label_of([with_switches(wedge, mirror="on"), other], query) == "shown"
    assert label_of([with_switches(wedge), other], query) != "shown"
    with pytest.raises(PoseError, match="moves in this take"):
        label_of([with_switches(wedge)], query)


def test_an_imported_gesture_has_no_mirror_image() -> None:
    drawn = Gesture.from_demonstration("circle", recording(circle))
    imported = replace(drawn, trajectory=None, switches=Switches(mirror="on"))
    assert label_of([imported], recording(circle)) == "circle"
    with pytest.raises(GestureError, match="'circle' was imported without its demonstration"):
        imported.mirror()


def test_switches_are_kept_in_the_file_and_left_out_when_automatic() -> None:
    set_by_hand = with_switches(circle, direction="on", tempo="off", mirror="on")
    text = Language("pool", [set_by_hand, with_switches(line, "line")]).to_json()
    assert text.count('"direction"') == text.count('"mirror"') == 1
    restored = Language.from_json(text)
    assert restored.gesture("shown").switches == set_by_hand.switches
    assert restored.gesture("line").switches == Switches()
    assert restored.to_json() == text


def test_a_switch_has_three_positions() -> None:
    with pytest.raises(GestureError, match="tempo must be auto, on or off, got 'fast'"):
        with_switches(circle, tempo="fast")


def test_another_movement_is_not_believed(recognizer: Recognizer) -> None:
    """A zigzag about a line is near it step by step, the arm held alike, but its path is longer."""

    def zigzag(share: FloatArray) -> FloatArray:
        height = 0.4 * np.abs((6 * share) % 2 - 1)
        return np.stack([-1.2 + share, height], axis=1)

    foreign = recognizer.recognize(recording(zigzag, jitter=0.01))
    own = recognizer.recognize(recording(circle, jitter=0.01))
    assert foreign.confidence < 0.5 < 0.7 < own.confidence
