"""Containerfile: its stages and their instructions, as a builder reads them."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path


@dataclass
class Stage:
    """One stage of a recipe.

    Attributes
    ----------
    name
        Of the stage.
    base
        Image or stage that it begins with.
    instructions
        Name and arguments of each instruction, in order.

    """

    name: str
    base: str
    instructions: list[tuple[str, str]] = field(default_factory=list)

    def values(self, name: str) -> list[str]:
        """Return the arguments of the instructions of a name."""
        return [arguments for each, arguments in self.instructions if each == name]


def read_stages(path: Path) -> dict[str, Stage]:
    """Read the stages of a recipe, by name."""
    stages: dict[str, Stage] = {}
    current = None
    for name, arguments in _list_instructions(path.read_text(encoding="utf-8")):
        if name == "FROM":
            base, _, stage = arguments.partition(" AS ")
            current = stages[stage] = Stage(stage, base)
        elif current is not None:
            current.instructions.append((name, arguments))
    return stages


def lineage(stages: dict[str, Stage], name: str) -> list[Stage]:
    """Return a stage and those that it begins with, the first one last."""
    stage = stages[name]
    return [stage, *(lineage(stages, stage.base) if stage.base in stages else ())]


def read_labels(stage: Stage, arguments: Mapping[str, str]) -> dict[str, str]:
    """Return the labels of a stage that is built with these arguments."""
    labels = {}
    for line in stage.values("LABEL"):
        key, _, value = line.partition("=")
        text = value[1:-1]
        if value[0] == '"':  # Docker replaces nothing between single quotes
            text = text.replace('\\"', '"')
            for name, given in arguments.items():
                text = text.replace(f"${{{name}}}", given)
        labels[key] = text
    return labels


def read_command(stages: list[Stage]) -> list[str]:
    """Return the command of the nearest stage that has one."""
    given = next(values[-1] for stage in stages if (values := stage.values("CMD")))
    words: list[str] = json.loads(given)
    return words


def _list_instructions(text: str) -> Iterator[tuple[str, str]]:
    lines = [line for line in text.splitlines() if not line.lstrip().startswith("#")]
    for line in re.sub(r"\\\n", "", "\n".join(lines)).splitlines():
        if line.strip():
            name, _, arguments = line.strip().partition(" ")
            yield name, arguments.strip()
