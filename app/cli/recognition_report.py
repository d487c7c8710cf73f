"""Report of ``osg-studio recognize --json``: one JSON object, and its published JSON Schema."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import zip_longest
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

from app.recognition import Recognition, Take
from app.recognition.explanation.explanation import Explanation
from app.recognition.gestures.profile import ProfileName
from app.recognition.text.described import DESCRIBED

Seconds = Annotated[float, Field(ge=0, description="Seconds after the clip's first frame.")]


class TakeEntry(Recognition):
    """A take and its recognition. G gestures and V voters are in the order of their lists."""

    model_config = ConfigDict(extra="allow")

    start: Seconds
    end: Seconds
    closed: bool
    """Whether a salute, or the other trigger, ended it."""
    explanation: dict[str, Any] | None = None
    """Why, and what would change it; only with --expected."""


class RecognitionReport(BaseModel):
    """What ``osg-studio recognize --json`` prints.

    Programs that read a report ignore keys that they do not know.
    """

    model_config = ConfigDict(**DESCRIBED, extra="allow")

    clip: str
    """The file, as it was given."""
    language: str
    """The language's name."""
    profile: ProfileName
    """The set of voters."""
    takes: list[TakeEntry]


def build_report(
    clip: str,
    language: str,
    profile: str,
    results: Sequence[tuple[Take, Recognition]],
    explanations: Sequence[Explanation],
) -> dict[str, Any]:
    """Build the JSON object; `explanations` may be empty."""
    return {
        "clip": clip,
        "language": language,
        "profile": profile,
        "takes": [
            report_take(take, result, explanation)
            for (take, result), explanation in zip_longest(results, explanations)
        ],
    }


def report_take(
    take: Take, result: Recognition, explanation: Explanation | None = None
) -> dict[str, Any]:
    """Build the JSON object of one recognised take."""
    span = {"start": take.start, "end": take.end, "closed": take.closed}
    explained = {} if explanation is None else {"explanation": explanation.to_dict()}
    return span | result.to_dict() | explained
