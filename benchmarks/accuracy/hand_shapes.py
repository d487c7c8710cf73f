"""Hand shapes: held still, two in sequence, and during a movement.

Languages are drawn, each with takes that it is asked about: takes of its gestures, and takes of
what it lacks, which should be refused. One protocol reads all of them.

- letters: finger alphabets of six signers; one signer demonstrates, or three, and the takes of the
  others are read, in languages of all letters and of random `FEW` ones.
- signs: one person's divers' signs. *Same view*: a take of the run of which the demonstration is,
  that is, of the same hand, side of the hand and view; *other view*: of another run; *three*: three
  demonstrations of a sign, of different runs, and a take of any run.
- sequences: takes composed of two of these signs (`benchmarks.sets.sign_sequences`).
- movements: takes composed of several people's movements and these signs
  (`benchmarks.sets.moving_signs`). Two gestures of a language, the twins, are one movement with two
  hand shapes, whose switch is on. *Off*: the same language with the switch off.
- starter: the starter language of divers' signs, and rendered clips of other divers.

A take that holds no hand shape counts as refused. The interval is Wilson's.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from app.recognition import (
    Language,
    PoseError,
    Recognizer,
    Recording,
    takes_in,
)
from app.resources import samples_dir
from benchmarks.figures import ROOT, Figure, Measurement, Results, share, table
from benchmarks.sets import sign_sequences
from benchmarks.sets.hand_shape_draws import (
    Composer,
    Drawn,
    Take,
    draw_letters,
    draw_sequences,
    draw_signs,
    draw_twins,
    find_held,
    show_twins,
)
from benchmarks.sets.held_signs import FILE, LETTERS_FILE, read_hand_letters, read_held_signs
from benchmarks.sets.recorded_sets import recorded_sets

LIMIT = 0.15
"""Share of right takes refused at the limit that is compared."""

STARTER = ROOT / "tests" / "recordings" / "signs"
"""Recordings of rendered clips, one of each sign of the starter language."""


@dataclass(frozen=True, eq=False)
class Answer:
    """What a language says of a take.

    Attributes
    ----------
    take
        The take.
    known
        Whether the language has its gesture.
    right
        Whether this gesture is nearest.
    accepted
        Whether the take is not refused.
    in_sequence
        Whether it is accepted as a sequence of shapes.
    novelty
        Of the nearest gesture; infinite where no hand shape is held.

    """

    take: Take
    known: bool
    right: bool
    accepted: bool
    in_sequence: bool
    novelty: float


def ask(languages: Iterable[Drawn]) -> Iterator[Answer]:
    """Yield what each language says of its takes."""
    for drawn in languages:
        language = drawn.recognizer.language
        for take in drawn.takes:
            known = take.label in language.labels
            try:
                result = drawn.recognizer.recognize(take.poses)
            except PoseError:
                yield Answer(take, known, False, False, False, np.inf)
                continue
            nearest, accepted = result.nearest, result.outcome != "rejected"
            yield Answer(
                take,
                known,
                right=result.fault is None and nearest == take.label,
                accepted=accepted,
                in_sequence=accepted and len(language.gesture(nearest).held_shapes) > 1,
                novelty=float(result.novelty[result.gestures.index(nearest)]),
            )


def count(answers: Iterable[Answer]) -> Iterator[Figure]:
    """Yield the figures of each relation.

    Of gestures of the language: `nearest`, nearest right; `right`, right and accepted; `refused`,
    of the takes whose nearest gesture is right. Of others: `accepted`, and accepted `in-sequence`.
    """
    by_relation: dict[str, list[Answer]] = defaultdict(list)
    for each in answers:
        by_relation[each.take.relation].append(each)
    for relation, own in by_relation.items():
        if any(each.known for each in own):
            right = [each.accepted for each in own if each.right]
            yield share(f"{relation}/nearest", len(right), len(own))
            yield share(f"{relation}/right", sum(right), len(own))
            yield share(f"{relation}/refused", len(right) - sum(right), len(right))
            continue
        # A take that recurs in many languages counts once.
        number = len({(each.take.label, *each.take.who) for each in own if each.take.who})
        for name in ("accepted", "in_sequence"):
            rate = float(np.mean([getattr(each, name) for each in own]))
            hits = round(rate * (number or len(own)))
            yield share(f"{relation}/{name.replace('_', '-')}", hits, number or len(own))


def measure_letters(folder: Path, quick: bool) -> Iterator[Figure]:
    """Yield what other signers' letters are read as, and what other limits would do."""
    recorded = read_hand_letters(folder)
    held = find_held(recorded, shapes=1)
    yield share("held", int(held.sum()), len(held))
    for people in (1, 3):
        answers = [*ask(draw_letters(recorded, held, people, 2 if quick else 8, seed=0))]
        yield from count(answers)
        few = [each for each in answers if not each.take.relation.endswith("all")]
        right = [each.novelty for each in few if each.right]
        limit, foreign = np.quantile(right, 1 - LIMIT), [each for each in few if not each.known]
        strict = [replace(each, accepted=bool(each.novelty <= limit)) for each in foreign]
        at = f"{people}/at-{LIMIT:.0%}".rstrip("%")
        yield replace(next(count(strict)), name=at)


def measure_signs(folder: Path, quick: bool) -> Iterator[Figure]:
    """Yield what one person's signs are read as."""
    signs = read_held_signs(folder)
    held = find_held(signs)
    yield share("held", int(held.sum()), len(held))
    yield from count(ask(draw_signs(signs, 10 if quick else 100, 20, seed=0)))


def measure_sequences(folder: Path, quick: bool) -> Iterator[Figure]:
    """Yield what sequences of signs, and what is none of the language, are read as."""
    signs = sign_sequences.turn_alike(read_held_signs(folder))
    composer = Composer(signs, np.random.default_rng(0))
    yield from count(ask(draw_sequences(composer, 10 if quick else 100)))


def measure_movements(folder: Path, quick: bool) -> Iterator[Figure]:
    """Yield what twins are read as, and whether hands that nobody means change an answer."""
    signs, random = read_held_signs(folder), np.random.default_rng(0)
    answers: list[Answer] = []
    asked, same, queries = [], [], 6
    for recorded in recorded_sets(folder, ("digits", "letters")):
        composer = Composer(signs, random, recorded)
        for _ in range(5 if quick else 50):
            twins = draw_twins(composer)
            takes = [*show_twins(composer, twins, queries)]
            meant = [replace(each, relation="off") for each in takes if "view" in each.relation]
            answers += ask([Drawn(twins.teach("on"), takes), Drawn(twins.teach("off"), meant)])
            by_itself = twins.teach("auto")
            asked.append((twins.labels[0], twins.labels[1]) in by_itself.undecided_twins)
            blind = twins.teach("auto", see_hands=False)
            for _ in range(queries):
                poses = composer.carry_any()
                unseen = blind.recognize(replace(poses, hands=None))
                same.append(by_itself.recognize(poses).to_dict() == unseen.to_dict())
    yield from count(answers)
    yield share("asked", sum(asked), len(asked))
    yield share("same-without-hands", sum(same), len(same))


def measure_starter(quick: bool) -> Iterator[Figure]:
    """Yield what the starter language of divers' signs reads other divers' signs as."""
    language = Language.load(samples_dir() / "signs-of-divers.json")
    takes = [
        Take("signs", sign, takes_in(Recording.load(clip))[0].poses)
        for sign in language.labels[: 5 if quick else None]
        if (clip := STARTER / f"sign-{sign.replace(' ', '-')}-test.npz").is_file()
    ]
    yield from count(ask([Drawn(Recognizer(language), takes)]))


def measurements(folder: Path, methods: tuple[str, ...]) -> Iterator[Measurement]:
    """Yield a measurement for each kind of shape."""
    trajectories = folder / "trajectories"
    letters, signs = trajectories / LETTERS_FILE, trajectories / FILE
    hands = "divers' signs, one person's hands in air"
    runs: tuple[tuple[str, Callable[[Path, bool], Iterable[Figure]], str, str, int], ...] = (
        ("letters", measure_letters, "nine letters", "every choice of one and of three signers", 6),
        ("signs", measure_signs, hands, "100 languages, 20 takes each and one more a sign", 1),
        ("sequences", measure_sequences, f"{hands}, composed", "100 languages of five and six", 1),
        (
            "movements",
            measure_movements,
            f"digits, letters and {hands}, composed",
            "100 languages of five movements, six takes of each kind",
            10,
        ),
    )
    files = {"letters": (letters,), "movements": (trajectories / "madlab3d.npz", signs)}
    for name, run, data, protocol, people in runs:
        reads = files.get(name, (signs,))
        measure = partial(run, trajectories)
        yield Measurement(f"hand-shapes/{name}", measure, data, protocol, people, reads)
    yield Measurement(
        "hand-shapes/starter",
        measure_starter,
        "starter language of divers' signs",
        "one take of each sign by another rendered diver",
        reads=(STARTER,),
    )


ROWS = (
    ("letters, one signer demonstrates, others are read", "letters", ("1/all",)),
    ("letters, three signers demonstrate", "letters", ("3/all",)),
    ("signs, same hand and view / other ones", "signs", ("same-view", "other-view")),
    ("signs, three demonstrations from different views", "signs", ("three",)),
    ("starter language, other rendered divers in four waters", "starter", ("signs",)),
    ("two signs, both in the same view / in other ones", "sequences", ("same-view", "other-view")),
    ("twins, same person", "movements", ("same/same-view", "same/other-view")),
    ("twins, another person", "movements", ("another/same-view", "another/other-view")),
    ("twins, switch off", "movements", ("off",)),
)
"""Rows of the table: words, part, and relations that share a cell."""


def write_shapes(results: Results) -> str:
    """Write how often the nearest gesture is right, and right and accepted."""
    rows = []
    for words, part, relations in ROWS:
        name, cells = f"hand-shapes/{part}", [words]
        for kind, style in (("nearest", "n?"), ("nearest", "cell?"), ("right", "cell?")):
            shown = [results.show(name, f"{relation}/{kind}", style) for relation in relations]
            cells.append(" / ".join(dict.fromkeys(shown) if style == "n?" else shown))
        rows.append(cells)
    return table(("takes", "n", "nearest right, %", "right and accepted, %"), rows)


TABLES = {"hand-shapes": write_shapes}
