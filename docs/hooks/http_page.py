"""The HTTP interface, from the OpenAPI description of the app."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

from json_types import anchor, keys_table, meaning_of, type_of
from tables import cell, table

from app.server import create_app
from app.settings import Settings

BASE = "/api/v1"
SUCCESS = "Successful Response"
"""FastAPI's description of every answer that has none of its own."""

METHODS = ("get", "post", "put", "patch", "delete", "head", "options")


def http() -> str:
    """Return every operation by noun, then the schemas that bodies are made of."""
    description = create_app(Settings()).openapi()
    return "\n".join([*_operations(description), *_schemas(description)])


def _operations(description: Mapping[str, Any]) -> Iterator[str]:
    found = [
        (operation["tags"][0], method, path, operation)
        for path, operations in description["paths"].items()
        for method, operation in operations.items()
        if method in METHODS
    ]
    everywhere = set.intersection(*(set(operation["responses"]) for *_, operation in found))
    yield f"Every operation may return {', '.join(sorted(everywhere))} with a problem document.\n"
    for tag in dict.fromkeys(tag for tag, *_ in found):
        yield f"## {tag.capitalize()}\n"
        for own, method, path, operation in found:
            if own == tag:
                yield from _operation(method, path, operation, everywhere)


def _operation(
    method: str, path: str, operation: Mapping[str, Any], everywhere: set[str]
) -> Iterator[str]:
    path = path.removeprefix(BASE)
    name = re.sub(r"\W+", "-", f"{method}{path}").strip("-")
    yield f"### `{method.upper()} {path}` {{ #{name} }}\n"
    yield f"{operation['description']}\n"
    parameters = [
        (f"`{it['name']}`", it["in"], type_of(it["schema"]), meaning_of(it["schema"] | it))
        for it in operation.get("parameters", ())
    ]
    if parameters:
        yield table(["parameter", "in", "type", "meaning"], parameters)
    for media_type, body in operation.get("requestBody", {}).get("content", {}).items():
        yield f"Body: `{media_type}`, {type_of(body['schema'])}\n"
        yield keys_table(body["schema"])
    yield table(
        ["status", "content", "meaning"],
        [
            (status, _content(response), cell(response["description"]).replace(SUCCESS, ""))
            for status, response in sorted(operation["responses"].items())
            if status not in everywhere
        ],
    )


def _content(response: Mapping[str, Any]) -> str:
    return ", ".join(
        f"`{media_type}`: {type_of(body['schema'])}" if body.get("schema") else f"`{media_type}`"
        for media_type, body in response.get("content", {}).items()
    )


def _schemas(description: Mapping[str, Any]) -> Iterator[str]:
    yield "## Schemas\n"
    for name, schema in sorted(description["components"]["schemas"].items()):
        yield f"### {name} {{ #{anchor(name)} }}\n"
        yield f"{schema.get('description', '')}\n"
        yield keys_table(schema) or f"{type_of(schema)}\n"
