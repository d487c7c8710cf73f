"""Diff of two revisions of a language, by gesture and in sentences."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from app.recognition import Language
from app.recognition.gestures.gesture import Gesture
from app.recognition.phrases.grammar import Grammar
from app.recognition.text.wording import join_words

Kind = Literal["added", "removed", "changed", "same"]

LONGEST_QUOTE = 60
"""Most characters of a quoted text: a line beside a picture; the cards have the complete texts."""


@dataclass(frozen=True)
class Change:
    """A gesture before and after.

    Attributes
    ----------
    before, after
        The gesture; None if the revision does not have it.
    words
        Differences, one sentence each; empty if there are none or one revision lacks the gesture.

    """

    before: Gesture | None
    after: Gesture | None
    words: tuple[str, ...] = ()

    @property
    def kind(self) -> Kind:
        """Kind of the change."""
        if self.before is None:
            return "added"
        if self.after is None:
            return "removed"
        return "changed" if self.words else "same"


def compare_gestures(older: Language | None, newer: Language) -> list[Change]:
    """Pair the gestures of two revisions.

    A removed gesture and an added one with the same demonstration count as a rename.

    Returns
    -------
    The gestures in the newer revision's order, then those that only the older one has.

    """
    gone = {} if older is None else {gesture.label: gesture for gesture in older.gestures}
    paired = {label: gone.pop(label, None) for label in newer.labels}
    changes = []
    for gesture in newer.gestures:
        before = paired[gesture.label]
        if before is None and (renamed := _same_demonstration(gesture, gone)):
            before = gone.pop(renamed)
        words = () if before is None else _describe_gesture(before, gesture)
        changes.append(Change(before, gesture, words))
    return changes + [Change(gesture, None) for gesture in gone.values()]


def describe_changes(older: Language, newer: Language) -> list[str]:
    """Describe the changes of a language apart from its gestures."""
    words = _tell_differences(
        ("name", older.name, newer.name),
        ("author", older.author, newer.author),
        ("profile", older.profile, newer.profile),
    )
    if older.tuning != newer.tuning:
        words.append(f"was recognised {older.tuning.words}, is {newer.tuning.words}")
    if older.most_refused != newer.most_refused:
        shares = [f"{100 * each.most_refused:.3g} %" for each in (older, newer)]
        words.append(f"at most {shares[0]} of right takes were refused, at most {shares[1]} are")
    if older.trigger != newer.trigger:
        words.append(f"takes were found {older.trigger.words}, are {newer.trigger.words}")
    shared = [label for label in newer.labels if label in older.labels]
    if shared != [label for label in older.labels if label in newer.labels]:
        words.append("the gestures are in another order")
    return words + _describe_grammar(older.grammar, newer.grammar)


def _tell_differences(*named: tuple[str, str, str]) -> list[str]:
    """Tell which texts, each with its name, its old and its new value, were changed."""
    return [f"{what} was {_quote(old)}, is {_quote(new)}" for what, old, new in named if old != new]


def _describe_grammar(older: Grammar | None, newer: Grammar | None) -> list[str]:
    if older is None or newer is None:
        if older is newer:
            return []
        return ["the phrases were taken out" if newer is None else "phrases were added"]
    before = {phrase.name: phrase for phrase in older.phrases}
    after = {phrase.name: phrase for phrase in newer.phrases}
    words = [
        *(f"the phrase {_quote(name)} is new" for name in after.keys() - before.keys()),
        *(f"the phrase {_quote(name)} is gone" for name in before.keys() - after.keys()),
        *(
            f"the phrase {_quote(name)} was changed"
            for name in after.keys() & before.keys()
            if after[name] != before[name]
        ),
    ]
    if replace(older, phrases=()) != replace(newer, phrases=()):
        words.append("what frames the phrases, or fills their slots, was changed")
    return sorted(words)


def _same_demonstration(gesture: Gesture, candidates: dict[str, Gesture]) -> str | None:
    return next(
        (name for name, each in candidates.items() if not _differ_in_demonstration(each, gesture)),
        None,
    )


def _describe_gesture(before: Gesture, after: Gesture) -> tuple[str, ...]:
    words = _tell_differences(
        ("label", before.label, after.label),
        ("description", before.description, after.description),
        ("command", _command_text(before), _command_text(after)),
        ("diver", before.diver, after.diver),
        *(
            (f"switch for {name}", value, getattr(after.switches, name))
            for name, value in vars(before.switches).items()
        ),
    )
    words += _describe_salient(before, after)
    if further := _describe_further(before, after):
        words += further
    elif _differ_in_demonstration(before, after):
        words.append(f"another demonstration{_seconds(before, after)}")
    elif not words and _are_drawn_otherwise(before, after):
        words.append("drawn anew from the same demonstration")
    return tuple(words)


def _describe_salient(before: Gesture, after: Gesture) -> list[str]:
    new = [name for name in after.salient if name not in before.salient]
    gone = [name for name in before.salient if name not in after.salient]
    return [
        f"{', '.join(name.replace('_', ' ') for name in names)} {verb}"
        for names, verb in ((new, "is followed now"), (gone, "is not followed any more"))
        if names
    ]


def _describe_further(before: Gesture, after: Gesture) -> list[str]:
    """Describe the number of added and removed demonstrations of gestures with several."""
    old, new = before.single_demonstrations(), after.single_demonstrations()
    if len(old) == len(new) == 1:
        return []
    added = [each for each in new if all(_differ_in_demonstration(one, each) for one in old)]
    removed = [each for each in old if all(_differ_in_demonstration(one, each) for one in new)]
    return [
        f"{len(shown)} demonstration{'s' if len(shown) > 1 else ''} {verb}{_divers_of(shown)}"
        for shown, verb in ((added, "added"), (removed, "removed"))
        if shown
    ]


def _divers_of(shown: Sequence[Gesture]) -> str:
    divers = dict.fromkeys(_quote(each.diver) for each in shown if each.diver)
    return f", by {join_words([*divers])}" if divers else ""


def _are_drawn_otherwise(before: Gesture, after: Gesture) -> bool:
    old, new = before.single_demonstrations(), after.single_demonstrations()
    return any(
        not np.array_equal(one.image, other.image) for one, other in zip(old, new, strict=False)
    )


def _differ_in_demonstration(before: Gesture, after: Gesture) -> bool:
    """Return whether two gestures differ in demonstration, or in image if they have none."""
    old, new = before.trajectory, after.trajectory
    if old is None or new is None:
        return old is not new or not np.array_equal(before.image, after.image)
    return not (
        old.landmarks == new.landmarks
        and np.array_equal(old.time, new.time)
        and np.array_equal(old.xy, new.xy, equal_nan=True)
    )


def _seconds(before: Gesture, after: Gesture) -> str:
    if before.trajectory is None or after.trajectory is None:
        return ""
    old, new = before.trajectory.time[-1], after.trajectory.time[-1]
    return f": {new:.1f} s instead of {old:.1f} s" if f"{old:.1f}" != f"{new:.1f}" else ""


def _command_text(gesture: Gesture) -> str:
    command = gesture.command
    return command if isinstance(command, str) else json.dumps(command) if command else ""


def _quote(text: str) -> str:
    if not text:
        return "empty"
    short = text if len(text) <= LONGEST_QUOTE else f"{text[: LONGEST_QUOTE - 1]}\u2026"
    return f"\u201c{short}\u201d"
