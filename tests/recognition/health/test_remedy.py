"""Remedies: proposed only if simulated trials of the changed language show that they help."""

from app.recognition import Language, Recognizer
from app.recognition.health.remedy import HELPS, MOST_PROPOSED, TrialRunner, find_pair_remedies
from tests.recognition.demonstrations import pool
from tests.recognition.strategies import circle, infinity, line

REHEARSING = TrialRunner(takes=4, seed=0, person="another")


def remedies_of(language: Language) -> tuple[list[str], list[float]]:
    recognizer = Recognizer(language, "full")
    found = find_pair_remedies(language, (0, 1), REHEARSING(recognizer), REHEARSING)
    return [remedy.kind for remedy in found], [remedy.after.rate for remedy in found]


def test_two_equal_gestures_are_told_apart_by_another_hand_or_by_both() -> None:
    kinds, after = remedies_of(pool(circle=circle, ring=circle, infinity=infinity))
    assert {"other_hand", "both_hands"} & set(kinds)
    assert 0 < len(kinds) <= MOST_PROPOSED
    assert after == sorted(after)
    assert max(after) <= HELPS * 0.5


def test_a_remedy_carries_the_effect_that_was_computed() -> None:
    language = pool(circle=circle, ring=circle)
    (first, *_) = find_pair_remedies(
        language, (0, 1), REHEARSING(Recognizer(language, "full")), REHEARSING
    )
    assert first.before.rate == 0.5
    assert first.to_dict()["after"] == first.after.to_dict()
    assert first.gesture in first.text


def test_what_does_not_help_is_not_proposed() -> None:
    """A line is nothing like an infinity: no change could halve a confusion of zero."""
    language = pool(line=line, infinity=infinity)
    before = REHEARSING(Recognizer(language, "full"))
    proposed = find_pair_remedies(language, (0, 1), before, REHEARSING)
    assert all(remedy.after.rate <= HELPS * remedy.before.rate for remedy in proposed)
