"""JSON Schema as words: what may stand in a key, and tables of an object's keys."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from tables import cell, table

Schema = Mapping[str, Any]

LIMITS = {
    "minimum": "at least {}",
    "exclusiveMinimum": "above {}",
    "maximum": "at most {}",
    "exclusiveMaximum": "below {}",
    "minLength": "at least {} characters",
    "maxLength": "at most {} characters",
    "minItems": "at least {} items",
    "maxItems": "at most {} items",
    "pattern": "matches `{}`",
}


def anchor(name: str) -> str:
    """Return the anchor of a schema's heading."""
    return f"schema-{name.lower()}"


def type_of(schema: Schema) -> str:
    """Return the type of a value in words, with links to the schemas on the same page."""
    if "$ref" in schema:
        name = schema["$ref"].rsplit("/", 1)[-1]
        return f"[{name}](#{anchor(name)})"
    if "const" in schema:
        return f"`{_json(schema['const'])}`"
    if "enum" in schema:
        return " or ".join(f"`{_json(value)}`" for value in schema["enum"])
    for key in ("anyOf", "oneOf", "allOf"):
        if key in schema:
            return " or ".join(dict.fromkeys(map(type_of, schema[key])))
    if schema.get("type") == "array":
        return _list_type(schema)
    if schema.get("type") == "object" and isinstance(schema.get("additionalProperties"), Mapping):
        return f"object of {type_of(schema['additionalProperties'])}"
    kind = schema.get("type", "any")
    return " or ".join(kind) if isinstance(kind, list) else str(schema.get("format") or kind)


def keys_table(schema: Schema) -> str:
    """Return the table of an object's keys, empty when it has none."""
    required = schema.get("required", ())
    rows = [
        (f"`{name}`", type_of(key), "yes" if name in required else "", meaning_of(key))
        for name, key in schema.get("properties", {}).items()
    ]
    return table(["key", "type", "required", "meaning"], rows) if rows else ""


def meaning_of(schema: Schema) -> str:
    """Return the description, limits and default of a value as one cell."""
    limits = [
        text.format(cell(str(part[name])))
        for part in (schema, *schema.get("anyOf", ()))
        for name, text in LIMITS.items()
        if name in part
    ]
    default = schema.get("default")
    parts = [cell(schema.get("description", "")).rstrip("."), ", ".join(limits)]
    if default is not None and default != schema.get("const"):
        parts.append(f"default `{cell(_json(default))}`")
    return "; ".join(part for part in parts if part)


def _list_type(schema: Schema) -> str:
    if "prefixItems" in schema:
        return f"[{', '.join(map(type_of, schema['prefixItems']))}]"
    return f"list of {type_of(schema.get('items', {}))}"


def _json(value: object) -> str:
    return json.dumps(value)
