"""Hand shapes: accuracy of held signs from one demonstration and from three.

A language holds one template of each sign, drawn at random, and takes are recognised. *Same view*:
a take of the run of which the template is, that is, of the same hand, side of the hand and view;
*other view*: of another run; *three*: three templates of a sign, of different runs, and a take of
any run. A take whose hand is not found to hold a shape counts as wrong and as refused.

Foreign takes are of a sign that the language does not have. They are counted at the shipped
thresholds, and at those that refuse one in twenty right takes of the same view; these are chosen on
all signs but the foreign one. The interval is Wilson's.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from app.evaluation.share import Share
from app.recognition import Gesture, GestureError, Language, PoseError, Recognizer
from benchmarks.sets.held_signs import HeldSigns, read_held_signs

REFUSED = 0.05
"""Share of true takes rejected by the thresholds at which foreign takes are counted."""

RELATIONS = ("same view", "other view", "three")


@dataclass(frozen=True)
class Answer:
    """One recognition.

    Attributes
    ----------
    relation
        One of `RELATIONS`, or ``foreign``.
    sign
        Of the take.
    right
        Whether the take's own sign is nearest; never for a foreign take.
    novelty
        Of the nearest sign; infinite where no held hand was found.

    """

    relation: str
    sign: str
    right: bool
    novelty: float


def recognize(recognizer: Recognizer, signs: HeldSigns, take: int) -> tuple[str, float]:
    """Return the nearest sign of a take, and its novelty; None if no hand holds a shape."""
    try:
        result = recognizer.recognize(signs.takes[take])
    except PoseError:
        return "", np.inf
    return result.nearest, float(result.novelty[result.gestures.index(result.nearest)])


def answer(signs: HeldSigns, draws: int, queries: int, seed: int) -> Iterator[Answer]:
    """Recognise takes in languages of random templates."""
    random = np.random.default_rng(seed)
    gestures = _define(signs)
    names = np.unique(signs.labels)
    for _ in range(draws):
        templates = {name: _draw_templates(signs, gestures, name, random) for name in names}
        one = _language({name: each[:1] for name, each in templates.items()}, signs, gestures)
        three = _language(templates, signs, gestures)
        used = {take for each in templates.values() for take in each}
        free = np.setdiff1d(np.arange(len(signs.takes)), sorted(used))
        for take in random.choice(free, queries, replace=False).tolist():
            own = signs.labels[take]
            same = signs.runs[take] == signs.runs[templates[own][0]]
            for relation, language in (
                ("same view" if same else "other view", one),
                ("three", three),
            ):
                nearest, novelty = recognize(language, signs, take)
                yield Answer(relation, own, nearest == own, novelty)
        # Takes of the demonstrated view are rare, so one more of each sign is drawn.
        for name in names:
            run = signs.runs[templates[name][0]]
            beside = free[(signs.labels[free] == name) & (signs.runs[free] == run)]
            take = int(random.choice(beside))
            nearest, novelty = recognize(one, signs, take)
            yield Answer("same view", name, nearest == name, novelty)
        foreign = str(random.choice(names))
        without = _language(
            {name: each[:1] for name, each in templates.items() if name != foreign},
            signs,
            gestures,
        )
        for take in random.choice(np.flatnonzero(signs.labels == foreign), queries // 2).tolist():
            yield Answer("foreign", foreign, False, recognize(without, signs, take)[1])


def _define(signs: HeldSigns) -> dict[int, Gesture]:
    """Return the gestures of the takes that can be a demonstration."""
    gestures = {}
    for take, label in enumerate(signs.labels.tolist()):
        try:
            gesture = Gesture.from_demonstration(label, signs.takes[take])
        except GestureError:
            continue
        if gesture.is_held:
            gestures[take] = gesture
    return gestures


def _draw_templates(
    signs: HeldSigns, gestures: dict[int, Gesture], name: str, random: np.random.Generator
) -> list[int]:
    """Draw takes of a sign of three different runs."""
    usable = np.array([take for take in gestures if signs.labels[take] == name])
    runs = random.permutation(np.unique(signs.runs[usable]))[:3]
    return [int(random.choice(usable[signs.runs[usable] == run])) for run in runs]


def _language(
    templates: dict[str, list[int]], signs: HeldSigns, gestures: dict[int, Gesture]
) -> Recognizer:
    made = []
    for first, *others in templates.values():
        gesture = gestures[first]
        for take in others:
            gesture = gesture.with_demonstration(signs.takes[take])
        made.append(gesture)
    return Recognizer(Language(name="signs", gestures=made))


def report(answers: Sequence[Answer], takes: int, found: int) -> Iterator[str]:
    """Yield the lines of the report."""
    yield f"takes in which a held hand is found: {Share(found, takes)}"
    yield ""
    yield "| relation | n | nearest right | right and accepted |"
    yield "| --- | --- | --- | --- |"
    for relation in RELATIONS:
        own = [each for each in answers if each.relation == relation]
        right = sum(each.right for each in own)
        taken = sum(each.right and each.novelty <= 1 for each in own)
        yield (f"| {relation} | {len(own)} | {Share(right, len(own))} | {Share(taken, len(own))} |")
    yield ""
    foreign = [each for each in answers if each.relation == "foreign"]
    same = [each for each in answers if each.relation == "same view"]
    limits = {each.sign: _choose_limit(same, each.sign) for each in foreign}
    shipped = sum(each.novelty <= 1 for each in foreign)
    chosen = sum(each.novelty <= limits[each.sign] for each in foreign)
    refused = sum(
        not each.right or each.novelty > limits.get(each.sign, np.inf)
        for each in same
        if each.sign in limits
    )
    yield f"foreign takes accepted, shipped thresholds: {Share(shipped, len(foreign))}"
    yield f"foreign takes accepted, {REFUSED:.0%} refused: {Share(chosen, len(foreign))}"
    yield f"right takes of the same view refused there: {Share(refused, len(same))}"
    yield ""
    yield "| sign | other view, nearest right | other view, accepted | foreign accepted |"
    yield "| --- | --- | --- | --- |"
    for sign in sorted({each.sign for each in answers}):
        other = [each for each in answers if each.relation == "other view" and each.sign == sign]
        unknown = [each for each in foreign if each.sign == sign]
        yield (
            f"| {sign} | {_share([each.right for each in other])} "
            f"| {_share([each.right and each.novelty <= 1 for each in other])} "
            f"| {_share([each.novelty <= 1 for each in unknown])} |"
        )


def _choose_limit(same: Sequence[Answer], left_out: str) -> float:
    """Return the novelty that one in twenty right takes of the other signs exceeds."""
    novelties = [each.novelty for each in same if each.right and each.sign != left_out]
    return float(np.quantile(novelties, 1 - REFUSED))


def _share(values: Sequence[bool]) -> str:
    return f"{np.mean(values):.1%} of {len(values)}" if values else "-"


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="holds trajectories/")
    parser.add_argument("--draws", type=int, default=60, help="languages")
    parser.add_argument("--queries", type=int, default=20, help="takes a language")
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args(arguments)
    signs = read_held_signs(given.folder / "trajectories")
    answers = [*answer(signs, given.draws, given.queries, given.seed)]
    for line in report(answers, len(signs.takes), len(_define(signs))):
        print(line)


if __name__ == "__main__":
    main()
