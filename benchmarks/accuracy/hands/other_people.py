"""Hand shapes of other people: letters of finger alphabets, from one signer or three.

A language holds letters, each demonstrated by one signer or by the same three; the takes of the
other signers are recognised. A language of all letters says how many are nearest right. Languages
of random `LANGUAGE` letters are tested with all: a take of a letter that the language lacks is
out-of-vocabulary. A take that holds no hand shape counts as wrong and as rejected, one that can be
no demonstration of a held shape is named and left out of the language.

*At 15 %*: the limit on the novelty at which 15 % of the right takes are rejected. *Nested*: the
largest limit that accepts 15 % of the out-of-vocabulary takes without any of one signer and one
letter, measured on the takes of that signer and letter. The interval is Wilson's; takes recur in
many languages, so its n is the number of different pairs of take and demonstrators.

*Choices*: which hand voters are compared, and by how many degrees a hand may be turned. Each choice
is measured by the shapes alone, one signer's demonstrations; nested, the choice that is best
without any take of one signer and one letter is measured on that signer's takes of that letter.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import combinations, product
from pathlib import Path

import numpy as np
import numpy.typing as npt

from app.evaluation.share import Share
from app.recognition import Gesture, GestureError, Language, PoseError, Recognizer
from app.recognition.poses.frame import HandShape
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.hand_voters import HandVoter
from app.recognition.voters.registry import HAND_VOTERS
from benchmarks.sets.held_signs import HandLetters, read_hand_letters

LANGUAGE = 5
"""Letters of a language in which others are out-of-vocabulary."""

TURNS = (0.0, 20.0, 30.0, 45.0)
"""Degrees of the choices."""

REJECTED = ACCEPTED = 0.15
"""Share of right takes rejected, and of out-of-vocabulary ones accepted, at the limits."""


@dataclass(frozen=True)
class Answer:
    """One recognition.

    Attributes
    ----------
    signer, letter
        Of the take.
    demonstrators
        Of the language.
    known
        Whether the language has the letter.
    right
        Whether the take's own letter is nearest.
    novelty
        Of the nearest letter; infinite where no hand shape is held.

    """

    signer: str
    letter: str
    demonstrators: tuple[str, ...]
    known: bool
    right: bool
    novelty: float


class Letters:
    """The takes of the letters, with the gesture that each one defines."""

    def __init__(self, letters: HandLetters) -> None:
        self.of = letters
        self.names = [str(letter) for letter in np.unique(letters.letters)]
        self.signers = [str(signer) for signer in np.unique(letters.signers)]
        self.gestures: dict[int, Gesture] = {}
        self.refused: list[str] = []
        for take, letter in enumerate(letters.letters.tolist()):
            why = "a movement, or two shapes"
            try:
                gesture = Gesture.from_demonstration(letter, letters.takes[take])
                if len(gesture.held_shapes) == 1:
                    self.gestures[take] = gesture
                    continue
            except GestureError as error:
                why = str(error)
            self.refused.append(f"{letter} of {letters.signers[take]}: {why}")

    def recognizer(self, names: Sequence[str], signers: Sequence[str]) -> Recognizer | None:
        """Return the recogniser of some letters by some signers; None without demonstrations."""
        gestures = []
        for name in names:
            shown = [
                take
                for signer in signers
                for take in self.takes_of(signer, name)
                if take in self.gestures
            ]
            if shown:
                gesture = self.gestures[shown[0]]
                for take in shown[1:]:
                    gesture = gesture.with_demonstration(self.of.takes[take])
                gestures.append(gesture)
        return Recognizer(Language(name="letters", gestures=gestures)) if gestures else None

    def takes_of(self, signer: str, name: str) -> list[int]:
        """Return the takes of a letter by a signer."""
        found = (self.of.signers == signer) & (self.of.letters == name)
        return np.flatnonzero(found).tolist()

    def answer(self, names: Sequence[str], signers: Sequence[str]) -> Iterator[Answer]:
        """Recognise all takes by other signers in a language of some letters by some signers."""
        recognizer = self.recognizer(names, signers)
        for take in np.flatnonzero(~np.isin(self.of.signers, signers)).tolist():
            letter = str(self.of.letters[take])
            nearest, novelty = "", np.inf
            with suppress(PoseError):
                if recognizer is not None:
                    result = recognizer.recognize(self.of.takes[take])
                    nearest = result.nearest
                    novelty = float(result.novelty[result.gestures.index(nearest)])
            yield Answer(
                signer=str(self.of.signers[take]),
                letter=letter,
                demonstrators=tuple(signers),
                known=letter in names,
                right=nearest == letter,
                novelty=novelty,
            )


def answer(
    letters: Letters, count: int, draws: int, seed: int
) -> tuple[list[Answer], list[Answer]]:
    """Recognise takes in languages of every choice of `count` signers.

    Returns
    -------
    The answers in languages of all letters, and in `draws` languages of `LANGUAGE` letters.

    """
    random = np.random.default_rng(seed)
    whole: list[Answer] = []
    some: list[Answer] = []
    for signers in combinations(letters.signers, count):
        whole += letters.answer(letters.names, signers)
        for _ in range(draws):
            names = random.choice(letters.names, LANGUAGE, replace=False).tolist()
            some += letters.answer(names, signers)
    return whole, some


def report(letters: Letters, count: int, draws: int, seed: int) -> Iterator[str]:
    """Yield the lines on languages of `count` signers."""
    whole, some = answer(letters, count, draws, seed)
    right = [each.novelty for each in whole if each.right]
    accepted = sum(novelty <= 1 for novelty in right)
    own = np.array([each.novelty for each in some if each.known and each.right])
    foreign = [each for each in some if not each.known]
    novelties = np.array([each.novelty for each in foreign])
    pairs = len({(each.signer, each.letter, each.demonstrators) for each in foreign})
    at_limit = float((novelties <= np.quantile(own, 1 - REJECTED)).mean())
    yield (
        f"| {count} | {len(whole)} | {Share(len(right), len(whole))} "
        f"| {Share(accepted, len(whole))} | {Share(len(right) - accepted, len(right))} | {pairs} "
        f"| {_share(float((novelties <= 1).mean()), pairs)} | {_share(at_limit, pairs)} |"
    )


def _share(rate: float, count: int) -> str:
    return str(Share(round(rate * count), count))


def report_nested(letters: Letters, draws: int, seed: int) -> Iterator[str]:
    """Yield what limits reach that are chosen without a signer and a letter."""
    _, some = answer(letters, 1, draws, seed)
    limits, rejected, accepted = [], [], []
    for signer in letters.signers:
        for name in letters.names:
            others = [
                each.novelty
                for each in some
                if not each.known
                and each.letter != name
                and signer not in (each.signer, *each.demonstrators)
            ]
            limit = float(np.quantile(others, ACCEPTED))
            limits.append(limit)
            kept = [each for each in some if (each.signer, each.letter) == (signer, name)]
            rejected += [each.novelty > limit for each in kept if each.known and each.right]
            accepted += [each.novelty <= limit for each in kept if not each.known]
    chosen = float(np.quantile([each.novelty for each in some if not each.known], ACCEPTED))
    yield (
        f"limit, in limits shipped, nested: {min(limits):.2f} to {max(limits):.2f}, right takes "
        f"rejected {np.mean(rejected):.1%}, out-of-vocabulary accepted {np.mean(accepted):.1%}; "
        f"chosen on all: {chosen:.2f}"
    )


def report_choices(letters: Letters) -> Iterator[str]:
    """Yield the nearest right with every choice of voters and turn, and with nested choices."""
    takes = sorted(letters.gestures)
    hands = [letters.gestures[take].held_shapes[0][0] for take in takes]
    names, signers = letters.of.letters[takes], letters.of.signers[takes]
    # By demonstrator and take of another signer.
    asked = signers != np.array(letters.signers)[:, None]
    found = {}
    for turn in TURNS:
        apart = {voter.name: _measure(voter, hands, turn) for voter in HAND_VOTERS}
        for count in range(1, len(apart) + 1):
            for chosen in combinations(apart, count):
                nearest = np.sum([apart[name] for name in chosen], axis=0)
                found[turn, chosen] = np.array(
                    [_is_right(nearest, names, signers == signer) for signer in letters.signers]
                )
    yield "| turn | voters | nearest right |"
    yield "| --- | --- | --- |"
    for (turn, chosen), right in found.items():
        share = Share(int(right[asked].sum()), int(asked.sum()))
        yield f"| {turn:.0f} | {', '.join(chosen)} | {share} |"
    kept_right = 0
    for signer, name in product(letters.signers, letters.names):
        demonstrators = np.array(letters.signers)[:, None] != signer
        others = asked & demonstrators & (signers != signer) & (names != name)
        best = max(found.values(), key=lambda right: int(right[others].sum()))
        kept_right += int(best[asked & (signers == signer) & (names == name)].sum())
    yield f"nearest right with the nested choices: {Share(kept_right, int(asked.sum()))}"


def _measure(voter: HandVoter, hands: Sequence[HandShape], turn: float) -> FloatArray:
    """Return a voter's relative distances ``(N, N)``, of each hand or its mirror image to all."""
    described = np.array([voter.describe(hand) for hand in hands])
    apart = [
        [
            voter.distances_turned(voter.describe(seen), described, turn)
            for seen in (hand, hand.mirror())
        ]
        for hand in hands
    ]
    return np.asarray(np.min(apart, axis=1) / voter.between)


def _is_right(
    apart: FloatArray, names: npt.NDArray[np.str_], shown: npt.NDArray[np.bool_]
) -> npt.NDArray[np.bool_]:
    """Return of each take whether the nearest of the shown ones is of its letter, ``(N,)``."""
    rows = np.flatnonzero(shown)
    return np.asarray(names[rows][apart[:, rows].argmin(axis=1)] == names)


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="holds trajectories/")
    parser.add_argument("--draws", type=int, default=8, help="languages of each choice of signers")
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args(arguments)
    letters = Letters(read_hand_letters(given.folder / "trajectories"))
    print(
        f"{len(letters.of.takes)} takes of {len(letters.names)} letters by "
        f"{len(letters.signers)} people; no held hand shape: {len(letters.refused)}"
    )
    for line in letters.refused:
        print(f"- {line}")
    print()
    print(
        "| signers | n | nearest right | right and accepted | right ones rejected "
        "| n | out-of-vocabulary accepted | the same at 15 % |"
    )
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    for count in (1, 3):
        for line in report(letters, count, given.draws, given.seed):
            print(line)
    print()
    for line in (*report_nested(letters, given.draws, given.seed), "", *report_choices(letters)):
        print(line)


if __name__ == "__main__":
    main()
