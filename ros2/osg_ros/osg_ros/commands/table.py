"""Command table: reads the commands of a language file without OSG Studio."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from osg_ros.commands.dialogue import CommandTable


def format_command(command: str | dict[str, Any] | None) -> str:
    """Return a gesture's command as text, an object as JSON; empty where there is none."""
    if isinstance(command, dict):
        return json.dumps(command, ensure_ascii=False, separators=(",", ":"))
    return command or ""


def read_commands(path: str) -> CommandTable:
    """Read the commands of a language file.

    Parameters
    ----------
    path
        File that OSG Studio exported. The recogniser validates it; this function reads only the
        checksum, the labels, the commands and the labels that phrases use.

    Raises
    ------
    ValueError
        When the file is not a language file.
    OSError
        When the file cannot be read.

    """
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8"))
        gestures = [(str(each["label"]), each.get("command")) for each in content["gestures"]]
        language_id = str(content["sha256"])
        used = frozenset(_phrase_labels(content.get("grammar") or {}))
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise ValueError(
            f"{path} is not a language file with a checksum ({error!r}); export it from the studio "
            "again"
        ) from error
    commands = {label: format_command(command) for label, command in gestures}
    given = {label: text for label, text in commands.items() if text}
    return CommandTable(language_id, given, used)


def _phrase_labels(grammar: dict[str, Any]) -> Iterator[str]:
    """Yield every label in a grammar; nothing where it has no phrases."""
    if not grammar.get("phrases"):
        return
    yield from (str(grammar[role]) for role in ("start", "end", "cancel") if grammar.get(role))
    for slot_type in grammar.get("slot_types", ()):
        yield from (str(each["gesture"]) for each in slot_type["values"])
    parts = [part for phrase in grammar["phrases"] for part in phrase["parts"]]
    members = [member for part in parts for member in part.get("parts", (part,))]
    yield from (str(label) for member in members for label in member.get("gestures", ()))
