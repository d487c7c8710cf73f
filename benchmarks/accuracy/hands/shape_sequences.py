"""Shape sequences: accuracy of gestures of two held signs, from one demonstration.

Takes are composed (`benchmarks.sets.sign_sequences`) of one person's takes of held signs. *Found*:
composed takes of any two signs in which so many shapes are found. A language holds five sequences
of two signs, drawn at random, and all signs alone, demonstrated once each; a flat hand and ok are
too alike to be a sequence (`ALIKE`). Queries show a sequence of the language, both signs in the
demonstrated view (another take of the run) or both in other ones; and what is no sequence of the
language: the other order, another second or first sign, three signs, and one sign alone, which is a
gesture of its own.
A take that is not recognised as two shapes counts as wrong and as refused. The interval is
Wilson's.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import permutations
from pathlib import Path

import numpy as np

from app.evaluation.share import Share
from app.recognition import Gesture, GestureError, Language, PoseError, PoseSequence, Recognizer
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.holds import find_holds
from benchmarks.sets.held_signs import HeldSigns, read_held_signs
from benchmarks.sets.sign_sequences import compose, turn_alike

SEQUENCES = 5
"""Sequences in a language, about as many as a diver learns."""

TRIES = 20
"""Most demonstrations drawn until one shows the right number of shapes."""

ALIKE = frozenset({"ok", "stop"})
"""Two signs 0.35 to 0.6 hand sizes apart, no more than takes of one sign differ."""

FOUND_OF = 10
"""Composed takes per pair of signs in which shapes are counted."""

MEANT = ("same view", "other view")

FOREIGN = ("other order", "other second sign", "other first sign", "three signs")

ALONE = "one sign alone"

Signs = tuple[str, ...]


@dataclass(frozen=True)
class Answer:
    """One recognition.

    Attributes
    ----------
    relation
        One of `MEANT`, `FOREIGN`, or `ALONE`.
    signs
        Signs that the take shows.
    right
        Whether the gesture of these signs is nearest.
    accepted
        Whether the take was not rejected.
    sequence
        Whether a sequence was accepted.

    """

    relation: str
    signs: Signs
    right: bool
    accepted: bool
    sequence: bool


@dataclass(frozen=True)
class Composer:
    """Composes takes of signs.

    Attributes
    ----------
    signs
        The recorded takes, turned alike.
    random
        Draws takes and changes.
    """

    signs: HeldSigns
    random: np.random.Generator

    def show(self, takes: Sequence[int]) -> PoseSequence:
        """Return a take that shows the signs of some takes one after the other."""
        return compose([self.signs.takes[take] for take in takes], self.random)

    def choose(self, wanted: Signs, beside: Sequence[int] = (), *, same_view: bool) -> list[int]:
        """Return random takes of signs, from the runs of the takes `beside` or from other runs."""
        chosen = []
        for sign, other in zip(wanted, beside, strict=True):
            runs = self.signs.runs == self.signs.runs[other]
            fitting = (self.signs.labels == sign) & (runs == same_view)
            fitting[other] = False
            chosen.append(int(self.random.choice(np.flatnonzero(fitting))))
        return chosen

    def choose_any(self, wanted: Signs) -> list[int]:
        """Return random takes of signs."""
        every = (np.flatnonzero(self.signs.labels == sign) for sign in wanted)
        return [int(self.random.choice(takes)) for takes in every]

    def define(self, wanted: Signs) -> tuple[list[int], Gesture]:
        """Return a gesture of signs, and the takes of which its demonstration is composed.

        Raises
        ------
        GestureError
            When none of `TRIES` demonstrations shows as many shapes as signs.

        """
        for _ in range(TRIES):
            takes = self.choose_any(wanted)
            try:
                gesture = Gesture.from_demonstration(name_gesture(wanted), self.show(takes))
            except GestureError:
                continue
            if len(gesture.held_shapes) == len(wanted):
                return takes, gesture
        raise GestureError(f"no take of {name_gesture(wanted)} shows {len(wanted)} shapes")


def name_gesture(signs: Signs) -> str:
    """Return the label of the gesture of some signs."""
    return ", ".join(signs)


def answer(composer: Composer, draws: int) -> Iterator[Answer]:
    """Recognise takes in languages of random sequences."""
    random, names = composer.random, [str(name) for name in np.unique(composer.signs.labels)]
    pairs = [*permutations(names, 2)]
    for _ in range(draws):
        able = [pair for pair in pairs if set(pair) != ALIKE]
        chosen = [able[index] for index in random.permutation(len(able))[:SEQUENCES]]
        shown = {signs: composer.define(signs) for signs in (*chosen, *((name,) for name in names))}
        recognizer = Recognizer(Language("sequences", [gesture for _, gesture in shown.values()]))

        def recognize(relation: str, signs: Signs, takes: Sequence[int]) -> Answer:
            return _recognize(recognizer, relation, signs, composer.show(takes))  # noqa: B023

        for signs in chosen:
            templates, _ = shown[signs]
            for relation in MEANT:
                takes = composer.choose(signs, templates, same_view=relation == MEANT[0])
                yield recognize(relation, signs, takes)
            first, second = signs
            free = [pair for pair in pairs if pair not in chosen]
            for relation, fitting in (
                (FOREIGN[0], [(second, first)]),
                (FOREIGN[1], [pair for pair in free if pair[0] == first]),
                (FOREIGN[2], [pair for pair in free if pair[1] == second]),
            ):
                others = [pair for pair in fitting if pair in free]
                if others:
                    other = others[int(random.integers(len(others)))]
                    yield recognize(relation, other, composer.choose_any(other))
            third = str(random.choice([name for name in names if name != second]))
            yield recognize(FOREIGN[3], (*signs, third), composer.choose_any((*signs, third)))
            yield recognize(ALONE, (first,), composer.choose_any((first,)))


def _recognize(recognizer: Recognizer, relation: str, signs: Signs, poses: PoseSequence) -> Answer:
    try:
        result = recognizer.recognize(poses)
    except PoseError:
        return Answer(relation, signs, right=False, accepted=False, sequence=False)
    label = None if result.outcome == "rejected" else result.nearest
    sequence = label is not None and len(recognizer.language.gesture(label).held_shapes) > 1
    right = result.fault is None and result.nearest == name_gesture(signs)
    return Answer(relation, signs, right, label is not None, sequence)


def count_shapes(composer: Composer) -> Iterator[tuple[Signs, int]]:
    """Yield pairs of signs, each with the number of shapes found in a composed take of them."""
    for signs in permutations([str(name) for name in np.unique(composer.signs.labels)], 2):
        for _ in range(FOUND_OF):
            poses = composer.show(composer.choose_any(signs))
            yield signs, len(find_holds(poses, Trajectory.from_poses(poses)))


def report(answers: Sequence[Answer], counts: Sequence[tuple[Signs, int]]) -> Iterator[str]:
    """Yield the lines of the report."""
    for alike, words in ((False, "two clearly different signs"), (True, "ok and a flat hand")):
        found = [count for signs, count in counts if (set(signs) == ALIKE) is alike]
        for number in range(4):
            share = Share(found.count(number), len(found))
            yield f"{number} shapes are found in takes of {words}: {share}"
    yield ""
    yield "| relation | n | nearest right | right and accepted |"
    yield "| --- | --- | --- | --- |"
    for relation in (*MEANT, ALONE):
        own = [each for each in answers if each.relation == relation]
        right = sum(each.right for each in own)
        taken = sum(each.right and each.accepted for each in own)
        yield f"| {relation} | {len(own)} | {Share(right, len(own))} | {Share(taken, len(own))} |"
    yield ""
    yield "| no sequence of the language | n | accepted as a sequence | accepted |"
    yield "| --- | --- | --- | --- |"
    for relation in (*FOREIGN, ALONE):
        own = [each for each in answers if each.relation == relation]
        sequence = sum(each.sequence for each in own)
        taken = sum(each.accepted for each in own)
        shares = f"{Share(sequence, len(own))} | {Share(taken, len(own))}"
        yield f"| {relation} | {len(own)} | {shares} |"
    yield ""
    yield "| two signs, in either order | n | right and accepted |"
    yield "| --- | --- | --- |"
    meant = [each for each in answers if each.relation in MEANT]
    for signs in sorted({tuple(sorted(each.signs)) for each in meant}):
        own = [each for each in meant if tuple(sorted(each.signs)) == signs]
        taken = sum(each.right and each.accepted for each in own)
        yield f"| {name_gesture(signs)} | {len(own)} | {Share(taken, len(own))} |"


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="holds trajectories/")
    parser.add_argument("--draws", type=int, default=60, help="languages")
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args(arguments)
    signs = turn_alike(read_held_signs(given.folder / "trajectories"))
    composer = Composer(signs, np.random.default_rng(given.seed))
    counts = [*count_shapes(composer)]
    for line in report([*answer(composer, given.draws)], counts):
        print(line)


if __name__ == "__main__":
    main()
