"""The settings of the studio, from `app.settings.Settings` and its docstrings."""

from __future__ import annotations

from inspect import cleandoc

import griffe
from pydantic.fields import FieldInfo
from tables import cell, table

from app.settings import Settings

UNITS = {"_bytes": (2**20, "MiB"), "_per_second": (2**10, "KiB/s")}


def settings() -> str:
    """Return the table of settings with default and meaning."""
    documented = griffe.load("app.settings")["Settings"].members
    rows = [
        (f"`OSG_{name.upper()}`", _default(name, field), cell(_text(documented[name])))
        for name, field in Settings.model_fields.items()
    ]
    return table(["variable", "default", "meaning"], rows)


def _text(attribute: griffe.Object | griffe.Alias) -> str:
    return cleandoc(attribute.docstring.value) if attribute.docstring else ""


def _default(name: str, field: FieldInfo) -> str:
    if field.default_factory is not None:
        return {"data_dir": "the user's data folder", "samples_dir": "the shipped samples"}[name]
    for ending, (size, unit) in UNITS.items():
        if name.endswith(ending) and field.default % size == 0:
            return f"{field.default // size} {unit}"
    return "none" if field.default in (None, ()) else f"{field.default}"
