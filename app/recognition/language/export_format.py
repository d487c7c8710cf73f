"""Formats of language files that can be written.

PROTEUS export: language definition files (``.ldf``; Fulton, Edge and Sattar, IRVLab/proteus).

By that package's files and reader: an XML element ``language`` with ``meta`` (name, robot,
description, directory, read by their order), then ``input`` and ``output``, each with symbols,
vectors and actions, then ``state``, ``context`` and ``actions``. A symbol has the attributes name,
id, call_type (trigger, directional or quantity), description and tags, separated by commas. In all
published files ``input`` is empty, and the reader skips it.

Input symbols are therefore assumed to have the form of output symbols, which are of the same class
there. The format cannot hold demonstrations, phrases and commands.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Collection
from enum import Enum
from typing import Literal
from xml.etree import ElementTree

from app.recognition.gestures.gesture import Gesture
from app.recognition.language.language import Language
from app.recognition.language.osg_reference import to_reference
from app.recognition.phrases.grammar import FRAME

SUFFIX = ".ldf"

CallType = Literal["trigger", "directional", "quantity"]

_DIRECTION = re.compile(r"\b(direction|heading|bearing|way|side)s?\b", re.IGNORECASE)
"""Names of slot types that are directions."""


def to_proteus(language: Language, robot: str = "") -> str:
    """Return a language's gestures as the input symbols of a PROTEUS language.

    Parameters
    ----------
    language
        The language.
    robot
        Name of its robot; empty: none.

    """
    root = ElementTree.Element("language")
    meta = ElementTree.SubElement(root, "meta")
    description = f"Arm gestures, revision {language.revision}" + (
        f", by {language.author}" if language.author else ""
    )
    # PROTEUS reads these four by their order.
    for tag, text in (
        ("name", language.name),
        ("robot", robot or "any"),
        ("description", description),
        ("directory", "."),
    ):
        ElementTree.SubElement(meta, tag).text = text
    for side in ("input", "output"):
        part = ElementTree.SubElement(root, side)
        symbols = ElementTree.SubElement(part, "symbols")
        if side == "input":
            _add_symbols(symbols, language)
        ElementTree.SubElement(part, "vectors")
        ElementTree.SubElement(part, "actions")
    for tag in ("state", "context", "actions"):
        ElementTree.SubElement(root, tag)
    ElementTree.indent(root, "    ")
    text = ElementTree.tostring(root, encoding="unicode", short_empty_elements=False)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'


def find_call_type(language: Language, label: str) -> CallType:
    """Return the kind of a gesture: ``quantity`` (a number), ``directional``, or ``trigger``."""
    slot_types = () if language.grammar is None else language.grammar.slot_types
    for slot_type in slot_types:
        if label in slot_type.values:
            if slot_type.reads_as != "text":
                return "quantity"
            if _DIRECTION.search(slot_type.name):
                return "directional"
    return "trigger"


def _add_symbols(symbols: ElementTree.Element, language: Language) -> None:
    taken: set[str] = set()
    for gesture in language.gestures:
        symbol_id = _identifier(gesture.label, taken)
        taken.add(symbol_id)
        ElementTree.SubElement(
            symbols,
            "symbol",
            {
                "name": gesture.label,
                "id": symbol_id,
                "call_type": find_call_type(language, gesture.label),
                "description": _description(gesture),
                "tags": ",".join(_tags(language, gesture)),
            },
        )


def _identifier(label: str, taken: Collection[str]) -> str:
    """Return an id that is a valid ROS parameter name, as PROTEUS' server requires."""
    plain = unicodedata.normalize("NFKD", label).encode("ascii", "ignore").decode().lower()
    stem = re.sub(r"[^a-z0-9]+", "_", plain).strip("_") or "gesture"
    if not stem[0].isalpha():
        stem = f"gesture_{stem}"
    identifier, number = stem, 2
    while identifier in taken:
        identifier, number = f"{stem}_{number}", number + 1
    return identifier


def _description(gesture: Gesture) -> str:
    command = gesture.command if isinstance(gesture.command, str) else ""
    return "; ".join(text for text in (command, gesture.description) if text)


def _tags(language: Language, gesture: Gesture) -> list[str]:
    """Return the tags of the published files; start, end and cancel gestures get their own."""
    grammar = language.grammar
    tags = []
    if grammar is not None and gesture.label in {getattr(grammar, role) for role in FRAME}:
        tags += ["conversational", "control"]
    if gesture.command is not None:
        tags.append("commands")
    if find_call_type(language, gesture.label) != "trigger":
        tags.append("information")
    return tags or ["commands"]


class FileFormat(str, Enum):
    """The language files."""

    OSG_STUDIO = "osg-studio"
    """OSG Studio's own format: everything."""
    OSG_REFERENCE = "osg-reference"
    """The published implementation's: images and salient keypoints only."""
    PROTEUS = "proteus"
    """A PROTEUS language definition file: names and kinds of the gestures only."""

    @property
    def media_type(self) -> str:
        """Media type, such as application/json."""
        return "application/xml" if self is FileFormat.PROTEUS else "application/json"

    @property
    def suffix(self) -> str:
        """Ending of the name of a file of the format."""
        return SUFFIX if self is FileFormat.PROTEUS else ".json"

    def write(self, language: Language) -> str:
        """Return the content of a file of the format."""
        if self is FileFormat.OSG_REFERENCE:
            return to_reference(language)
        return to_proteus(language) if self is FileFormat.PROTEUS else language.to_json()
