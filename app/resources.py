"""Resources: finds the page's static files and the sample languages.

In a checkout they are folders beside the package; in a wheel they are inside it (mapped in
``pyproject.toml`` under ``tool.hatch.build.targets.wheel``).
"""

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent


def static_dir() -> Path:
    """Return the folder of the page's files: HTML, style sheets, scripts, icons."""
    return _installed_or_checked_out("static", "static")


def samples_dir() -> Path:
    """Return the folder of the sample languages (``*.json``) and of their clips (``clips/``)."""
    return _installed_or_checked_out("samples", "languages")


def known_signs_file() -> Path:
    """Return the language file of the signs that divers know; the health check looks for them."""
    return samples_dir() / "signs-of-divers.json"


def _installed_or_checked_out(in_wheel: str, in_checkout: str) -> Path:
    installed = _PACKAGE / in_wheel
    return installed if installed.is_dir() else _PACKAGE.parent / in_checkout
