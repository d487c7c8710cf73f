"""One-shot accuracy on labelled takes: the same person's further takes, and other people's."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from app.evaluation.confusion import ConfusionMatrix
from app.evaluation.protocols import label_read
from app.recognition import (
    Gesture,
    GestureError,
    Language,
    OsgError,
    PoseSequence,
    Recognizer,
)

Progress = Callable[[int, int], None]
"""``progress(done, total)``, after every language or take."""


@dataclass(frozen=True, eq=False)
class LabelledTake:
    """One showing of a gesture, without salutes.

    Attributes
    ----------
    source
        Where it comes from, for people.
    label
        What is shown.
    person
        By whom; empty where nobody said.
    poses
        The movement.

    """

    source: str
    label: str
    person: str
    poses: PoseSequence


@dataclass(frozen=True, eq=False)
class OneShot:
    """What came of every choice of templates.

    Attributes
    ----------
    same_person
        Queries by the person whose takes made the language (user-dependent). Where people are not
        told apart, all queries.
    other_people
        Queries by everybody else (user-independent).
    languages
        How many languages of one take a gesture were made.
    unusable
        Sources of the takes that cannot be a demonstration, each with the reason.

    """

    same_person: ConfusionMatrix
    other_people: ConfusionMatrix
    languages: int
    unusable: dict[str, str]


def one_shot(
    takes: Sequence[LabelledTake], *, profile: str, progress: Progress | None = None
) -> OneShot:
    """Measure how well one demonstration a gesture names all other takes.

    Each person's n-th takes of all gestures make a language, so that every take is a demonstration
    at least once (a person's gestures with fewer takes begin again with the first). It is asked
    for all other takes of its gestures.

    Parameters
    ----------
    takes
        At least two gestures by one person, one of them twice or by another person too.
    profile
        Of the recogniser.
    progress
        Called after every language.

    Raises
    ------
    OsgError
        When no person shows two gestures, or nothing is left to ask for.

    """
    gestures, unusable = _gestures(takes)
    chosen = [pick for pick in _choices(takes, gestures) if len(pick) > 1]
    labels = sorted({take.label for take in takes})
    if not chosen:
        raise OsgError(
            f"{len(takes)} usable takes of {len(labels)} gestures, and no person shows two of "
            "them: record at least two gestures by the same person"
        )
    same: list[tuple[str, str | None]] = []
    others: list[tuple[str, str | None]] = []
    for done, templates in enumerate(chosen, start=1):
        person = takes[templates[0]].person
        language = Language("one take a gesture", [gestures[index] for index in templates])
        recognizer = Recognizer(language, profile)
        for index, take in enumerate(takes):
            if take.label in language.labels and index not in templates:
                asked = same if take.person == person else others
                asked.append((take.label, label_read(recognizer, take.poses)))
        if progress is not None:
            progress(done, len(chosen))
    if not same and not others:
        raise OsgError(
            f"{len(takes)} takes of {len(labels)} gestures make languages and leave none to ask "
            "for: record at least two takes of a gesture"
        )
    return OneShot(_matrix(labels, same), _matrix(labels, others), len(chosen), unusable)


def read_by(
    language: Language,
    takes: Sequence[LabelledTake],
    *,
    profile: str,
    progress: Progress | None = None,
) -> ConfusionMatrix:
    """Let a given language name all takes, also those of gestures that it does not have.

    Parameters
    ----------
    language
        Made beforehand, and not from these takes.
    takes, profile, progress
        As for `one_shot`; progress is called after every take.

    """
    recognizer = Recognizer(language, profile)
    read: list[str | None] = []
    for take in takes:
        read.append(label_read(recognizer, take.poses))
        if progress is not None:
            progress(len(read), len(takes))
    foreign = sorted({take.label for take in takes} - set(language.labels))
    return ConfusionMatrix.of([*language.labels, *foreign], [take.label for take in takes], read)


def _gestures(takes: Sequence[LabelledTake]) -> tuple[dict[int, Gesture], dict[str, str]]:
    """Make a gesture of every take that can be one; say of the others why not."""
    gestures, unusable = {}, {}
    for index, take in enumerate(takes):
        try:
            gestures[index] = Gesture.from_demonstration(take.label, take.poses)
        except GestureError as error:
            unusable[take.source] = str(error)
    return gestures, unusable


def _choices(
    takes: Sequence[LabelledTake], gestures: dict[int, Gesture]
) -> Iterator[tuple[int, ...]]:
    """Choose templates: indices of one take of each gesture that a person shows."""
    for person in sorted({take.person for take in takes}):
        own: dict[str, list[int]] = {}
        for index in gestures:
            if takes[index].person == person:
                own.setdefault(takes[index].label, []).append(index)
        for round_number in range(max(map(len, own.values()), default=0)):
            yield tuple(indices[round_number % len(indices)] for indices in own.values())


def _matrix(labels: Sequence[str], pairs: Sequence[tuple[str, str | None]]) -> ConfusionMatrix:
    return ConfusionMatrix.of(labels, [shown for shown, _ in pairs], [read for _, read in pairs])
