"""What the gestures of a language file mean, read without OSG Studio."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from osg_ros.command_dialogue import CommandTable


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
        Of a file that OSG Studio exported. The recogniser checks it; here only its seal, its labels
        and its commands are read.

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
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise ValueError(
            f"{path} is no language file with a seal ({error!r}); export it from the studio again"
        ) from error
    commands = {label: command_text(command) for label, command in gestures}
    return CommandTable(language_id, {label: text for label, text in commands.items() if text})
