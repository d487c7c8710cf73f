"""Described models: the docstring below an attribute describes its key in the JSON Schema."""

from __future__ import annotations

import ast
from inspect import getsource
from itertools import pairwise
from typing import Any, Final

from pydantic import ConfigDict


def _join_lines(schema: dict[str, Any]) -> None:
    """Write each description in one line, however its docstring is wrapped."""
    for key in schema.get("properties", {}).values():
        if "description" in key:
            key["description"] = " ".join(key["description"].split())


DESCRIBED: Final = ConfigDict(
    frozen=True, use_attribute_docstrings=True, json_schema_extra=_join_lines
)
"""Of models whose keys are described below their attributes."""

STRICT: Final = ConfigDict(**DESCRIBED, extra="forbid", strict=True)
"""Of the entries of a language file: unknown keys and values of another type are refused."""


def read_descriptions(kind: type) -> dict[str, str]:
    """Return the docstrings below the attributes of a class, each in one line.

    For dataclasses, of which pydantic does not read them. None are found without the source file.
    """
    try:
        body = ast.parse(getsource(kind)).body[0]
    except OSError:
        return {}
    return {
        ast.unparse(attribute.target): " ".join(ast.literal_eval(text.value).split())
        for attribute, text in pairwise(getattr(body, "body", ()))
        if isinstance(attribute, ast.AnnAssign) and isinstance(text, ast.Expr)
    }
