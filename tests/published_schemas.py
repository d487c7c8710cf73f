"""The published JSON Schemas, and the models that they are generated from.

    python -m tests.published_schemas

writes them anew.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from app.cli.recognize import RecognitionReport
from app.recognition.language.file_schema import LanguageDocument
from app.robot.event_messages import MESSAGES
from tests.conftest import ROOT


@dataclass(frozen=True)
class PublishedSchema:
    """A JSON Schema 2020-12 that is checked in and shipped.

    Attributes
    ----------
    folder
        Where its file is, in the package.
    name
        Its name and version, which is raised when a reader of this version could misunderstand
        what is written; new keys and new events do not raise it.
    describe
        Returns the schema of the models.

    """

    folder: str
    name: str
    describe: Callable[[], dict[str, Any]]

    @property
    def file(self) -> Path:
        return ROOT / "app" / self.folder / "schema" / f"{self.name}.schema.json"

    @property
    def content(self) -> dict[str, Any]:
        """The schema that is checked in."""
        content: dict[str, Any] = json.loads(self.file.read_text("utf-8"))
        return content

    def generate(self) -> str:
        name, _, version = self.name.rpartition("-")
        identity = f"urn:osg-studio:{name}:{version}"
        head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "$id": identity}
        return json.dumps(head | self.describe(), indent=2) + "\n"


LANGUAGE_FILE = PublishedSchema(
    "recognition", "gesture-language-1", LanguageDocument.model_json_schema
)
RECOGNITION_REPORT = PublishedSchema(
    "cli", "recognition-report-1", RecognitionReport.model_json_schema
)
ROBOT_EVENT = PublishedSchema(
    "robot", "robot-event-1", lambda: MESSAGES.json_schema(mode="serialization")
)
SCHEMAS = (LANGUAGE_FILE, RECOGNITION_REPORT, ROBOT_EVENT)


if __name__ == "__main__":
    for schema in SCHEMAS:
        schema.file.write_text(schema.generate(), encoding="utf-8")
