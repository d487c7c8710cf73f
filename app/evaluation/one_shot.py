"""Protocols: takes of other people, or simulated variants, are recognised by one demonstration.

The paper draws 200 variants of each of 3 gestures, after Cabrera and Wachs, and shows each of 8
gestures 50 times (Sec. V). Here both protocols use variants in place of repeated takes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from app.evaluation.confusion import NONE, Answer, ConfusionMatrix
from app.recognition import (
    Gesture,
    GestureError,
    Language,
    OsgError,
    PoseError,
    PoseSequence,
    Recognizer,
)
from app.recognition.gestures.demonstration import condense
from app.recognition.language.file_schema import MAX_GESTURES
from app.recognition.poses.trajectory import Trajectory
from app.recognition.simulation.variation import Person, draw_variants, take_turns

Progress = Callable[[int, int], None]
"""``progress(done, total)``, after every query, or every language of one take."""


@dataclass(frozen=True, eq=False)
class LabelledTake:
    """One take of a gesture, without salutes.

    Attributes
    ----------
    source
        Origin, for people.
    label
        Gesture that is shown; `NONE` for none of the gestures.
    person
        Person who shows it; empty when unknown.
    poses
        Landmarks of the take.

    """

    source: str
    label: str
    person: str
    poses: PoseSequence


@dataclass(frozen=True, eq=False)
class OneShot:
    """Results of the one-shot protocol over all languages.

    Attributes
    ----------
    same_person
        Queries by the person whose takes define the language (user-dependent); all queries where
        people are unknown.
    other_people
        Queries by all other people (user-independent).
    languages
        Number of languages, each with one take per gesture.
    unusable
        Reason by source, for takes that cannot be a demonstration.

    """

    same_person: ConfusionMatrix
    other_people: ConfusionMatrix
    languages: int
    unusable: dict[str, str]


def one_shot(
    takes: Sequence[LabelledTake], *, profile: str, progress: Progress | None = None
) -> OneShot:
    """Measure how well one demonstration per gesture recognises all other takes.

    Each person's n-th takes of all gestures form a language, so that every take is a demonstration
    at least once (gestures with fewer takes start again with the first). The language recognises
    all other takes of its gestures.

    Parameters
    ----------
    takes
        At least two gestures by one person, one of them twice or also by another person.
    profile
        Profile of the recogniser.
    progress
        Called after every language.

    Raises
    ------
    OsgError
        When no person shows two gestures, or no take is left as a query.

    """
    gestures, unusable = _gestures(takes)
    chosen = [pick for pick in _choices(takes, gestures) if len(pick) > 1]
    labels = sorted({take.label for take in takes})
    if not chosen:
        raise OsgError(
            f"{len(takes)} usable takes of {len(labels)} gestures, and no person shows two of "
            "them: record at least two gestures by the same person"
        )
    same: list[tuple[str, Answer]] = []
    others: list[tuple[str, Answer]] = []
    for done, templates in enumerate(chosen, start=1):
        person = takes[templates[0]].person
        language = Language("one take a gesture", [gestures[index] for index in templates])
        recognizer = Recognizer(language, profile)
        for index, take in enumerate(takes):
            if take.label in (*language.labels, NONE) and index not in templates:
                asked = same if take.person == person else others
                asked.append((take.label, recognize_answer(recognizer, take.poses)))
        if progress is not None:
            progress(done, len(chosen))
    if not same and not others:
        raise OsgError(
            f"{len(takes)} takes of {len(labels)} gestures are all demonstrations, so none is "
            "left to recognise: record at least two takes of a gesture"
        )
    return OneShot(_matrix(labels, same), _matrix(labels, others), len(chosen), unusable)


def recognize_takes(
    language: Language,
    takes: Sequence[LabelledTake],
    *,
    profile: str,
    progress: Progress | None = None,
) -> ConfusionMatrix:
    """Recognise all takes by a given language, also takes of gestures that it does not contain.

    Parameters
    ----------
    language
        Language that was not defined from these takes.
    takes, profile, progress
        As for `one_shot`; progress is called after every take.

    """
    recognizer = Recognizer(language, profile)
    read: list[Answer] = []
    for take in takes:
        read.append(recognize_answer(recognizer, take.poses))
        if progress is not None:
            progress(len(read), len(takes))
    unknown = sorted({take.label for take in takes} - set(language.labels))
    return ConfusionMatrix.of([*language.labels, *unknown], [take.label for take in takes], read)


def _gestures(takes: Sequence[LabelledTake]) -> tuple[dict[int, Gesture], dict[str, str]]:
    """Define a gesture from every take; return also the reasons of takes that cannot be one."""
    gestures, unusable = {}, {}
    for index, take in enumerate(takes):
        if take.label == NONE:
            continue
        try:
            gestures[index] = Gesture.from_demonstration(take.label, take.poses)
        except GestureError as error:
            unusable[take.source] = str(error)
    return gestures, unusable


def _choices(
    takes: Sequence[LabelledTake], gestures: dict[int, Gesture]
) -> Iterator[tuple[int, ...]]:
    """Yield the demonstrations of each language: indices of one take per gesture of a person."""
    for person in sorted({take.person for take in takes}):
        own: dict[str, list[int]] = {}
        for index in gestures:
            if takes[index].person == person:
                own.setdefault(takes[index].label, []).append(index)
        for round_number in range(max(map(len, own.values()), default=0)):
            yield tuple(indices[round_number % len(indices)] for indices in own.values())


def _matrix(labels: Sequence[str], asked: Sequence[tuple[str, Answer]]) -> ConfusionMatrix:
    return ConfusionMatrix.of(labels, [shown for shown, _ in asked], [read for _, read in asked])


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
