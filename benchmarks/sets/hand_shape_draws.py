"""Languages of hand shapes, with the takes that they are asked about.

Letters by one signer or three, one person's signs, two of them in sequence, and movements that
carry a hand; the sequences and movements are composed of recorded takes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import chain, combinations, permutations
from typing import Literal

import numpy as np
import numpy.typing as npt

from app.recognition import Gesture, GestureError, Language, PoseSequence, Recognizer
from app.recognition.gestures.switches import Switches
from benchmarks.sets import moving_signs, sign_sequences
from benchmarks.sets.held_signs import HeldSigns
from benchmarks.sets.recorded_sets import RecordedSet

FEW = 5
"""Letters, sequences or movements of a language: about as many as a diver learns."""

TRIES = 20
"""Most demonstrations of a sequence drawn until one shows the right number of shapes."""

ONE_SHAPE = frozenset({"ok", "stop"})
"""Two signs 0.35 to 0.6 hand sizes apart, no more than takes of one sign differ."""

TURNED = frozenset({"ascend", "descend"})
"""Signs of one shape, pointing up or down: not clearly different in a hand that turns."""


@dataclass(frozen=True, eq=False)
class Take:
    """A take that a language is asked about.

    Attributes
    ----------
    relation
        To the language's demonstrations.
    label
        Of its gesture; a label that the language lacks, of one that should be refused.
    poses
        What is shown.
    who
        Signer, and who demonstrated: the same take is asked about in many languages.

    """

    relation: str
    label: str
    poses: PoseSequence
    who: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Drawn:
    """A language and the takes that it is asked about."""

    recognizer: Recognizer
    takes: list[Take]


def teach(label: str, shown: Sequence[PoseSequence]) -> Gesture:
    """Return a gesture of one demonstration or several."""
    gesture = Gesture.from_demonstration(label, shown[0])
    for poses in shown[1:]:
        gesture = gesture.with_demonstration(poses)
    return gesture


def find_held(shown: RecordedSet | HeldSigns, shapes: int = 2) -> npt.NDArray[np.bool_]:
    """Return which takes can demonstrate a held shape, or up to so many in sequence."""
    takes = shown.takes if isinstance(shown, HeldSigns) else shown.recordings
    held = np.zeros(len(takes), dtype=np.bool_)
    for number, (label, poses) in enumerate(zip(shown.labels.tolist(), takes, strict=True)):
        with suppress(GestureError):
            found = Gesture.from_demonstration(label, poses).held_shapes
            held[number] = 0 < len(found) <= shapes
    return held


def draw_letters(
    recorded: RecordedSet, held: npt.NDArray[np.bool_], people: int, draws: int, seed: int
) -> Iterator[Drawn]:
    """Draw a language of all letters, and `draws` of `FEW`, by every choice of so many signers."""
    random, letters = np.random.default_rng(seed), np.unique(recorded.labels)
    for signers in combinations(np.unique(recorded.people).tolist(), people):
        by = np.isin(recorded.people, signers)
        taught = {}
        for name in letters.tolist():
            shown = np.flatnonzero(by & held & (recorded.labels == name)).tolist()
            if shown:
                taught[name] = teach(name, [recorded.recordings[each] for each in shown])
        for draw in range(draws + 1):
            names = random.choice(letters, FEW, replace=False) if draw else letters
            gestures = [taught[name] for name in names.tolist() if name in taught]
            takes = []
            for take in np.flatnonzero(~by).tolist():
                name, who = str(recorded.labels[take]), (str(recorded.people[take]), *signers)
                relation = "all" if not draw else "few" if name in names else "foreign"
                poses = recorded.recordings[take]
                takes.append(Take(f"{people}/{relation}", name, poses, who))
            yield Drawn(Recognizer(Language("letters", gestures)), takes)


def draw_signs(signs: HeldSigns, draws: int, queries: int, seed: int) -> Iterator[Drawn]:
    """Draw languages of one person's signs, by one take of each and by three."""
    random, held = np.random.default_rng(seed), find_held(signs)
    names = np.unique(signs.labels)

    def teach_all(templates: dict[str, list[int]], number: int) -> Recognizer:
        shown = {name: [signs.takes[take] for take in of] for name, of in templates.items()}
        gestures = [teach(name, of[:number]) for name, of in shown.items()]
        return Recognizer(Language("signs", gestures))

    for _ in range(draws):
        templates = {}
        for name in names.tolist():
            usable = np.flatnonzero(held & (signs.labels == name))
            runs = random.permutation(np.unique(signs.runs[usable]))[:3]
            templates[name] = [
                int(random.choice(usable[signs.runs[usable] == run])) for run in runs
            ]
        used = [*chain.from_iterable(templates.values())]
        free = np.setdiff1d(np.arange(len(signs.takes)), used)
        asked = random.choice(free, queries, replace=False).tolist()
        beside = []
        for name, (first, *_) in templates.items():
            # Takes of the demonstrated view are rare, so one more of each sign is drawn.
            of_view = (signs.labels[free] == name) & (signs.runs[free] == signs.runs[first])
            beside.append(int(random.choice(free[of_view])))
        one, three = [], []
        for take in (*asked, *beside):
            own = str(signs.labels[take])
            same = signs.runs[take] == signs.runs[templates[own][0]]
            one.append(Take("same-view" if same else "other-view", own, signs.takes[take]))
            three.append(replace(one[-1], relation="three"))
        yield Drawn(teach_all(templates, 1), one)
        yield Drawn(teach_all(templates, 3), three[: len(asked)])
        foreign = str(random.choice(names))
        del templates[foreign]
        unknown = random.choice(np.flatnonzero(signs.labels == foreign), queries // 2).tolist()
        takes = [Take("foreign", foreign, signs.takes[take]) for take in unknown]
        yield Drawn(teach_all(templates, 1), takes)


@dataclass(frozen=True)
class Composer:
    """Draws and composes takes of signs.

    Attributes
    ----------
    signs
        The recorded takes.
    random
        Draws takes and changes.
    recorded
        Movements that carry a hand; None: none does.

    """

    signs: HeldSigns
    random: np.random.Generator
    recorded: RecordedSet | None = None

    def choose(self, wanted: npt.NDArray[np.bool_]) -> int:
        """Return the index of a random take among the wanted ones."""
        return int(self.random.choice(np.flatnonzero(wanted)))

    def choose_signs(
        self, names: Sequence[str], beside: Sequence[int] = (), *, same_view: bool = False
    ) -> list[int]:
        """Return random takes of signs; of the run of each take in `beside`, or of other runs."""
        chosen = []
        for number, name in enumerate(names):
            wanted = self.signs.labels == name
            if beside:
                other = beside[number]
                wanted &= (self.signs.runs == self.signs.runs[other]) == same_view
                wanted[other] = False
            chosen.append(self.choose(wanted))
        return chosen

    def show(self, takes: Sequence[int]) -> PoseSequence:
        """Return a take that shows the signs of some takes one after the other."""
        return sign_sequences.compose([self.signs.takes[take] for take in takes], self.random)

    def define(self, names: Sequence[str]) -> tuple[list[int], Gesture]:
        """Return a gesture of signs, and the takes of which its demonstration is composed.

        Raises
        ------
        GestureError
            When none of `TRIES` demonstrations shows as many shapes as signs.

        """
        label = ", ".join(names)
        for _ in range(TRIES):
            takes = self.choose_signs(names)
            with suppress(GestureError):
                gesture = Gesture.from_demonstration(label, self.show(takes))
                if len(gesture.held_shapes) == len(names):
                    return takes, gesture
        raise GestureError(f"no take of {label} shows {len(names)} shapes")

    def carry(self, movement: int, hand: int) -> PoseSequence:
        """Return a movement that carries the hand of a sign, by their indices."""
        shown = self.signs.takes[hand].hands
        assert self.recorded is not None
        assert shown is not None
        moved = self.recorded.recordings[movement]
        return moving_signs.compose(moved, shown[:, 1], self.random)

    def carry_any(self) -> PoseSequence:
        """Return any movement that carries the hand of any sign."""
        assert self.recorded is not None
        movement = int(self.random.integers(len(self.recorded.recordings)))
        return self.carry(movement, int(self.random.integers(len(self.signs.takes))))


def draw_sequences(composer: Composer, draws: int) -> Iterator[Drawn]:
    """Draw languages of `FEW` sequences of two signs and all signs alone, shown once each.

    Takes show a sequence of the language, both signs in the demonstrated view or both in another
    one; another order, another second or first sign, three signs, or one sign alone.
    """
    random, names = composer.random, np.unique(composer.signs.labels).tolist()
    pairs = [*permutations(names, 2)]
    able = [pair for pair in pairs if set(pair) != ONE_SHAPE]
    for _ in range(draws):
        chosen = [able[index] for index in random.permutation(len(able))[:FEW]]
        shown = {signs: composer.define(signs) for signs in (*chosen, *((name,) for name in names))}
        free = [pair for pair in pairs if pair not in chosen]
        takes = []

        def add(relation: str, signs: Sequence[str], shown: list[int]) -> None:
            takes.append(Take(relation, ", ".join(signs), composer.show(shown)))  # noqa: B023

        for signs in chosen:
            beside, _ = shown[signs]
            for view in ("same-view", "other-view"):
                own = composer.choose_signs(signs, beside, same_view=view == "same-view")
                add(view, signs, own)
            first, second = signs
            for relation, fitting in (
                ("other-order", [(second, first)]),
                ("other-second", [pair for pair in pairs if pair[0] == first]),
                ("other-first", [pair for pair in pairs if pair[1] == second]),
            ):
                if others := [pair for pair in fitting if pair in free]:
                    other = others[int(random.integers(len(others)))]
                    add(relation, other, composer.choose_signs(other))
            three = (*signs, str(random.choice([name for name in names if name != second])))
            add("three-signs", three, composer.choose_signs(three))
            add("alone", (first,), composer.choose_signs((first,)))
        gestures = [gesture for _, gesture in shown.values()]
        yield Drawn(Recognizer(Language("sequences", gestures)), takes)


@dataclass(frozen=True, eq=False)
class Twins:
    """A language of movements, two of whose gestures differ by the hand alone.

    Attributes
    ----------
    labels, shown
        Of the gestures: the two, then the others.
    movements, hands
        Indices of the movements and hands of the two.
    person
        Who shows all demonstrations.

    """

    labels: list[str]
    shown: list[PoseSequence]
    movements: list[int]
    hands: list[int]
    person: str

    def teach(
        self, hand_shape: Literal["on", "off", "auto"], *, see_hands: bool = True
    ) -> Recognizer:
        """Return the language; its switch is on for the two only, and off for all gestures."""
        gestures = []
        for number, (label, poses) in enumerate(zip(self.labels, self.shown, strict=True)):
            seen = poses if see_hands else replace(poses, hands=None)
            gesture = Gesture.from_demonstration(label, seen)
            if number < 2 or hand_shape == "off":
                gesture = replace(gesture, switches=Switches(hand_shape=hand_shape))
            gestures.append(gesture)
        return Recognizer(Language("twins", gestures))


def draw_twins(composer: Composer, movements: int = FEW) -> Twins:
    """Draw a language of some movements, one of them with two hands that differ clearly."""
    recorded, signs, random = composer.recorded, composer.signs, composer.random
    assert recorded is not None
    while True:
        person = str(random.choice(np.unique(recorded.people)))
        classes = random.choice(np.unique(recorded.labels), movements, replace=False)
        names = random.choice(np.unique(signs.labels), 2, replace=False).tolist()
        own = recorded.people == person
        same = np.flatnonzero(own & (recorded.labels == classes[0]))
        if frozenset(names) != TURNED and len(same) >= 3:
            break
    chosen = random.choice(same, 2, replace=False).tolist()
    hands = composer.choose_signs(names)
    shown = [composer.carry(*each) for each in zip(chosen, hands, strict=True)]
    for name in classes[1:]:
        # A hand of any sign: the shape must not matter for a movement without a twin.
        other = composer.choose(own & (recorded.labels == name))
        shown.append(composer.carry(other, int(random.integers(len(signs.takes)))))
    labels = [*names, *(f"movement {name}" for name in classes[1:])]
    return Twins(labels, shown, chosen, hands, person)


def show_twins(composer: Composer, twins: Twins, queries: int) -> Iterator[Take]:
    """Yield takes of the movement of the two, with one of their hands, a third one, or none."""
    recorded, signs = composer.recorded, composer.signs
    assert recorded is not None
    pair = twins.labels[:2]
    moved = recorded.labels == recorded.labels[twins.movements[0]]
    moved[twins.movements] = False
    own = recorded.people == twins.person
    third = ~np.isin(signs.labels, [*pair, *(TURNED if TURNED & {*pair} else ())])
    for _ in range(queries):
        meant = int(composer.random.integers(2))
        shaped = signs.labels == pair[meant]
        shaped[twins.hands] = False
        same = signs.runs == signs.runs[twins.hands[meant]]
        for who, people in (("same", own), ("another", ~own)):
            for view, runs in (("same-view", same), ("other-view", ~same)):
                poses = composer.carry(
                    composer.choose(moved & people), composer.choose(shaped & runs)
                )
                yield Take(f"{who}/{view}", pair[meant], poses)
            yield Take("no-hand", "no hand", replace(poses, hands=None))
            foreign = composer.carry(composer.choose(moved & people), composer.choose(third))
            yield Take("foreign", "third shape", foreign)
