"""MkDocs hook: fills the reference pages from the code, and publishes the JSON Schemas.

A page says ``<!-- generated: NAME -->`` where the output of `PARTS[NAME]` belongs. Since the text
is made at every build, it cannot differ from the program.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import Any

from command_page import command_line
from error_page import core_errors, problem_codes
from http_page import http
from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File, Files
from python_page import python
from schema_page import SCHEMAS, language_file, recognition_report, robot_events
from setting_page import settings

PARTS: Mapping[str, Callable[[], str]] = {
    "command line": command_line,
    "core errors": core_errors,
    "http": http,
    "language file": language_file,
    "problem codes": problem_codes,
    "python": python,
    "recognition report": recognition_report,
    "robot events": robot_events,
    "settings": settings,
}

MARK = re.compile(r"<!-- generated: (.+?) -->")


def on_files(files: Files, *, config: Any) -> Files:
    """Publish the JSON Schemas beside the pages that describe them."""
    for path in SCHEMAS.values():
        files.append(File.generated(config, f"reference/{path.name}", abs_src_path=str(path)))
    return files


def on_page_markdown(markdown: str, *, page: Any, **_: Any) -> str:
    """Replace every mark by what is generated for it."""

    def generate(mark: re.Match[str]) -> str:
        if mark[1] not in PARTS:
            raise PluginError(f"{page.file.src_uri}: nothing generates {mark[1]!r}")
        return PARTS[mark[1]]()

    return MARK.sub(generate, markdown)
