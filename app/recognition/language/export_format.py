"""Formats of language files: those that can be written, and the reader of the published one.

**osg-reference** (`to_reference`, `from_reference`): the published implementation's files
(IRVLab/One-Shot-Gesture-Recognition, 2025). One JSON object: per label
``{"image": 224 lists of 224 integers, "salient_keypoints": upper-case MediaPipe names}``. It has no
trajectory, author, units or versions, so reading one is lossy.

**PROTEUS** (`to_proteus`): language definition files (``.ldf``; Fulton, Edge and Sattar,
IRVLab/proteus). By that package's files and reader: an XML element ``language`` with ``meta``
(name, robot, description, directory, read by their order), then ``input`` and ``output``, each with
symbols, vectors and actions, then ``state``, ``context`` and ``actions``. A symbol has the
attributes name, id, call_type (trigger, directional or quantity), description and tags, separated
by commas. In all published files ``input`` is empty, and the reader skips it. Input symbols are
therefore assumed to have the form of output symbols, which are of the same class there. The format
cannot hold demonstrations, phrases and commands.
"""

from __future__ import annotations

import json
import re
import unicodedata
from collections.abc import Collection
from enum import Enum
from typing import Any, Literal
from xml.etree import ElementTree

import numpy as np
import numpy.typing as npt

from app.recognition.errors import LanguageError, point_to
from app.recognition.features.contour import BinaryImage
from app.recognition.features.trajectory_image import SIZE
from app.recognition.gestures.gesture import Gesture
from app.recognition.language.file_schema import MAX_GESTURES
from app.recognition.language.language import Language
from app.recognition.phrases.grammar import FRAME
from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.recognition.text.strict_json import StrictJSONError, build_pointer, read_json

MAX_FILE_BYTES = 100_000_000
"""Over a hundred gestures: the published files take 850 kB each, the largest a few megabytes."""

BACKGROUND_TOLERANCE = 25
"""Grey levels by which strokes differ from the background: a tenth of the range, as in the
published code, so that the soft edges of strokes are background."""


def is_reference(content: bytes) -> bool:
    """Return whether a file is the published implementation's, without parsing it."""
    return b'"salient_keypoints"' in content and b'"osg-studio/' not in content


def to_reference(language: Language) -> str:
    """Return a language as the published implementation's file.

    Raises
    ------
    LanguageError
        When a salient landmark is not one of MediaPipe's, the only ones it supports.

    """
    # Written gesture by gesture: a thousand images as lists of numbers take half a gigabyte.
    entries = []
    for index, gesture in enumerate(language.gestures):
        for name in gesture.salient:
            if name not in POSE_LANDMARKS:
                raise LanguageError(
                    f"gesture {gesture.label!r} uses the keypoint {name!r}, and osg-reference "
                    f"files support MediaPipe's only: keep this language as osg-studio",
                    build_pointer("gestures", index, "salient"),
                )
        content = {
            "image": gesture.image.tolist(),
            "salient_keypoints": [name.upper() for name in gesture.salient],
        }
        entry = json.dumps({gesture.label: content}, ensure_ascii=False, separators=(",", ":"))
        entries.append(entry[1:-1])
    return f"{{{','.join(entries)}}}\n"


def from_reference(text: str | bytes, name: str) -> Language:
    """Read a language of the published implementation.

    The background is the commonest colour on the border, so that white or coloured strokes on
    black are read as well as the older red on white. Gestures have no trajectory. One without a
    salient keypoint or stroke is kept and matches nothing.

    Parameters
    ----------
    text
        The file's text.
    name
        The language's name, which the file does not have.

    Raises
    ------
    LanguageError
        When the file is not as described; names the JSON pointer.

    """
    content = text.encode("utf-8", "surrogatepass") if isinstance(text, str) else text
    try:
        read = read_json(content, MAX_FILE_BYTES)
    except StrictJSONError as error:
        raise LanguageError(error.faults[0].message, error.faults[0].pointer) from error
    if not isinstance(read, dict):
        raise LanguageError("not an osg-reference file: it must be an object, one key a label")
    if len(read) > MAX_GESTURES:
        raise LanguageError(f"{len(read)} gestures, the limit is {MAX_GESTURES}")
    return Language(name, [_gesture(label, entry) for label, entry in read.items()])


def _gesture(label: str, entry: Any) -> Gesture:
    pointer = build_pointer(label)
    if not isinstance(entry, dict) or not {"image", "salient_keypoints"} <= set(entry):
        raise LanguageError('must be an object with "image" and "salient_keypoints"', pointer)
    salient = _salient(entry["salient_keypoints"], pointer + "/salient_keypoints")
    image = _image(entry["image"], pointer + "/image")
    with point_to(pointer):
        return Gesture(label=label, salient=salient, image=image).redraw()


def _salient(names: Any, pointer: str) -> tuple[str, ...]:
    if not isinstance(names, list):
        raise LanguageError("must be a list of MediaPipe's landmark names", pointer)
    for index, name in enumerate(names):
        if not isinstance(name, str) or name.lower() not in POSE_LANDMARKS:
            raise LanguageError(
                f"{name!r} is not one of MediaPipe's landmarks", pointer + build_pointer(index)
            )
        if name in names[:index]:
            raise LanguageError(f"{name!r} occurs twice", pointer + build_pointer(index))
    return tuple(name.lower() for name in names)


def _image(rows: Any, pointer: str) -> BinaryImage:
    try:
        pixels = np.array(rows)
    except ValueError as error:
        raise LanguageError("the rows of the image differ in length", pointer) from error
    if pixels.shape not in ((SIZE, SIZE), (SIZE, SIZE, 3)) or pixels.dtype.kind not in "iu":
        raise LanguageError(
            f"must be {SIZE} x {SIZE} or {SIZE} x {SIZE} x 3 integers, got shape {pixels.shape} "
            f"of {pixels.dtype}",
            pointer,
        )
    if pixels.min() < 0 or pixels.max() > 255:
        raise LanguageError("holds values outside 0 to 255", pointer)
    return _strokes(pixels.reshape(SIZE, SIZE, -1))


def _strokes(pixels: npt.NDArray[np.int64]) -> BinaryImage:
    """Return 255 where ``(224, 224, channels)`` differ from the background."""
    border = np.concatenate([pixels[0], pixels[-1], pixels[:, 0], pixels[:, -1]])
    colours, counts = np.unique(border, axis=0, return_counts=True)
    difference = np.abs(pixels - colours[counts.argmax()]).max(axis=2)
    return np.where(difference > BACKGROUND_TOLERANCE, 255, 0).astype(np.uint8)


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
