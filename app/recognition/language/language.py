"""Gesture language: a named set of gestures, with grammar, profile, tuning and file format."""

from __future__ import annotations

import logging
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

from app.recognition.decision.outcome import MOST_REFUSED, MOST_REFUSED_AT_ALL
from app.recognition.errors import LanguageError, point_to
from app.recognition.gestures.gesture import SETTINGS, Gesture, make_label
from app.recognition.gestures.profile import (
    AS_THE_PROFILE,
    DEFAULT_PROFILE,
    ProfileName,
    Tuning,
    find_profile,
)
from app.recognition.language.file import (
    entry_to_gesture,
    gesture_to_entry,
    name_file,
    read_content,
    read_document,
    write_document,
)
from app.recognition.language.file_schema import (
    FORMAT,
    MAX_GESTURES,
    VERSION,
    LanguageDocument,
    entry_to_trigger,
    entry_to_tuning,
    trigger_to_entry,
    tuning_to_entry,
)
from app.recognition.language.grammar_entry import entry_to_grammar, grammar_to_entry
from app.recognition.phrases.grammar import Grammar
from app.recognition.poses.landmarks import SKELETON
from app.recognition.text.atomic_files import write_atomically
from app.recognition.text.look_alikes import (
    compose,
    find_confusable,
    is_printable,
    list_look_alikes,
    without_joiners,
)
from app.recognition.text.strict_json import build_pointer
from app.recognition.text.wording import join_words
from app.recognition.triggers.trigger import SALUTE, Trigger

logger = logging.getLogger(__name__)

TIMESTAMP = "%Y-%m-%dT%H:%M:%SZ"

MAX_NAME_LENGTH = 80
"""Most characters of a name: more than fits on a language's card."""

MAX_AUTHOR_LENGTH = 200
"""Most characters of the author: a few names with their institution."""


@dataclass(frozen=True, eq=False)
class Language:
    """A named set of gestures with distinct labels.

    Attributes
    ----------
    name
        Its name.
    gestures
        In the author's order; any sequence is accepted and stored as a tuple. May be empty.
    author
        Its author.
    created
        Time of creation, in UTC to the second; now when not given.
    revision
        Number of the revision, from 1.
    skeleton
        Pairs of landmarks joined by a bone, for drawing.
    thresholds_for
        Fingerprint of the gestures' thresholds in files of version 0.2 and before; kept for robots
        of these versions, and not used.
    grammar
        Its phrases; None if every gesture is a command of its own.
    profile
        The profile that recognises it, one of `profile.PROFILES`.
    tuning
        The author's changes to that profile.
    trigger
        What begins and ends a take; by default a salute.
    most_refused
        Share of right takes that may be rejected, above 0 and at most `MOST_REFUSED_AT_ALL`; used
        where several people have shown the gestures (`decision.outcome`).

    Raises
    ------
    LanguageError
        When a field breaks these rules; its pointer is that of the language file.

    """

    name: str
    gestures: Sequence[Gesture] = ()
    author: str = ""
    created: datetime | None = None
    revision: int = 1
    skeleton: tuple[tuple[str, str], ...] = SKELETON
    thresholds_for: str = ""
    grammar: Grammar | None = None
    profile: ProfileName = DEFAULT_PROFILE
    tuning: Tuning = AS_THE_PROFILE
    trigger: Trigger = SALUTE
    most_refused: float = MOST_REFUSED

    def __post_init__(self) -> None:
        """Validate and normalise the fields."""
        if not isinstance(self.name, str) or not self.name.strip():
            raise LanguageError(f"a language needs a name, got {self.name!r}", "/name")
        _check_text(self.name, MAX_NAME_LENGTH, "/name")
        _check_text(self.author, MAX_AUTHOR_LENGTH, "/author")
        if self.revision < 1:
            raise LanguageError(f"revisions count from 1, got {self.revision}", "/revision")
        if not 0 < self.most_refused <= MOST_REFUSED_AT_ALL:
            raise LanguageError(
                f"the share of right takes that may be refused is above 0 and at most "
                f"{MOST_REFUSED_AT_ALL}, got {self.most_refused}",
                "/most_refused",
            )
        object.__setattr__(self, "gestures", tuple(self.gestures))
        if len(self.gestures) > MAX_GESTURES:
            raise LanguageError(
                f"{len(self.gestures)} gestures, the limit is {MAX_GESTURES}", "/gestures"
            )
        shown = sum(1 + len(gesture.further) for gesture in self.gestures)
        if shown > MAX_GESTURES:
            raise LanguageError(
                f"{shown} demonstrations of all gestures, the limit is {MAX_GESTURES}", "/gestures"
            )
        seen: set[str] = set()
        for index, gesture in enumerate(self.gestures):
            compared = without_joiners(gesture.label)
            if compared in seen:
                raise LanguageError(
                    f"the label {gesture.label!r} occurs twice: rename or remove one of the two",
                    build_pointer("gestures", index, "label"),
                )
            seen.add(compared)
        if self.grammar is not None:
            self.grammar.require(self.labels)
        if missing := sorted(self.trigger.labels.difference(self.labels)):
            raise LanguageError(
                f"the trigger needs a gesture {missing[0]!r}, which the language has not: choose "
                "another trigger first",
                "/trigger",
            )
        with point_to("/profile"):
            voters = find_profile(self.profile).voters
        with point_to("/tuning/weights"):
            self.tuning.weights_of([voter.name for voter in voters])
        object.__setattr__(self, "created", _utc_second(self.created))

    @property
    def labels(self) -> tuple[str, ...]:
        """The gestures' labels in order."""
        return tuple(gesture.label for gesture in self.gestures)

    def gesture(self, label: str) -> Gesture:
        """Return the gesture of that label.

        Raises
        ------
        LanguageError
            When there is none.

        """
        wanted = self.spell(label)
        for gesture in self.gestures:
            if gesture.label == wanted:
                return gesture
        known = ", ".join(self.labels)
        raise LanguageError(f"no gesture {label!r} in {self.name!r}; it has {known}")

    def spell(self, label: str) -> str:
        """Return a label as the language writes it, in composed form if it has no such gesture."""
        wanted = compose(label)
        return next((each for each in self.labels if compose(each) == wanted), wanted)

    def tuning_with(self, profile: str) -> Tuning:
        """Return the tuning for a profile; weight factors apply to the language's own only."""
        return self.tuning if profile == self.profile else replace(self.tuning, weights={})

    def with_gesture(self, gesture: Gesture) -> Language:
        """Return the next revision, with one more gesture at the end.

        Raises
        ------
        LanguageError
            When the language has a gesture of that label already, or of one that looks like it.

        """
        require_distinct_labels([*self.labels, gesture.label])
        return replace(self, gestures=(*self.gestures, gesture), revision=self.revision + 1)

    def with_changed(self, gesture: Gesture) -> Language:
        """Return the next revision, with a gesture in the place of the one of the same label.

        Raises
        ------
        LanguageError
            When there is none.

        """
        former = self.gesture(gesture.label)
        gestures = [gesture if each is former else each for each in self.gestures]
        return replace(self, gestures=gestures, revision=self.revision + 1)

    def without(self, label: str) -> Language:
        """Return the next revision, without the gesture of that label.

        Raises
        ------
        LanguageError
            When there is none, or a phrase or the trigger needs it.

        """
        unwanted = self.gesture(label)
        if self.grammar is not None and (users := self.grammar.users_of(label)):
            raise LanguageError(
                f"{label!r} cannot be removed, it is needed by {join_words(users)}: change the "
                "phrases first"
            )
        kept = tuple(gesture for gesture in self.gestures if gesture is not unwanted)
        return replace(self, gestures=kept, revision=self.revision + 1)

    def without_demonstrations(self, left_out: Collection[tuple[str, int]]) -> Language:
        """Return the language without some demonstrations, to read these with.

        A gesture of which none is left is missing; so are phrases.

        Parameters
        ----------
        left_out
            Label and number of each, counted from 0.

        """
        if not left_out:
            return self
        kept = (
            gesture.without_demonstrations({at for label, at in left_out if label == gesture.label})
            for gesture in self.gestures
        )
        return replace(self, gestures=[each for each in kept if each is not None], grammar=None)

    def renamed(self, label: str, new: str) -> Language:
        """Return the same revision with another label for a gesture, also in its phrases.

        Raises
        ------
        LanguageError
            When there is no such gesture, or another one has the new label, or one that looks
            like it.

        """
        gesture = replace(self.gesture(label), label=make_label(new))
        others = [each for each in self.labels if each != label]
        require_distinct_labels([*others, gesture.label])
        gestures = [gesture if each.label == label else each for each in self.gestures]
        grammar = self.grammar and self.grammar.renamed(label, gesture.label)
        trigger = self.trigger.renamed(label, gesture.label)
        return replace(self, gestures=gestures, grammar=grammar, trigger=trigger)

    def to_json(self) -> str:
        """Return the language file's text; the same language gives the same text."""
        assert self.created is not None  # set in __post_init__
        document = LanguageDocument(
            format=FORMAT,
            version=VERSION,
            name=self.name,
            author=self.author,
            created=self.created.strftime(TIMESTAMP),
            revision=self.revision,
            skeleton=[list(bone) for bone in self.skeleton],
            settings=dict(SETTINGS),
            thresholds_for=self.thresholds_for,
            grammar=None if self.grammar is None else grammar_to_entry(self.grammar),
            profile=self.profile,
            tuning=tuning_to_entry(self.tuning),
            trigger=trigger_to_entry(self.trigger),
            most_refused=None if self.most_refused == MOST_REFUSED else self.most_refused,
            gestures=[gesture_to_entry(gesture) for gesture in self.gestures],
        )
        return write_document(document)

    @classmethod
    def from_json(cls, text: str | bytes) -> Language:
        """Read a language file's text.

        Raises
        ------
        LanguageError
            When it violates the schema or the rules of this class; the message lists the JSON
            pointers of the errors, and `pointer` is the first.

        """
        document = read_document(text)
        current = document.settings == SETTINGS
        gestures = []
        for index, entry in enumerate(document.gestures):
            gesture = entry_to_gesture(entry, build_pointer("gestures", index))
            gestures.append(gesture if current else gesture.redraw())
        return cls(
            name=document.name,
            gestures=gestures,
            author=document.author,
            created=_moment(document.created),
            revision=document.revision,
            skeleton=tuple((start, end) for start, end in document.skeleton),
            thresholds_for=document.thresholds_for,
            grammar=None if document.grammar is None else entry_to_grammar(document.grammar),
            profile=document.profile,
            tuning=entry_to_tuning(document.tuning, document.profile),
            trigger=entry_to_trigger(document.trigger),
            most_refused=MOST_REFUSED if document.most_refused is None else document.most_refused,
        )

    def save(self, path: str | Path) -> None:
        """Write the language file atomically: readers see the old file or the new one."""
        write_atomically(Path(path), self.to_json().encode("utf-8"))

    @classmethod
    def load(cls, path: str | Path) -> Language:
        """Read a language file; labels that look alike are logged as a warning.

        Raises
        ------
        LanguageError
            When it cannot be read or is invalid; see `from_json`.

        """
        content = read_content(path)
        with name_file(path):
            language = cls.from_json(content)
        for one, other in list_look_alikes(language.labels):
            logger.warning(
                "%s: the labels %r and %r look alike; rename one of them",
                Path(path).name,
                one,
                other,
            )
        return language


def require_distinct_labels(labels: Sequence[str]) -> None:
    """Refuse a last label that looks like one before it, by more than ASCII letters.

    Files that are loaded may hold such labels, which were accepted earlier.

    Raises
    ------
    LanguageError
        When it does.

    """
    *earlier, new = labels
    if (taken := find_confusable(new, earlier)) is not None:
        raise LanguageError(
            f"the label {new!r} looks like {taken!r}, which the language has: a diver cannot tell "
            "them apart, choose another one",
            build_pointer("gestures", len(earlier), "label"),
        )


def _check_text(text: Any, most: int, pointer: str) -> None:
    if not isinstance(text, str) or len(text) > most or not is_printable(text):
        raise LanguageError(f"must be at most {most} printable characters, got {text!r}", pointer)


def _utc_second(moment: datetime | None) -> datetime:
    if moment is None:
        moment = datetime.now(timezone.utc)
    if moment.tzinfo is None:
        raise LanguageError(f"created must have a time zone, got {moment!r}", "/created")
    return moment.astimezone(timezone.utc).replace(microsecond=0)


def _moment(timestamp: str) -> datetime:
    try:
        return datetime.strptime(timestamp, TIMESTAMP).replace(tzinfo=timezone.utc)
    except ValueError as error:
        raise LanguageError(f"no such date and time: {timestamp!r}", "/created") from error
