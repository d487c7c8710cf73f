"""Known signs: gestures that look like a sign known to divers are found before the dive."""

from dataclasses import replace

from app.recognition import Language
from app.recognition.health.check import check_health, find_known_signs
from tests.recognition.demonstrations import ARMS, pool
from tests.recognition.strategies import circle, line, recording

KNOWN = replace(
    pool(turn=circle, level=line),
    gestures=[
        replace(gesture, description=meaning)
        for gesture, meaning in zip(
            pool(turn=circle, level=line).gestures, ("Turn around", ""), strict=True
        )
    ],
)


def test_a_gesture_like_a_known_sign_is_named_with_the_meaning_of_the_sign() -> None:
    (finding,) = find_known_signs(pool(waypoint=circle, LEVEL=line), KNOWN)
    assert (finding.kind, finding.gestures) == ("known_sign", ("waypoint",))
    assert 'looks like the divers\' sign turn ("Turn around")' in finding.message


def test_other_movements_are_no_known_sign() -> None:
    assert not list(find_known_signs(pool(waypoint=circle), pool(level=line)))


def test_every_further_demonstration_is_looked_at() -> None:
    language = pool(both=line)
    both = language.gestures[0].with_demonstration(recording(circle, frames=45, landmarks=ARMS))
    (finding,) = find_known_signs(replace(language, gestures=[both]), pool(turn=circle))
    assert finding.gestures == ("both",)


def test_the_health_check_looks_for_known_signs_if_it_is_given_any() -> None:
    language = pool(waypoint=circle, line=line)
    kinds = {finding.kind for finding in check_health(language).findings}
    assert "known_sign" not in kinds
    report = check_health(language, known_signs=KNOWN)
    assert "known_sign" in {finding.kind for finding in report.findings}


def test_without_known_signs_nothing_is_found() -> None:
    assert not list(find_known_signs(pool(circle=circle), Language("none")))
