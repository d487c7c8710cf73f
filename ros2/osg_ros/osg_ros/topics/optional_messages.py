"""Optional messages: finds message types of packages that may not be installed."""

from __future__ import annotations

from importlib import import_module
from typing import Any


def find_message_type(package: str, name: str) -> Any | None:
    """Find a message type.

    Parameters
    ----------
    package
        Such as ``vision_msgs``.
    name
        Such as ``Classification``.

    Returns
    -------
    The type, or None where the package is not installed or too old to have it.

    """
    try:
        return getattr(import_module(f"{package}.msg"), name, None)
    except ImportError:
        return None
