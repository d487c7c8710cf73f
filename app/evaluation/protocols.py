"""Protocols of the paper: a language recognises simulated variants of its own gestures.

The paper draws 200 variants of each of 3 gestures, after Cabrera and Wachs, and shows each of 8
gestures 50 times (Sec. V). Here both protocols use variants in place of repeated takes.
"""

from __future__ import annotations

from collections.abc import Callable

from app.evaluation.confusion import Answer, ConfusionMatrix
from app.recognition import Language, OsgError, PoseError, PoseSequence, Recognizer
from app.recognition.gestures.demonstration import condense
from app.recognition.language.file_schema import MAX_GESTURES
from app.recognition.poses.trajectory import Trajectory
from app.recognition.simulation.variation import Person, draw_variants, take_turns

Progress = Callable[[int, int], None]
"""``progress(done, total)``, after every query, or every language of one take."""


def recognize_variants(
    language: Language,
    count: int,
    *,
    profile: str,
    seed: int = 0,
    person: Person = "same",
    progress: Progress | None = None,
) -> ConfusionMatrix:
    """Recognise variants of each gesture of a language by the language itself.

    Parameters
    ----------
    language
        Language whose gestures all have a demonstration.
    count
        Variants of each gesture, from its demonstrations in turn.
    profile
        Profile of the recogniser.
    seed
        Random seed of the variants; combined with the gesture's number.
    person
        Whether the variants simulate takes of the demonstrator or of another person.
    progress
        Called after every query.

    Raises
    ------
    OsgError
        When a gesture was imported without its demonstration, or there is no such profile.

    """
    recognizer = Recognizer(language, profile)
    shown: list[str] = []
    read: list[Answer] = []
    for number, gesture in enumerate(language.gestures):
        if gesture.trajectory is None:
            raise OsgError(
                f"{gesture.label!r} was imported without its demonstration, so it has no "
                "variants: define it again from a clip"
            )
        # The same seed would give all gestures the same variation.
        drawn = [
            draw_variants(each, count, seed=seed * MAX_GESTURES + number, person=person)
            for each in gesture.trajectories
        ]
        for variant in take_turns(drawn):
            shown.append(gesture.label)
            read.append(recognize_answer(recognizer, variant))
            if progress is not None:
                progress(len(read), count * len(language.gestures))
    return ConfusionMatrix.of(language.labels, shown, read)


def recognize_answer(recognizer: Recognizer, shown: PoseSequence | Trajectory) -> Answer:
    """Return the label or the pair of a recognition; None when rejected or not comparable."""
    try:
        if isinstance(shown, Trajectory):
            result = recognizer.recognize_trajectory(condense(shown))
        else:
            result = recognizer.recognize(shown)
    except PoseError:
        return None
    return result.label or result.pair
