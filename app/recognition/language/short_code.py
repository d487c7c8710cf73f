"""Short code of a language: eight digits of its checksum, which people can compare by reading."""

from __future__ import annotations

DIGITS = 8
"""Hexadecimal digits: two languages of a team have the same code once in four thousand million."""


def short_code(sha256: str) -> str:
    """Return the code of a language file's checksum, such as ``7F3A-91C2``.

    Parameters
    ----------
    sha256
        The `sha256` of the file, in hexadecimal.

    """
    digits = sha256[:DIGITS].upper()
    return f"{digits[: DIGITS // 2]}-{digits[DIGITS // 2 :]}"
