"""Message types of packages that a robot may have or not."""

from __future__ import annotations

from importlib import import_module
from typing import Any


def message_type(package: str, name: str) -> Any | None:
    """Return a message type.

    Parameters
    ----------
    package
        Such as ``vision_msgs``.
    name
        Such as ``Classification``.

    Returns
    -------
    The type, or None where the package is not there or is too old to have it.

    """
    try:
        return getattr(import_module(f"{package}.msg"), name, None)
    except ImportError:
        return None
