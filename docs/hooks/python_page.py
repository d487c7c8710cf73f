"""The public names of the core, from `app.recognition.__all__`."""

from __future__ import annotations

import app.recognition


def python() -> str:
    """Return a mkdocstrings block for each public name that is no error: those have a page."""
    public = [(name, getattr(app.recognition, name)) for name in app.recognition.__all__]
    return "\n".join(
        f"::: app.recognition.{name}\n"
        for name, value in public
        if not (isinstance(value, type) and issubclass(value, Exception))
    )
