"""What the gestures of a language file mean, read without OSG Studio."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from osg_ros.commands.dialogue import CommandTable


def command_text(command: str | dict[str, Any] | None) -> str:
    """Return a gesture's command as one text: its words, or its object as JSON; empty: none."""
    if isinstance(command, dict):
        return json.dumps(command, ensure_ascii=False, separators=(",", ":"))
    return command or ""


def read_commands(path: str) -> CommandTable:
    """Return the commands of a language file.

    Parameters
    ----------
    path
        Of a file that OSG Studio exported. The recogniser checks it; here only its seal, its
        labels, its commands and what its phrases use are read.

    Raises
    ------
    ValueError
        When it is no such file.
    OSError
        When it cannot be read.

    """
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8"))
        gestures = [(str(each["label"]), each.get("command")) for each in content["gestures"]]
        language_id = str(content["sha256"])
        used = frozenset(_phrase_labels(content.get("grammar") or {}))
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise ValueError(
            f"{path} is no language file with a seal ({error!r}); export it from the studio again"
        ) from error
    commands = {label: command_text(command) for label, command in gestures}
    given = {label: text for label, text in commands.items() if text}
    return CommandTable(language_id, given, used)


def _phrase_labels(grammar: dict[str, Any]) -> Iterator[str]:
    """Give every label that a grammar names; none where it has no phrases."""
    if not grammar.get("phrases"):
        return
    yield from (str(grammar[role]) for role in ("start", "end", "cancel") if grammar.get(role))
    for slot_type in grammar.get("slot_types", ()):
        yield from (str(each["gesture"]) for each in slot_type["values"])
    parts = [part for phrase in grammar["phrases"] for part in phrase["parts"]]
    members = [member for part in parts for member in part.get("parts", (part,))]
    yield from (str(label) for member in members for label in member.get("gestures", ()))
