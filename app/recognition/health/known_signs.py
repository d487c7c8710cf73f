"""Known signs: gestures that look like a sign which divers already know with another meaning."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from app.recognition.decision.result import Recognition
from app.recognition.errors import PoseError
from app.recognition.explanation.causes import ALIKE
from app.recognition.gestures.demonstration import condense
from app.recognition.health.finding import Finding
from app.recognition.language.language import Language
from app.recognition.poses.trajectory import Trajectory
from app.recognition.recognizer import Recognizer


def find_known_signs(
    language: Language, known: Language, advance: Callable[[], None] = lambda: None
) -> Iterator[Finding]:
    """Yield one finding for each gesture that is much like one of the known signs.

    Each demonstration is recognised by profile ``full`` among the known signs, as if it were a
    take. A gesture with the label of the sign is meant to be that sign.

    Parameters
    ----------
    language
        The language to check.
    known
        The signs that divers know, each with its meaning as description.
    advance
        Called after each gesture; an exception that it raises ends the work.

    """
    if not known.gestures:
        return
    recognizer = Recognizer(known, "full")
    meanings = {gesture.label: gesture.description for gesture in known.gestures}
    for gesture in language.gestures:
        read = [_recognize(recognizer, shown) for shown in gesture.trajectories]
        # Whether it is accepted does not matter: a pair looks like a sign too, and of gestures that
        # a language lacks every second one is accepted.
        signs = [each.nearest for each in read if each and each.nearest_novelty < ALIKE]
        own = gesture.label.casefold()
        sign = next((each for each in signs if each.casefold() != own), None)
        if sign is not None:
            meaning = f' ("{meanings[sign]}")' if meanings[sign] else ""
            yield Finding(
                "known_sign",
                (gesture.label,),
                f"{gesture.label} looks like the divers' sign {sign}{meaning}: a diver may show "
                "that sign to another one, and the robot acts on it; choose another movement, or "
                "give the gesture the sign's meaning",
            )
        advance()


def _recognize(recognizer: Recognizer, shown: Trajectory) -> Recognition | None:
    try:
        return recognizer.recognize_trajectory(condense(shown))
    except PoseError:  # no landmark that a sign needs moves
        return None
