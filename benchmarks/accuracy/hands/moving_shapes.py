"""Moving shapes: accuracy of gestures that differ by the hand's shape during the movement alone.

Takes are composed (`benchmarks.sets.moving_signs`) of recorded movements of several people and of
recorded hands of one. A language holds five movements; one of them is two gestures, with two hand
shapes, each demonstrated once and with the switch `hand_shape` on. Queries show the movement of the
two with one of the shapes, by the person of the demonstrations or by another one, with the hand in
the demonstrated view (another take of its run) or in another one; with a third shape (*foreign*);
and without hands. *Switch off* is the same language with the hand shape of the two switched off:
what the movement alone tells.

With the switches as they are by themselves every answer, with every distance, must be that of the
same take without hands, and the author is asked about the two. The interval is Wilson's.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from app.evaluation.share import Share
from app.recognition import Gesture, Language, PoseSequence, Recognizer
from app.recognition.gestures.switches import Switches
from benchmarks.sets.held_signs import HeldSigns, read_held_signs
from benchmarks.sets.moving_signs import compose
from benchmarks.sets.recorded_sets import DOMAINS, RecordedSet, recorded_sets

MOVEMENTS = 5
"""Movements in a language: about as many as a diver learns."""

SHAPE_ALIKE = frozenset({"ascend", "descend"})
"""Signs of one shape, pointing up or down: not clearly different in a hand that turns."""


@dataclass(frozen=True)
class Answer:
    """One recognition of a take of one of the two gestures.

    Attributes
    ----------
    relation
        Whose movement and which view of the hand, ``foreign``, ``no hand`` or ``switch off``.
    signs
        Signs of the two gestures.
    asked
        Whether the author is asked about the two where the switch is ``auto``.
    right
        Whether the expected gesture is nearest; for a foreign shape or no hands, whether one of the
        two is.
    accepted
        Whether the take was not rejected.

    """

    relation: str
    signs: tuple[str, str]
    asked: bool
    right: bool
    accepted: bool


@dataclass(frozen=True)
class Composer:
    """Composes takes of a set of movements and a set of hands."""

    recorded: RecordedSet
    signs: HeldSigns
    random: np.random.Generator

    def compose(self, movement: int, hand: int) -> PoseSequence:
        """Return a take of a movement with a hand, by their indices."""
        shown = self.signs.takes[hand].hands
        assert shown is not None
        return compose(self.recorded.recordings[movement], shown[:, 1], self.random)

    def choose(self, wanted: npt.NDArray[np.bool_]) -> int:
        """Return the index of a random take among the wanted ones."""
        return int(self.random.choice(np.flatnonzero(wanted)))


@dataclass(frozen=True)
class Draw:
    """A language and the takes that its demonstrations were composed of.

    Attributes
    ----------
    labels, shown
        Of the gestures: the two, then the others.
    movements, hands
        Indices of the movements and hands of the two.
    person
        Who shows all demonstrations.

    """

    labels: tuple[str, ...]
    shown: tuple[PoseSequence, ...]
    movements: tuple[int, int]
    hands: tuple[int, int]
    person: str

    def gestures(self, *, with_hands: bool = True) -> list[Gesture]:
        """Return the gestures, as if no hands had been seen or with them."""
        return [
            Gesture.from_demonstration(label, poses if with_hands else replace(poses, hands=None))
            for label, poses in zip(self.labels, self.shown, strict=True)
        ]


def draw(composer: Composer, count: int = MOVEMENTS) -> Draw | None:
    """Draw a language of some movements.

    None where a person has too few takes or the two shapes are one.
    """
    recorded, signs, random = composer.recorded, composer.signs, composer.random
    person = str(random.choice(np.unique(recorded.people)))
    classes = random.choice(np.unique(recorded.labels), count, replace=False)
    names = [str(name) for name in random.choice(np.unique(signs.labels), 2, replace=False)]
    if frozenset(names) == SHAPE_ALIKE:
        return None
    own = recorded.people == person
    twins = np.flatnonzero(own & (recorded.labels == classes[0]))
    if len(twins) < 3:
        return None
    movements = [int(take) for take in random.choice(twins, 2, replace=False)]
    hands = [composer.choose(signs.labels == name) for name in names]
    shown = [composer.compose(*each) for each in zip(movements, hands, strict=True)]
    for name in classes[1:]:
        # A hand of any sign: the shape must not matter for a movement without a twin.
        other = composer.choose(own & (recorded.labels == name))
        shown.append(composer.compose(other, int(random.integers(len(signs.takes)))))
    labels = (*names, *(f"movement {name}" for name in classes[1:]))
    return Draw(labels, tuple(shown), (movements[0], movements[1]), (hands[0], hands[1]), person)


def answer(composer: Composer, drawn: Draw, queries: int) -> Iterator[Answer]:
    """Recognise takes of the two gestures."""
    recorded, signs, random = composer.recorded, composer.signs, composer.random
    gestures = drawn.gestures()
    by_hand = [replace(each, switches=Switches(hand_shape="on")) for each in gestures[:2]]
    recognizer = Recognizer(Language("twins", [*by_hand, *gestures[2:]]))
    without = [replace(each, switches=Switches(hand_shape="off")) for each in gestures]
    off = Recognizer(Language("off", without))
    pair = (drawn.labels[0], drawn.labels[1])
    asked = pair in Recognizer(Language("asked", gestures)).undecided_twins
    moved = recorded.labels == recorded.labels[drawn.movements[0]]
    moved[list(drawn.movements)] = False
    own = recorded.people == drawn.person
    for _ in range(queries):
        meant = int(random.integers(2))
        shaped = signs.labels == pair[meant]
        shaped[list(drawn.hands)] = False
        same = signs.runs == signs.runs[drawn.hands[meant]]
        for who, people in (("same person", own), ("other person", ~own)):
            if not (moved & people).any():
                continue
            for view, runs in (("same view", same), ("other view", ~same)):
                poses = composer.compose(
                    composer.choose(moved & people), composer.choose(shaped & runs)
                )
                label, nearest = _recognize(recognizer, poses)
                yield Answer(
                    f"{who}, {view}", pair, asked, nearest == pair[meant], label is not None
                )
                label, nearest = _recognize(off, poses)
                yield Answer("switch off", pair, asked, nearest == pair[meant], label is not None)
            blind = replace(poses, hands=None)
            label, nearest = _recognize(recognizer, blind)
            yield Answer("no hand", pair, asked, nearest in pair, label is not None)
            foreign = composer.compose(
                composer.choose(moved & people), composer.choose(_find_foreign(signs, pair))
            )
            label, nearest = _recognize(recognizer, foreign)
            yield Answer("foreign", pair, asked, nearest in pair, label is not None)


def _find_foreign(signs: HeldSigns, pair: tuple[str, str]) -> npt.NDArray[np.bool_]:
    """Return the takes of a third shape, other than the two and their turned versions."""
    taken = {*pair} | (SHAPE_ALIKE if SHAPE_ALIKE & {*pair} else set())
    return ~np.isin(signs.labels, sorted(taken))


def _recognize(recognizer: Recognizer, poses: PoseSequence) -> tuple[str | None, str]:
    result = recognizer.recognize(poses)
    return None if result.outcome == "rejected" else result.nearest, result.nearest


def count_same(composer: Composer, drawn: Draw, queries: int) -> Share:
    """Count the answers that are the same with and without hands, with automatic switches."""
    recorded, random = composer.recorded, composer.random
    recognizer, other = (
        Recognizer(Language("by movement", gestures))
        for gestures in (drawn.gestures(), drawn.gestures(with_hands=False))
    )
    same = Share(0, 0)
    for _ in range(queries):
        poses = composer.compose(
            int(random.integers(len(recorded.recordings))),
            int(random.integers(len(composer.signs.takes))),
        )
        one = recognizer.recognize(poses).to_dict()
        same += Share(int(one == other.recognize(replace(poses, hands=None)).to_dict()), 1)
    return same


def report(answers: Sequence[Answer], languages: dict[str, Share]) -> Iterator[str]:
    """Yield the lines of the report."""
    yield "| takes | n | nearest right | right and accepted | refused |"
    yield "| --- | --- | --- | --- | --- |"
    for relation in dict.fromkeys(each.relation for each in answers):
        own = [each for each in answers if each.relation == relation]
        right = sum(each.right for each in own)
        taken = sum(each.right and each.accepted for each in own)
        refused = sum(not each.accepted for each in own)
        shares = " | ".join(str(Share(count, len(own))) for count in (right, taken, refused))
        yield f"| {relation} | {len(own)} | {shares} |"
    yield ""
    for words, found in languages.items():
        yield f"{words}: {found}"
    yield ""
    yield "| signs | n | nearest right |"
    yield "| --- | --- | --- |"
    told = [each for each in answers if "person" in each.relation]
    for pair in sorted({frozenset(each.signs) for each in told}, key=sorted):
        named = [each.right for each in told if frozenset(each.signs) == pair]
        yield f"| {' and '.join(sorted(pair))} | {len(named)} | {Share(sum(named), len(named))} |"


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="holds trajectories/")
    parser.add_argument("--sets", nargs="+", choices=DOMAINS, default=["digits", "letters"])
    parser.add_argument("--draws", type=int, default=60, help="languages a set")
    parser.add_argument("--queries", type=int, default=6, help="takes a language and relation")
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args(arguments)
    signs = read_held_signs(given.folder / "trajectories")
    random = np.random.default_rng(given.seed)
    answers: list[Answer] = []
    asked, same = Share(0, 0), Share(0, 0)
    for recorded in recorded_sets(given.folder / "trajectories", given.sets):
        composer = Composer(recorded, signs, random)
        for _ in range(given.draws):
            drawn = draw(composer)
            while drawn is None:
                drawn = draw(composer)
            own = [*answer(composer, drawn, given.queries)]
            asked += Share(int(own[0].asked), 1)
            answers += own
            same += count_same(composer, drawn, given.queries)
    languages = {
        "languages whose author is asked about the two": asked,
        "answers that are the same, to the last digit, without hands": same,
    }
    for line in report(answers, languages):
        print(line)


if __name__ == "__main__":
    main()
