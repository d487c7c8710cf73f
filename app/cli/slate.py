"""Command `slate`: a language as one printable page."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from app.cli.terminal import people
from app.recognition import Language
from app.recognition.errors import OsgError


def slate(
    language: Annotated[Path, typer.Argument(help="Language file (.json)")],
    output: Annotated[Path, typer.Option(help="File to write, .pdf or .svg")],
) -> None:
    """Write a language as one printable page for divers: strokes, meanings, and the salute."""
    # Imported here, because a robot's installation has the other commands, but cannot draw pages.
    from app.ui.slate.layout import lay_out
    from app.ui.slate.pdf import to_pdf
    from app.ui.slate.svg import to_svg

    kind = output.suffix.lower()
    if kind not in (".pdf", ".svg"):
        raise OsgError(f"a slate is written as .pdf or .svg, not as {output.name!r}")
    page = lay_out(Language.load(language))
    content = to_pdf(page) if kind == ".pdf" else to_svg(page).encode("utf-8")
    try:
        output.write_bytes(content)
    except OSError as error:
        raise OsgError(f"cannot write {output}: {error.strerror}") from error
    people.print(f"wrote {output}", markup=False)
