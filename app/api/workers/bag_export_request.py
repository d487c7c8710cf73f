"""Bag export request: the data that the server passes to the worker that writes MCAP."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel

from app.bags.export_writer import NamedRecognition
from app.recognition import Recognition
from app.recognition.language.trigger_entry import TriggerEntry


class ExportedRecognition(BaseModel):
    """A recognition to write; `result` is `Recognition.to_dict`."""

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


class BagExportRequest(BaseModel):
    """The content of a bag export, besides the clip's own files; `trigger` cuts its takes."""

    clip: str
    recognitions: list[ExportedRecognition]
    trigger: TriggerEntry | None = None
