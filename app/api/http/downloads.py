"""Downloads: the names under which browsers save answers."""

from __future__ import annotations

import re
import unicodedata
from urllib.parse import quote


def attachment(name: str, suffix: str) -> str:
    """Return the ``Content-Disposition`` of a file whose name a shell takes without quotes.

    The page writes the same name into the robot's command (``fileName`` of the export).
    """
    plain = "".join(
        each for each in unicodedata.normalize("NFKD", name) if unicodedata.category(each)[0] != "M"
    )
    stem = re.sub(r"[^\w.-]+", "-", plain, flags=re.ASCII).strip("-") or "language"
    return f'attachment; filename="{stem}{suffix}"'


def attachment_as_written(name: str, plain: str) -> str:
    """Return that of a file under any name; `plain` is for clients that know ASCII alone."""
    return f"attachment; filename=\"{plain}\"; filename*=utf-8''{quote(name, safe='')}"
