"""Grammar: the phrases of a language, which are sequences of gestures with one command.

Modelled on CADDIAN (Chiarella et al. 2015, 2018): messages have start and end gestures, and phrases
have slots for quantities. Every repetition is bounded, so there are finitely many sequences and
ambiguities can be found exactly, see `ambiguity`.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace

from app.recognition.errors import LanguageError
from app.recognition.phrases.phrase import Group, OneOf, Part, Phrase, Slot, SlotType
from app.recognition.phrases.validation import check_phrases
from app.recognition.text.strict_json import build_pointer

DEFAULT_TIMEOUT = 10.0
"""Seconds: how long attention stays with a dialogue without answer (Nielsen 1993)."""

MAX_TIMEOUT = 600.0
"""Seconds: ten minutes, far longer than any pause within a message."""

MAX_PHRASES_IN_MESSAGE = 8
"""Most phrases of a message. CADDIAN's missions have up to eleven commands; longer ones are planned
on the surface."""

FRAME = ("start", "end", "cancel")
"""Roles of the gestures around a message."""


@dataclass(frozen=True)
class Use:
    """A reference to a gesture in a grammar.

    Attributes
    ----------
    label
        The gesture's.
    pointer
        JSON pointer into the language file.
    where
        The place in words.
    role
        One of `FRAME`; None inside a phrase or a slot type.

    """

    label: str
    pointer: str
    where: str
    role: str | None = None


@dataclass(frozen=True)
class Grammar:
    """The phrases of a language, with its start, end and cancel gestures and time-out.

    Attributes
    ----------
    phrases
        In the author's order.
    slot_types
        The types of slots.
    start, end
        Labels of the gestures that open and close a message; None: none is needed.
    cancel
        Label of the gesture that drops an unfinished message.
    timeout
        Most seconds between the end of a gesture and the start of the next one of a message.
    most_phrases
        Phrases in one message, one after the other, each opened by `start`.

    Raises
    ------
    LanguageError
        When it is inconsistent; the pointer is that of the language file.

    """

    phrases: tuple[Phrase, ...] = ()
    slot_types: tuple[SlotType, ...] = ()
    start: str | None = None
    end: str | None = None
    cancel: str | None = None
    timeout: float = DEFAULT_TIMEOUT
    most_phrases: int = 1

    def __post_init__(self) -> None:
        """Validate the grammar."""
        self._check_frame()
        check_phrases(self.phrases, self.slot_types)
        self._check_cancel()

    def _check_frame(self) -> None:
        if not 0 < self.timeout <= MAX_TIMEOUT:  # NaN is not either
            raise LanguageError(
                f"must be above 0 and at most {MAX_TIMEOUT:g} seconds, got {self.timeout}",
                "/grammar/timeout",
            )
        if not 1 <= self.most_phrases <= MAX_PHRASES_IN_MESSAGE:
            raise LanguageError(
                f"must be 1 to {MAX_PHRASES_IN_MESSAGE}, got {self.most_phrases}",
                "/grammar/most_phrases",
            )
        if self.most_phrases > 1 and self.end is None:
            raise LanguageError(
                "a message of several phrases needs an end gesture: without one the robot cannot "
                "detect its end",
                "/grammar/most_phrases",
            )

    def _check_cancel(self) -> None:
        for use in self.uses():
            if use.label == self.cancel and use.role != "cancel":
                raise LanguageError(
                    f"{use.label!r} is the cancel gesture, so {use.where} cannot use it: choose "
                    "another gesture",
                    use.pointer,
                )

    def slot_type(self, name: str) -> SlotType:
        """Return the slot type of that name, which must exist."""
        return next(each for each in self.slot_types if each.name == name)

    def uses(self) -> Iterator[Use]:
        """Yield every reference to a gesture, in the file's order."""
        for role in FRAME:
            label = getattr(self, role)
            if label is not None:
                yield Use(label, build_pointer("grammar", role), f"the {role} gesture", role)
        for index, slot_type in enumerate(self.slot_types):
            for number, label in enumerate(slot_type.values):
                pointer = build_pointer("grammar", "slot_types", index, "values", number, "gesture")
                yield Use(label, pointer, f"the slot type {slot_type.name!r}")
        for index, phrase in enumerate(self.phrases):
            place = build_pointer("grammar", "phrases", index, "parts")
            for pointer, label in _labels_in(phrase.parts, place):
                yield Use(label, pointer, f"the phrase {phrase.name!r}")

    def require(self, labels: Collection[str]) -> None:
        """Check that a language has all gestures of the grammar.

        Raises
        ------
        LanguageError
            When a gesture is missing; its pointer is that of the language file.

        """
        for use in self.uses():
            if use.label not in labels:
                raise LanguageError(
                    f"{use.where} needs a gesture {use.label!r}, which the language does not "
                    f"have; it has {', '.join(sorted(labels)) or 'none'}",
                    use.pointer,
                )

    def users_of(self, label: str) -> tuple[str, ...]:
        """Return the phrases and other places that need a gesture, in words, each once.

        A phrase with a slot needs the gestures of the slot's type as well.
        """
        named = {use.where: None for use in self.uses() if use.label == label}
        filled = {each.name for each in self.slot_types if label in each.values}
        for phrase in self.phrases:
            if any(slot.slot_type in filled for slot, _ in phrase.slots()):
                named[f"the phrase {phrase.name!r}"] = None
        return tuple(named)

    def renamed(self, before: str, after: str) -> Grammar:
        """Return the grammar in which a gesture has another label."""

        def name(label: str) -> str:
            return after if label == before else label

        def part(each: Part) -> Part:
            if isinstance(each, OneOf):
                return replace(each, gestures=tuple(map(name, each.gestures)))
            if isinstance(each, Group):
                members = [part(member) for member in each.parts]
                return replace(each, parts=tuple(m for m in members if not isinstance(m, Group)))
            return each

        def slot_type(each: SlotType) -> SlotType:
            return replace(each, values={name(label): v for label, v in each.values.items()})

        def phrase(each: Phrase) -> Phrase:
            return replace(each, parts=tuple(map(part, each.parts)))

        return replace(
            self,
            start=self.start and name(self.start),
            end=self.end and name(self.end),
            cancel=self.cancel and name(self.cancel),
            slot_types=tuple(map(slot_type, self.slot_types)),
            phrases=tuple(map(phrase, self.phrases)),
        )

    def example(self, phrase: Phrase) -> tuple[str, ...]:
        """Return a message of one phrase with all its parts."""
        opening = () if self.start is None else (self.start,)
        closing = () if self.end is None else (self.end,)
        return (*opening, *self._example_of(phrase.parts), *closing)

    def _example_of(self, parts: Sequence[Part]) -> Iterator[str]:
        for part in parts:
            for _ in range(max(part.least, 1)):
                if isinstance(part, Group):
                    yield from self._example_of(part.parts)
                elif isinstance(part, Slot):
                    yield next(iter(self.slot_type(part.slot_type).values))
                else:
                    yield part.gestures[0]


def _labels_in(parts: Sequence[Part], place: str) -> Iterator[tuple[str, str]]:
    for index, part in enumerate(parts):
        at = place + build_pointer(index)
        if isinstance(part, OneOf):
            for number, label in enumerate(part.gestures):
                yield at + build_pointer("gestures", number), label
        elif isinstance(part, Group):
            yield from _labels_in(part.parts, at + "/parts")
