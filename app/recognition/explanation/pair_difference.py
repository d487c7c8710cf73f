"""A contrast: in what two demonstrations of a language differ, and when."""

from __future__ import annotations

from dataclasses import dataclass

from app.recognition.explanation.alignment import Alignment, align
from app.recognition.explanation.differences import find_differences
from app.recognition.explanation.divergence import measure_divergence
from app.recognition.explanation.pairing import Pairing
from app.recognition.gestures.gesture import condense
from app.recognition.recognizer import Recognizer
from app.recognition.text.wording import humanize


@dataclass(frozen=True, eq=False)
class PairDifference:
    """How one demonstration differs from another.

    Attributes
    ----------
    words
        A clause for people, to be read after "differs in this: ".
    stroke
        Seconds of the first demonstration's clock between which the two part most.
    alignment
        Which moment of the first corresponds to which of the other, by their paths.

    """

    words: str
    stroke: tuple[float, float]
    alignment: Alignment


def compare_pair(recognizer: Recognizer, one: int, other: int) -> PairDifference | None:
    """Tell how the demonstration of one gesture differs from that of another.

    Parameters
    ----------
    recognizer
        Of the language, profile ``full``.
    one, other
        Indices of two gestures.

    Returns
    -------
    None where the two cannot be compared.

    """
    shown, against = (recognizer.language.gestures[index] for index in (one, other))
    if shown.trajectory is None:
        return None
    query = condense(shown.trajectory)
    compared = recognizer.compare(query)
    traversal = compared.traversals[other]
    if traversal is None:
        return None
    pairing = Pairing.of(query, against, traversal, mirrored=bool(compared.mirrored[other]))
    if pairing is None:
        return None
    alignment = align(pairing.query, pairing.example, pairing.landmarks)
    assert alignment is not None  # paths can always be compared
    parted = measure_divergence(alignment, pairing.query.paths, pairing.example.movement.paths)
    named = find_differences(pairing, sees_direction=True)
    little = (
        f"little, and most from {parted.start:.1f} to {parted.end:.1f} s, when the "
        f"{humanize(parted.landmark)} {parted.shown}"
    )
    words = named[0].words if named else little
    return PairDifference(words, (parted.start, parted.end), alignment)
