"""Divers' signs are shown between two salutes, each with a meaning."""

import pytest

from languages.render.performance import Manner, perform_sign
from languages.render.signs import SIGNS, name_clip

RATE = 25


@pytest.mark.parametrize("label", SIGNS)
def test_a_sign_lies_between_two_salutes(label: str) -> None:
    performance = perform_sign(SIGNS[label], Manner(), RATE, seed=1)
    names = [phase.name for phase in performance.phases]
    first, last = names.index("salute"), len(names) - 1 - names[::-1].index("salute")
    strokes = [phase for phase in performance.phases if phase.name == "stroke"]
    assert set(names[first + 1 : last]) == {"transit", "stroke"}
    assert sum(phase.end - phase.start for phase in strokes) >= 1.0


def test_a_quicker_diver_shows_a_sign_in_less_time() -> None:
    slow, quick = (perform_sign(SIGNS["ok"], Manner(tempo=t), RATE, seed=1) for t in (1.0, 1.3))
    assert len(quick) < len(slow)


def test_every_sign_has_a_meaning_and_a_clip_of_its_own() -> None:
    assert all(sign.meaning for sign in SIGNS.values())
    assert len({name_clip(label) for label in SIGNS}) == len(SIGNS)
