"""Values of several schemas: labels, names, seconds."""

from __future__ import annotations

from typing import Annotated, Any, Self

from fastapi import Query
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, StrictBool, model_validator

from app.recognition.gestures.demonstration import MAX_DIVER_LENGTH
from app.recognition.gestures.gesture import MAX_LABEL_LENGTH, MAX_TEXT_LENGTH
from app.recognition.language.language import MAX_AUTHOR_LENGTH, MAX_NAME_LENGTH
from app.recognition.text.described import DESCRIBED
from app.recognition.text.look_alikes import compose, is_printable

MOST_SECONDS = 24 * 60 * 60
"""Largest number of seconds in a request: no clip is a day long, so more is a mistake."""


def _require_printable(text: str) -> str:
    """Refuse line breaks, NUL, and characters that turn the direction of writing."""
    if not is_printable(text):
        raise ValueError("a name holds printable characters only")
    return text


Name = Annotated[str, Field(min_length=1, max_length=MAX_NAME_LENGTH, pattern=r"\S")]
Author = Annotated[str, Field(max_length=MAX_AUTHOR_LENGTH)]
Label = Annotated[str, Field(min_length=1, max_length=MAX_LABEL_LENGTH, pattern=r"\S")]
NewName = Annotated[Name, AfterValidator(compose)]
"""Name in the form that is stored."""
NewLabel = Annotated[Label, AfterValidator(compose)]
"""Label in the form that is stored; one of an imported file may have another form."""
Diver = Annotated[
    str,
    Field(max_length=MAX_DIVER_LENGTH),
    AfterValidator(compose),
    AfterValidator(_require_printable),
]

NONE_EXPECTED = ""
"""Stands in the store where none of the gestures is expected: no label is empty."""

Seconds = Annotated[float, Field(ge=0, le=MOST_SECONDS, allow_inf_nan=False)]
Identifier = Annotated[str, Field(min_length=1, max_length=64)]
Landmarks = Annotated[list[Annotated[str, Field(max_length=64)]], Field(max_length=64)]
Command = Annotated[str, Field(max_length=MAX_TEXT_LENGTH)] | dict[str, Any] | None

TriggerLanguage = Annotated[
    str | None,
    Query(
        max_length=64,
        description="Language whose trigger begins and ends takes; left out: a salute does",
    ),
]


SoFar = Annotated[
    bool,
    Query(
        description="Whether the first frames suffice while the clip's job reads the others; "
        "left out: 409 until it is done"
    ),
]


class Body(BaseModel):
    """Base of request bodies: unknown members are mistakes, and are said to be."""

    model_config = ConfigDict(**DESCRIBED, extra="forbid")


class View(BaseModel):
    """Base of answers: they can be validated from objects with the same attributes."""

    model_config = ConfigDict(**DESCRIBED, from_attributes=True)


class ExpectedGesture(Body):
    """The gesture that a take is expected to show, if any."""

    expected: Label | None = None
    expected_none: StrictBool = False
    """Whether none of the gestures is expected, in place of a label."""

    @model_validator(mode="after")
    def _require_one(self) -> Self:
        if self.expected_none and self.expected is not None:
            raise ValueError("expected and expected_none exclude each other: leave one out")
        return self

    @property
    def stored(self) -> str | None:
        """What the store keeps: the label, `NONE_EXPECTED`, or None where nothing is expected."""
        return NONE_EXPECTED if self.expected_none else self.expected


class RequiredGesture(ExpectedGesture):
    """The gesture that a take shows, or that it shows none of the language's."""

    @model_validator(mode="after")
    def _require_any(self) -> Self:
        if self.expected is None and not self.expected_none:
            raise ValueError("expected is missing: give a label, or expected_none")
        return self

    @property
    def stored(self) -> str:
        """What the store keeps: the label, or `NONE_EXPECTED`."""
        return self.expected or NONE_EXPECTED


class ExpectedGestureView(View):
    """The gesture that is expected of a take."""

    expected: str | None
    """Null: nothing is, or none of the gestures."""
    expected_none: bool = False
    """Whether none of the gestures is expected."""

    @model_validator(mode="before")
    @classmethod
    def _read_stored(cls, values: dict[str, Any]) -> dict[str, Any]:
        """Read `NONE_EXPECTED` of the store."""
        if values["expected"] == NONE_EXPECTED:
            return values | {"expected": None, "expected_none": True}
        return values
