"""The settings of the studio, from `app.settings.Settings` and its docstrings."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from inspect import cleandoc

import griffe
from pydantic.fields import FieldInfo
from tables import cell, table

from app.settings import Limits, Settings

UNITS = {"_bytes": (2**20, "MiB"), "_per_second": (2**10, "KiB/s")}


def settings() -> str:
    """Return the tables of settings and of limits with default and meaning."""
    known = {name: field for name, field in Settings.model_fields.items() if name != "limits"}
    return (
        _table("Settings", known, "OSG_{}", str.upper)
        + "\n## Limits\n\nFew need to change these. `OSG_LIMITS` is a JSON object, such as "
        '`{"max_connections": 500}`; what it leaves out keeps its default.\n\n'
        + _table("Limits", Limits.model_fields, "{}", str)
    )


def _table(of: str, fields: Mapping[str, FieldInfo], form: str, spell: Callable[[str], str]) -> str:
    documented = griffe.load("app.settings")[of].members
    rows = [
        (f"`{form.format(spell(name))}`", _default(name, field), cell(_text(documented[name])))
        for name, field in fields.items()
    ]
    return table(["variable" if of == "Settings" else "key", "default", "meaning"], rows)


def _text(attribute: griffe.Object | griffe.Alias) -> str:
    return cleandoc(attribute.docstring.value) if attribute.docstring else ""


def _default(name: str, field: FieldInfo) -> str:
    if field.default_factory is not None:
        return {"data_dir": "the user's data folder", "samples_dir": "the shipped samples"}[name]
    for ending, (size, unit) in UNITS.items():
        if name.endswith(ending) and field.default % size == 0:
            return f"{field.default // size} {unit}"
    return "none" if field.default in (None, ()) else f"{field.default}"
