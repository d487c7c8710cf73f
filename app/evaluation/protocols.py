"""The paper's protocols: a language is asked to name plausible variants of its own gestures.

The paper draws 200 variants of each of 3 gestures, after Cabrera and Wachs, and shows each of 8
gestures 50 times (Sec. V). Here both are variants: nobody shows a gesture fifty times to a
computer.
"""

from __future__ import annotations

from collections.abc import Callable

from app.evaluation.confusion import ConfusionMatrix
from app.recognition import Language, OsgError, PoseError, PoseSequence, Recognizer
from app.recognition.gestures.gesture import condense
from app.recognition.language.schema import MAX_GESTURES
from app.recognition.poses.trajectory import Trajectory
from app.recognition.simulation.variation import Person, draw_variants

Progress = Callable[[int, int], None]
"""``progress(done, total)``, after every query."""


def recognised_variants(
    language: Language,
    count: int,
    *,
    profile: str,
    seed: int = 0,
    person: Person = "same",
    progress: Progress | None = None,
) -> ConfusionMatrix:
    """Let a language name variants of each of its gestures.

    Parameters
    ----------
    language
        Each gesture with its demonstration.
    count
        Variants of each gesture.
    profile
        Of the recogniser.
    seed
        Of the variants; each gesture has its own beside it.
    person
        Whether the variants differ as takes by the demonstrator do or as those by other people.
    progress
        Called after every query.

    Raises
    ------
    OsgError
        When a gesture was imported without its demonstration, or there is no such profile.

    """
    recognizer = Recognizer(language, profile)
    shown: list[str] = []
    read: list[str | None] = []
    for number, gesture in enumerate(language.gestures):
        if gesture.trajectory is None:
            raise OsgError(
                f"{gesture.label!r} was imported without its demonstration, so it has no "
                "variants: define it again from a clip"
            )
        # Gestures drawn with one seed would all waver alike.
        drawn = draw_variants(
            gesture.trajectory, count, seed=seed * MAX_GESTURES + number, person=person
        )
        for variant in drawn:
            shown.append(gesture.label)
            read.append(label_read(recognizer, variant))
            if progress is not None:
                progress(len(read), count * len(language.gestures))
    return ConfusionMatrix.of(language.labels, shown, read)


def label_read(recognizer: Recognizer, shown: PoseSequence | Trajectory) -> str | None:
    """Return the label of a recognition, None also where nothing can be compared."""
    try:
        if isinstance(shown, Trajectory):
            return recognizer.recognize_trajectory(condense(shown)).label
        return recognizer.recognize(shown).label
    except PoseError:
        return None
