"""Pair difference: how and when the demonstrations of two gestures differ."""

from __future__ import annotations

from dataclasses import dataclass

from app.recognition.explanation.alignment import Alignment, align
from app.recognition.explanation.differences import find_differences
from app.recognition.explanation.divergence import measure_divergence
from app.recognition.explanation.pairing import Pairing
from app.recognition.gestures.demonstration import condense
from app.recognition.recognizer import Recognizer
from app.recognition.text.wording import humanize


@dataclass(frozen=True, eq=False)
class PairDifference:
    """The difference of one demonstration from another.

    Attributes
    ----------
    words
        The difference as a clause, in which "it" is the first demonstration.
    stroke
        Seconds in the first demonstration's clock between which the two differ most.
    alignment
        DTW alignment of the two demonstrations' paths.

    """

    words: str
    stroke: tuple[float, float]
    alignment: Alignment


def compare_pair(recognizer: Recognizer, one: int, other: int) -> PairDifference | None:
    """Compare the demonstrations of two gestures.

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
    shown = recognizer.language.gestures[one]
    if shown.trajectory is None:
        return None
    query = condense(shown.trajectory)
    compared = recognizer.compare(query)
    traversal = compared.traversals[other]
    if traversal is None:
        return None
    against = compared.find_nearest_demonstration(recognizer.language.gestures, other)
    pairing = Pairing.of(query, against, traversal, mirrored=bool(compared.mirrored[other]))
    if pairing is None:
        return None
    alignment = align(pairing.query, pairing.example, pairing.landmarks)
    assert alignment is not None  # paths can always be compared
    parted = measure_divergence(alignment, pairing.query.paths, pairing.example.movement.paths)
    named = find_differences(pairing, sees_direction=True)
    slightly = (
        f"it is almost the same movement and differs most from {parted.start:.1f} to "
        f"{parted.end:.1f} s, when the {humanize(parted.landmark)} {parted.shown}"
    )
    words = named[0].words if named else slightly
    return PairDifference(words, (parted.start, parted.end), alignment)
