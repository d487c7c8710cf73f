"""The tables of the published JSON Schemas: language file and robot events."""

from __future__ import annotations

import json
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

from json_types import anchor, keys_table

PACKAGE = Path(str(import_module("app").__file__)).parent


def _schema_file(name: str) -> Path:
    (path,) = PACKAGE.rglob(name)
    return path


SCHEMAS = {
    "language file": _schema_file("gesture-language-1.schema.json"),
    "recognition report": _schema_file("recognition-report-1.schema.json"),
    "robot events": _schema_file("robot-event-1.schema.json"),
}


def language_file() -> str:
    """Return the tables of a language file: the document, then the objects inside it."""
    schema, path = _read("language file")
    root = f"### LanguageDocument {{ #{anchor('LanguageDocument')} }}\n"
    first = [_where(path), root, f"{schema['description']}\n", keys_table(schema)]
    return "\n".join([*first, *_objects(schema)])


def recognition_report() -> str:
    """Return the tables of what ``recognize --json`` prints: the report, then its takes."""
    schema, path = _read("recognition report")
    first = [_where(path), f"{schema['description']}\n", keys_table(schema)]
    return "\n".join([*first, *_objects(schema)])


def robot_events() -> str:
    """Return the tables of the robot's events."""
    schema, path = _read("robot events")
    return "\n".join([_where(path), *_objects(schema)])


def _read(name: str) -> tuple[dict[str, Any], Path]:
    path = SCHEMAS[name]
    return json.loads(path.read_text(encoding="utf-8")), path


def _where(path: Path) -> str:
    return f"The JSON Schema (2020-12) as a file: [{path.name}]({path.name}).\n"


def _objects(schema: dict[str, Any]) -> Iterator[str]:
    for name, definition in schema["$defs"].items():
        event = definition.get("properties", {}).get("event", {}).get("const")
        title = f"`{event}`" if event else name
        yield f"### {title} {{ #{anchor(name)} }}\n"
        yield f"{definition.get('description', '')}\n"
        yield keys_table(definition) or f"One of {definition.get('enum')}.\n"
