"""Blame: the demonstration that is at fault for the known takes is found, and no other."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from app.recognition import Gesture, Language, PoseSequence, Recognizer
from app.recognition.explanation.blame import Evidence, find_blame
from app.recognition.explanation.context import KnownTake, KnownTakes
from app.recognition.poses.sequence import FloatArray
from tests.recognition.explanation.test_causes import HOOK, corners, hook
from tests.recognition.explanation.test_strokes import stopping
from tests.recognition.strategies import Shape, circle, line, recording, wedge

SHAPES: dict[str, Shape] = {"hook": hook, "circle": circle, "line": line, "wedge": wedge}
SALUTE = (0.3, -1.0)


def language_of(bad: PoseSequence | None = None) -> Language:
    shown = {label: recording(shape) for label, shape in SHAPES.items()}
    if bad is not None:
        shown["hook"] = bad
    return Language("pool", [Gesture.from_demonstration(*each) for each in shown.items()])


def _resize(shape: Shape, size: float, share: FloatArray) -> FloatArray:
    return np.asarray(shape(share) * size)


def known(recognizer: Recognizer) -> KnownTakes:
    """Return three takes of each gesture, as large as their divers' arms."""
    takes = []
    for label, shape in SHAPES.items():
        for seed, size in enumerate((0.9, 1.0, 1.1)):
            poses = recording(partial(_resize, shape, size), jitter=0.01, seed=seed)
            takes.append(KnownTake(label, recognizer.query(poses)))
    return KnownTakes(recognizer, takes)


@pytest.mark.parametrize(
    ("bad", "change"),
    [
        (recording(corners(SALUTE, *HOOK, SALUTE), frames=90), "cut"),
        (recording(corners((-0.3, 0.8), (-1.2, 0.1), (-0.2, 0.1), (-1.2, 0.8))), "show_again"),
    ],
)
def test_a_bad_demonstration_is_blamed(bad: PoseSequence, change: str) -> None:
    recognizer = Recognizer(language_of(bad), "full")
    blamed = find_blame(known(recognizer))
    assert [(each.label, each.demonstration) for each in blamed] == [("hook", 0)]
    assert blamed[0].change == change
    assert blamed[0].failing == 3
    assert blamed[0].evidence.unlike > 1.8
    assert blamed[0].repaired >= 2
    assert len(blamed[0].sentence.split()) <= 15


def test_a_good_language_has_no_demonstration_to_blame() -> None:
    recognizer = Recognizer(language_of(), "full")
    assert find_blame(known(recognizer)) == ()
    assert find_blame(KnownTakes(recognizer, [])) == ()


def test_the_one_bad_demonstration_of_several_is_left_out() -> None:
    ways = recording(corners((-0.3, 0.8), (-1.2, 0.1), (-0.2, 0.1), (-1.2, 0.8)))
    good = language_of()
    both = good.gesture("hook").with_demonstration(ways, "Ben")
    recognizer = Recognizer(good.with_changed(both), "full")
    takes = [KnownTake("hook", recognizer.query(recording(hook)))]
    # The takes are read by the good demonstration: none fails.
    assert find_blame(KnownTakes(recognizer, takes)) == ()


def test_a_cut_says_what_it_keeps() -> None:
    bad = recording(corners(SALUTE, *HOOK, SALUTE), frames=90)
    recognizer = Recognizer(language_of(bad), "full")
    (blamed,) = find_blame(known(recognizer), ["hook"])
    assert blamed.start is not None
    assert blamed.end is not None
    assert 0.1 < blamed.start < blamed.end < bad.time[-1] - 0.1
    repaired = recognizer.language.gesture("hook").with_cut(0, blamed.start, blamed.end)
    after = Recognizer(recognizer.language.with_changed(repaired), "full")
    assert after.recognize(recording(hook)).label == "hook"
    assert replace(blamed, change="leave_out").sentence.endswith("Leave it out.")


def test_less_evidence_lets_a_good_demonstration_be_suspected_only_if_takes_fail() -> None:
    bad = recording(corners((-0.3, 0.8), (-1.2, 0.1), (-0.2, 0.1), (-1.2, 0.8)))
    recognizer = Recognizer(language_of(bad), "full")
    (suspected,) = find_blame(known(recognizer), least=-np.inf)
    assert suspected.evidence.failing == 1
    blamed = find_blame(known(recognizer), least=suspected.evidence.weigh() + 0.01)
    assert [each for each in blamed if not each.odd] == []


def test_each_kind_of_evidence_weighs() -> None:
    some = Evidence(unlike=2.0, failing=0.5, gain=0.5)
    for more in ({"unlike": 3.0}, {"failing": 1.0}, {"gain": 1.0}):
        assert replace(some, **more).weigh() > some.weigh()
    # A change that repairs other gestures too says no more of this demonstration.
    assert replace(some, gain=9.0).weigh() == replace(some, gain=2.0).weigh()


def test_a_known_take_that_is_a_demonstration_is_read_by_the_others() -> None:
    ways = recording(corners((-0.3, 0.8), (-1.2, 0.1), (-0.2, 0.1), (-1.2, 0.8)))
    both = language_of().gesture("hook").with_demonstration(ways, "Ben")
    recognizer = Recognizer(language_of().with_changed(both), "full")
    take = KnownTake("hook", recognizer.query(ways))
    itself = replace(take, without=(("hook", 1),))
    assert KnownTakes(recognizer, [take]).readings == ["hook"]
    assert KnownTakes(recognizer, [itself]).readings != ["hook"]
    # As a demonstration it repairs nothing: before and after it is read by the other one.
    alone = Recognizer(language_of(), "full")
    assert KnownTakes(alone, [replace(take, without=())]).readings != ["hook"]
    # Left out, it is no demonstration any more, and the ones after it have moved.
    assert itself.after_leaving_out(("hook", 1)).without == ()
    assert itself.after_leaving_out(("hook", 0)).without == (("hook", 0),)
    assert itself.after_leaving_out(("circle", 0)).without == (("hook", 1),)
    gone = alone.language.with_changed(both.without_demonstration(0))
    repaired, broken = KnownTakes(recognizer, [itself]).try_change(
        Recognizer(gone, "full"), ("hook", 0)
    )
    assert repaired == broken == []


BOX = ((-1.1, -0.4), (-0.3, -0.4), (-0.3, 0.4), (-1.1, 0.4), (-1.1, -0.4))


@pytest.mark.parametrize(
    ("odd", "sentence"),
    [
        ((*BOX, *BOX[1:3]), "Your demonstration of 'box' has 6 strokes; 2 of 2 takes have 4."),
        (BOX[:2], "Your demonstration of 'box' has one stroke; 2 of 2 takes have 4."),
        (BOX, None),
    ],
)
def test_a_demonstration_that_is_unlike_takes_that_agree_is_the_odd_one(
    odd: tuple[tuple[float, float], ...], sentence: str | None
) -> None:
    def draw(points: tuple[tuple[float, float], ...], seed: int = 0) -> PoseSequence:
        shape = stopping(corners(*points), len(points) - 1)
        return recording(shape, frames=22 * len(points), jitter=0.003, seed=seed)

    box = Gesture.from_demonstration("box", draw(odd))
    recognizer = Recognizer(language_of().with_gesture(box), "full")
    takes = [KnownTake("box", recognizer.query(draw(BOX, seed))) for seed in (1, 2)]
    told = [each.sentence for each in find_blame(KnownTakes(recognizer, takes), ["box"])]
    assert told == [sentence] * bool(sentence)
    assert find_blame(KnownTakes(recognizer, takes[:1]), ["box"]) == ()
