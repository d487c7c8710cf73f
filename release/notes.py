"""Release notes: the changelog's sections about a version and the changes since."""

from __future__ import annotations

import re

from release.checkout import ReleaseError


def read_notes(changelog: str, version: str) -> str:
    """Return the changelog's sections from its top down to that of a version.

    Raises
    ------
    ReleaseError
        When the changelog has no section of the version.

    """
    sections = re.split(r"^(?=## )", changelog, flags=re.MULTILINE)[1:]
    titles = [section.partition("\n")[0] for section in sections]
    own = next((i for i, title in enumerate(titles) if title.startswith(f"## [{version}]")), None)
    if own is None:
        raise ReleaseError(f'the changelog has no section "## [{version}]"; add it')
    body = [section.partition("\n")[2].strip() for section in sections[: own + 1]]
    return f"# OSG Studio {version}\n\n" + "\n\n".join(text for text in body if text) + "\n"
