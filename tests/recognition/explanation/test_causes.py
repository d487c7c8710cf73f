"""Causes: the one fault of a take is named first, and nothing without evidence."""

import re
from dataclasses import replace

import numpy as np
import pytest

from app.recognition import Gesture, Language, PoseSequence, Recognizer
from app.recognition.explanation.causes import SENTENCES, CauseKind, find_causes
from app.recognition.explanation.context import RecognitionContext
from app.recognition.explanation.demonstration_faults import DemonstrationFault, FaultKind
from app.recognition.gestures.switches import Switches
from app.recognition.poses.landmarks import other_side
from app.recognition.poses.sequence import FloatArray
from tests.recognition.explanation.test_strokes import stopping
from tests.recognition.held_takes import FLAT
from tests.recognition.moving_takes import circle as circled
from tests.recognition.moving_takes import draw, without_hands
from tests.recognition.strategies import Shape, circle, line, recording


def corners(*points: tuple[float, float]) -> Shape:
    """Return the shape that goes straight from point to point, each side in the same time."""

    def shape(share: FloatArray) -> FloatArray:
        at = np.linspace(0, 1, len(points))
        return np.stack(
            [np.interp(share, at, [point[axis] for point in points]) for axis in range(2)], axis=1
        )

    return shape


HOOK = ((-1.2, -0.4), (-0.4, -0.4), (-0.4, 0.4), (-0.9, 0.4), (-0.9, 0.0))
hook = corners(*HOOK)
stairs = corners((-1.2, -0.6), (-1.2, -0.2), (-0.8, -0.2), (-0.8, 0.2), (-0.4, 0.2), (-0.4, 0.6))


def language_of(shape: Shape = hook) -> Language:
    gestures = [
        Gesture.from_demonstration(label, recording(of))
        for label, of in (("hook", shape), ("stairs", stairs), ("line", line))
    ]
    gestures[0] = replace(gestures[0], switches=Switches(direction="on"))
    return Language("shapes", gestures)


def causes_of(
    query: PoseSequence,
    language: Language | None = None,
    faults: tuple[DemonstrationFault, ...] = (),
) -> list[CauseKind]:
    recognizer = Recognizer(language or language_of(), "full")
    context = RecognitionContext(
        recognizer=recognizer, poses=query, whole=query, faults={"hook": [faults]}
    )
    assert context.result.label != "hook", "the fault does not matter"
    return [cause.kind for cause in find_causes(context, "hook")]


def in_place(way: tuple[float, float]) -> Shape:
    middle = np.mean(HOOK, axis=0)
    return lambda share: middle + (hook(share) - middle) * way


def language_of_arms() -> Language:
    """Return a language whose other gestures are shown with the left arm."""
    left = Gesture.from_demonstration("left", recording(line, hand="left_wrist"))
    return language_of().with_gesture(left)


def mirror_body(poses: PoseSequence) -> PoseSequence:
    names = tuple(other_side(name) for name in poses.landmarks)
    return replace(poses, landmarks=names, xy=poses.xy * (-1.0, 1.0) + (640.0, 0.0))


def leap(poses: PoseSequence) -> PoseSequence:
    """Let the right wrist leap to the left elbow twice, each time for a third of a second."""
    xy = poses.xy.copy()
    for first in (18, 38):
        xy[first : first + 11, poses.landmarks.index("right_wrist")] = xy[
            first, poses.landmarks.index("left_elbow")
        ]
    return replace(poses, xy=xy)


def change_body(poses: PoseSequence) -> PoseSequence:
    """Show a smaller body beside the diver for half a second."""
    xy = poses.xy.copy()
    middle = xy[0].mean(axis=0)
    xy[20:36] = middle + (200.0, 0.0) + 0.6 * (xy[0] - middle)
    return replace(poses, xy=xy)


@pytest.mark.parametrize(
    ("query", "kind"),
    [
        (recording(in_place((-1, 1))), "mirrored"),
        (recording(corners(*HOOK[:3]), frames=30), "ended_early"),
        (
            recording(corners((-0.1, 1.3), (-1.0, 1.0), (-0.1, 0.6), *HOOK), frames=105),
            "part_added",
        ),
        (leap(recording(hook)), "keypoints_jumped"),
        (change_body(recording(hook)), "other_person"),
    ],
)
def test_the_one_fault_of_a_take_is_named_first(query: PoseSequence, kind: str) -> None:
    assert causes_of(query)[0] == CauseKind(kind)


@pytest.mark.parametrize(
    ("query", "kind"),
    [
        (recording(in_place((-1, -1))), "upside_down"),
        (recording(lambda share: hook(1 - share)), "reversed"),
        (recording(corners(*HOOK[2:]), frames=30), "begun_late"),
        (recording(corners(*HOOK[:3]), frames=30), "ended_early"),
    ],
)
def test_a_fault_that_others_explain_nearly_as_well_is_not_claimed_as_another(
    query: PoseSequence, kind: str
) -> None:
    assert {each.value for each in causes_of(query)} <= {kind}


def test_a_take_that_is_mirrored_and_unfinished_is_named_as_both() -> None:
    points = [(-0.8 - (x + 0.8), y) for x, y in HOOK[:3]]
    query = recording(corners(*points), frames=30)
    context = RecognitionContext(
        recognizer=Recognizer(language_of(), "full"), poses=query, whole=query
    )
    (cause,) = find_causes(context, "hook", explained=0.3, following=10.0)
    assert (cause.kind, cause.also) == ("mirrored", "ended_early")
    assert "the mirror image of 'hook' and is unfinished" in cause.sentence


def test_the_other_arm_is_named() -> None:
    assert causes_of(mirror_body(recording(hook)), language_of_arms())[0] == CauseKind.other_arm


def test_of_two_gestures_that_are_nearly_alike_the_other_is_named() -> None:
    nearly = corners(*HOOK[:4], (-0.9, -0.05))
    twins = language_of().with_gesture(Gesture.from_demonstration("twin", recording(nearly)))
    assert causes_of(recording(nearly, jitter=0.01), twins) == [CauseKind.near_gesture]


def test_a_hand_that_is_not_seen_though_it_counts_is_named() -> None:
    gesture = Gesture.from_demonstration("hook", draw(FLAT, circled()))
    gesture = replace(gesture, switches=replace(gesture.switches, hand_shape="on"))
    language = Language("hands", [gesture, Gesture.from_demonstration("line", recording(line))])
    assert causes_of(without_hands(draw(FLAT, circled())), language) == [CauseKind.no_hand]


def test_another_movement_has_no_cause() -> None:
    assert causes_of(recording(circle, jitter=0.01)) == []


def test_a_take_that_is_read_right_has_no_cause() -> None:
    query = recording(hook, jitter=0.005)
    context = RecognitionContext(
        recognizer=Recognizer(language_of(), "full"), poses=query, whole=query
    )
    assert find_causes(context, "hook") == ()


def test_a_known_fault_of_the_demonstration_comes_before_a_missing_part() -> None:
    fault = DemonstrationFault(
        kind=FaultKind.reaches_salute, words="reaches the salutes", remedy="set_range"
    )
    ways = ((-0.3, -0.9), *HOOK, (-0.3, -0.9))
    bad = language_of(corners(*ways))
    assert causes_of(recording(corners(*HOOK[1:])), bad, (fault,))[0] == CauseKind.demonstration
    # What the keypoints of the take show is no fault of the demonstration.
    assert causes_of(change_body(recording(hook)), faults=(fault,))[0] == CauseKind.other_person


def test_moments_are_those_of_the_takes_clock() -> None:
    query = recording(corners(*HOOK[:3]), frames=30)
    late = replace(query, time=query.time + 7)
    context = RecognitionContext(
        recognizer=Recognizer(language_of(), "full"), poses=late, whole=late
    )
    cause = find_causes(context, "hook")[0]
    assert cause.start == cause.end == pytest.approx(query.time[-1] + 7, abs=0.15)
    assert cause.kind == CauseKind.ended_early


@pytest.mark.parametrize("kind", sorted(SENTENCES))
def test_a_sentence_has_at_most_fifteen_words(kind: str) -> None:
    words = SENTENCES[kind].format(
        label="'hook'",
        other="'line'",
        also="",
        where="in the middle of",
        frames="12 of 60 frames",
        degrees=60,
        start=12.25,
        end=16.75,
    )
    assert len(words.split()) <= 15
    assert re.search(r"\.$", words) or not words


@pytest.mark.parametrize("kind", FaultKind)
def test_a_fault_of_a_demonstration_has_at_most_fifteen_words(kind: FaultKind) -> None:
    fault = DemonstrationFault(kind=kind, words="", remedy="show_again")
    assert len(fault.describe("hook").split()) <= 15


def test_what_the_keypoints_show_stands_before_what_a_change_proves() -> None:
    query = recording(in_place((-1, 1)))
    xy, wrist = query.xy.copy(), query.landmarks.index("right_wrist")
    xy[26:36, wrist] += (250.0, 0.0)
    assert causes_of(replace(query, xy=xy))[0] == CauseKind.keypoints_jumped


BOX = ((-1.1, -0.4), (-0.3, -0.4), (-0.3, 0.4), (-1.1, 0.4), (-1.1, -0.4))


def test_a_way_from_the_salute_is_told_as_that_and_with_the_range_without_it() -> None:
    box = Gesture.from_demonstration("box", recording(stopping(corners(*BOX), 4), frames=90))
    query = recording(stopping(corners((-1.1, 0.9), *BOX), 5), frames=112)
    flag = Gesture.from_demonstration("flag", query)
    recognizer = Recognizer(Language("three", [*language_of().gestures, box, flag]), "full")
    context = RecognitionContext(recognizer=recognizer, poses=query, whole=query)
    cause = find_causes(context, "box")[0]
    assert cause.kind == CauseKind.part_added
    assert cause.sentence.startswith("A way before 'box' is included. Set its range: 0.")
    assert (cause.start, cause.end) == pytest.approx((0.0, 0.7), abs=0.2)


def test_an_arm_that_sinks_at_the_end_of_a_clip_is_a_missed_salute() -> None:
    query = recording(stopping(corners((-0.7, -0.8), (-0.5, 0.5)), 1), frames=30)
    context = RecognitionContext(
        recognizer=Recognizer(language_of(), "full"), poses=query, whole=query, closed=False
    )
    (cause,) = find_causes(context, "hook")
    assert cause.sentence.startswith("The first salute was missed")
    assert find_causes(replace(context, closed=True), "hook") == ()
