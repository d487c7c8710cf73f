"""What the server asks of the worker that writes a session."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel

from app.bags.session_writer import NamedRecognition
from app.recognition import Recognition


class RecognitionWish(BaseModel):
    """A recognition to write, with its result as `Recognition.to_dict` tells it."""

    start: float
    end: float
    language: str
    revision: int
    expected: str | None
    result: dict[str, Any]

    def named(self) -> NamedRecognition:
        """Return the recognition itself."""
        return NamedRecognition(
            start=self.start,
            end=self.end,
            language=self.language,
            revision=self.revision,
            result=Recognition.from_dict(self.result),
            expected=self.expected,
        )


class SessionWishes(BaseModel):
    """All that is to be in a session, besides what was found in the clip."""

    clip: str
    recognitions: list[RecognitionWish]
