"""Language file: strict reading, deterministic writing, the seal, and the entries of gestures."""

from __future__ import annotations

import base64
import binascii
import hashlib
import json
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from app.recognition.errors import LanguageError, point_to
from app.recognition.features.contour import BinaryImage
from app.recognition.features.png import decode_png, encode_png
from app.recognition.features.trajectory_image import SIZE
from app.recognition.gestures.demonstration import Demonstration, check_diver
from app.recognition.gestures.gesture import Gesture, check_command, check_label
from app.recognition.gestures.switches import AUTOMATIC, Switches
from app.recognition.language.file_schema import (
    FORMAT,
    MAX_FILE_BYTES,
    MAX_GESTURES,
    VERSION,
    DemonstrationEntry,
    GestureEntry,
    HandEntry,
    LanguageDocument,
    PathEntry,
    RatesEntry,
    TrajectoryEntry,
)
from app.recognition.poses.frame import HandShape
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.text.strict_json import (
    MAX_FAULTS,
    Fault,
    StrictJSONError,
    build_pointer,
    canonical_json,
    read_json,
)
from app.recognition.voters.registry import PAPER_VOTERS

HANDS = ("hands", "then_hands", "moving_hands")
"""Keys of a trajectory that hold shapes of hands."""


_LISTED = frozenset({"gestures", "phrases", "slot_types"})
"""Keys whose entries are written one per line."""


def write_document(document: LanguageDocument) -> str:
    """Return the text of a document with its seal, one line per key, gesture and phrase.

    The lines keep diffs between revisions readable.
    """
    content = document.model_dump(mode="json", exclude={"sha256"}, exclude_defaults=True)
    content["sha256"] = seal(content)
    lines = ",\n".join(f"{_compact(key)}: {_value(key, value)}" for key, value in content.items())
    return f"{{\n{lines}\n}}\n"


def read_content(path: str | Path) -> bytes:
    """Read a file up to one byte more than the largest language file.

    Raises
    ------
    LanguageError
        When it cannot be read.

    """
    try:
        with Path(path).open("rb") as file:
            # One byte more than allowed is enough to detect a file that is too large.
            return file.read(MAX_FILE_BYTES + 1)
    except OSError as error:
        raise LanguageError(f"cannot read {path}: {error.strerror}") from error


@contextmanager
def name_file(path: str | Path) -> Iterator[None]:
    """Put the file's name before the message of a `LanguageError`; its pointer stays."""
    try:
        yield
    except LanguageError as error:
        named = LanguageError(f"{Path(path).name}: {error}")
        named.pointer = error.pointer
        raise named from error


def read_document(text: str | bytes) -> LanguageDocument:
    """Read a language file's text and validate it against the schema.

    Raises
    ------
    LanguageError
        When it is no language file of this version, violates the schema, or does not match its
        seal.

    """
    content = text.encode("utf-8", "surrogatepass") if isinstance(text, str) else text
    try:
        read = read_json(content, MAX_FILE_BYTES)
    except StrictJSONError as error:
        raise _language_error(error.faults) from error
    _check_kind(read)
    try:
        document = LanguageDocument.model_validate(read)
    except ValidationError as error:
        raise _language_error(_faults(error)) from error
    if document.sha256 is not None and document.sha256 != seal(read):
        raise LanguageError(
            "the content does not match this seal: the file was damaged, or edited by hand. If "
            'the edit was meant, remove the line "sha256" and save again with osg-studio convert',
            "/sha256",
        )
    return document


def seal(content: dict[str, Any]) -> str:
    """Return the SHA-256 of the canonical JSON of everything but ``sha256``, in hexadecimal."""
    sealed = {key: value for key, value in content.items() if key != "sha256"}
    return hashlib.sha256(canonical_json(sealed).encode("utf-8")).hexdigest()


def _check_kind(read: Any) -> None:
    """Refuse other files and versions with one clear message, before validating the schema."""
    if not isinstance(read, dict) or read.get("format") != FORMAT:
        raise LanguageError(
            f'not a language file: its "format" must be "{FORMAT}". A file of the published '
            "implementation can be brought in with osg-studio convert",
            "/format" if isinstance(read, dict) else "",
        )
    version = read.get("version")
    if isinstance(version, bool):  # which Python takes for 0 or 1
        raise LanguageError(f"must be a number, got {version}", "/version")
    if isinstance(version, int) and version > VERSION:
        raise LanguageError(
            f"version {version} is newer than this program reads ({VERSION}): update osg-studio",
            "/version",
        )
    gestures = read.get("gestures")
    if isinstance(gestures, list) and len(gestures) > MAX_GESTURES:
        raise LanguageError(f"{len(gestures)} gestures, the limit is {MAX_GESTURES}", "/gestures")


def _faults(error: ValidationError) -> list[Fault]:
    return [
        Fault(build_pointer(*list_document_steps(fault["loc"])), fault["msg"])
        for fault in error.errors(include_url=False, include_context=False, include_input=False)
    ]


def list_document_steps(location: tuple[int | str, ...]) -> tuple[int | str, ...]:
    """Return the place of a pydantic error in the document, without the branches of unions."""
    branches = {
        *("constrained-str", "str", "int", "float", "dict[str,any]", "constrained-float"),
        *("gestures-part", "slot-part", "group-part"),
    }
    return tuple(step for step in location if step not in branches)


def _language_error(faults: list[Fault]) -> LanguageError:
    """Return one error for several faults, with the first pointer and all messages in one line."""
    first, *others = faults[:MAX_FAULTS]
    message = first.message + "".join(f"; {fault.pointer}: {fault.message}" for fault in others)
    if len(faults) > MAX_FAULTS:
        message += f"; and {len(faults) - MAX_FAULTS} more"
    return LanguageError(message, first.pointer)


def _value(key: str, value: Any) -> str:
    if key in _LISTED and value:
        return "[\n" + ",\n".join(_compact(entry) for entry in value) + "\n]"
    if key == "grammar":
        members = (f"{_compact(name)}: {_value(name, each)}" for name, each in value.items())
        return "{\n" + ",\n".join(members) + "\n}"
    return _compact(value)


def _compact(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False, allow_nan=False, separators=(",", ":"))


DIGITS = 8
"""Hexadecimal digits: two languages of a team have the same code once in four thousand million."""


def short_code(sha256: str) -> str:
    """Return the code of a language file's checksum, such as ``7F3A-91C2``.

    Parameters
    ----------
    sha256
        The `sha256` of the file, in hexadecimal.

    """
    digits = sha256[:DIGITS].upper()
    return f"{digits[: DIGITS // 2]}-{digits[DIGITS // 2 :]}"


def gesture_to_entry(gesture: Gesture) -> GestureEntry:
    """Return the file's entry of a gesture."""
    return GestureEntry(
        label=gesture.label,
        description=gesture.description,
        command=gesture.command,
        thresholds=dict(gesture.thresholds),
        rates=None if gesture.rates is None else RatesEntry(**gesture.rates),
        demonstrations=[DemonstrationEntry(**_list_shown(each)) for each in gesture.further],
        **vars(gesture.switches),
        **_list_shown(gesture),
    )


def entry_to_gesture(entry: GestureEntry, pointer: str) -> Gesture:
    """Return the gesture of a file's entry.

    Parameters
    ----------
    entry
        The entry in the file.
    pointer
        JSON pointer to it, for errors.

    Raises
    ------
    LanguageError
        When its parts are inconsistent.

    """
    shown = _read_shown(entry, pointer)
    with point_to(pointer + "/label"):
        check_label(entry.label)
    with point_to(pointer + "/command"):
        check_command(entry.command)
    return Gesture(
        label=entry.label,
        thresholds=entry.thresholds,
        rates=None if entry.rates is None else entry.rates.model_dump(),
        description=entry.description,
        command=entry.command,
        switches=Switches(**{name: getattr(entry, name) for name in vars(AUTOMATIC)}),
        further=tuple(
            _demonstration(each, pointer + build_pointer("demonstrations", index))
            for index, each in enumerate(entry.demonstrations)
        ),
        **shown,
    )


def _demonstration(entry: DemonstrationEntry, pointer: str) -> Demonstration:
    shown = Demonstration(**_read_shown(entry, pointer))
    if not shown.salient and not shown.is_held:
        raise LanguageError("no salient landmark and no held hand", pointer + "/salient")
    return shown


def _list_shown(shown: Gesture | Demonstration) -> dict[str, Any]:
    """Return the keys of a demonstration, which a gesture has for its first."""
    return {
        "salient": list(shown.salient),
        "trajectory": None if shown.trajectory is None else _trajectory_entry(shown.trajectory),
        "image": base64.b64encode(encode_png(shown.image)).decode("ascii"),
        "descriptors": {name: values.tolist() for name, values in shown.descriptors.items()},
        "diver": shown.diver,
    }


def _read_shown(entry: GestureEntry | DemonstrationEntry, pointer: str) -> dict[str, Any]:
    """Return the fields of a demonstration, which a gesture has for its first."""
    image, trajectory = _image(entry.image, pointer + "/image"), None
    if entry.trajectory is not None:
        trajectory = _trajectory(entry.trajectory, pointer + "/trajectory")
    _check_salient(entry.salient, trajectory, pointer)
    with point_to(pointer + "/diver"):
        diver = check_diver(entry.diver)
    return {
        "salient": tuple(entry.salient),
        "trajectory": trajectory,
        "image": image,
        "descriptors": _descriptors(entry, image, pointer),
        "diver": diver,
    }


def _trajectory_entry(trajectory: Trajectory) -> TrajectoryEntry:
    depth = trajectory.depth
    return TrajectoryEntry(
        unit=trajectory.unit,
        axes="x right, y down",
        time=trajectory.time.tolist(),
        paths=[
            PathEntry(
                landmark=name,
                x=_without_nan(trajectory.xy[:, index, 0]),
                y=_without_nan(trajectory.xy[:, index, 1]),
                z=None if depth is None else _without_nan(depth[:, index]),
            )
            for index, name in enumerate(trajectory.landmarks)
        ],
        **{name: [_hand_entry(hand) for hand in getattr(trajectory, name)] for name in HANDS},
    )


def _hand_entry(hand: HandShape) -> HandEntry:
    return HandEntry(side=hand.side, x=hand.xy[:, 0].tolist(), y=hand.xy[:, 1].tolist())


def _without_nan(values: FloatArray) -> list[float | None]:
    return [None if np.isnan(value) else float(value) for value in values]


def _trajectory(entry: TrajectoryEntry, pointer: str) -> Trajectory:
    count = len(entry.time)
    for index, (before, after) in enumerate(pairwise(entry.time)):
        if after <= before:
            raise LanguageError(
                f"time does not increase: {before:g} s, then {after:g} s",
                pointer + build_pointer("time", index + 1),
            )
    names = [path.landmark for path in entry.paths]
    for index, path in enumerate(entry.paths):
        at = pointer + build_pointer("paths", index)
        if path.landmark in names[:index]:
            raise LanguageError(f"a second path of {path.landmark!r}", at + "/landmark")
        for axis, values in (("x", path.x), ("y", path.y), ("z", path.z)):
            if values is not None and len(values) != count:
                raise LanguageError(
                    f"{len(values)} values, but time has {count} moments", at + build_pointer(axis)
                )
    columns = [[path.x, path.y] for path in entry.paths]
    depths = [[None] * count if path.z is None else path.z for path in entry.paths]
    has_depth = any(path.z is not None for path in entry.paths)
    trajectory = Trajectory(
        landmarks=tuple(names),
        xy=np.array(columns, dtype=np.float64).transpose(2, 0, 1),
        time=np.array(entry.time),
        unit=entry.unit,
        depth=np.array(depths, dtype=np.float64).T if has_depth else None,
        **{name: _hands(getattr(entry, name), f"{pointer}/{name}") for name in HANDS},
    )
    _check_sequence(trajectory, pointer + "/then_hands")
    return trajectory


def _check_sequence(trajectory: Trajectory, pointer: str) -> None:
    """Check that the same hands hold both shapes of a sequence."""
    if not trajectory.then_hands:
        return
    if not trajectory.hands:
        raise LanguageError("without a first hand shape there is no second", pointer)
    first, second = ({hand.side for hand in hands} for hands in trajectory.held_shapes)
    if first != second:
        raise LanguageError("the second shape is held by other hands than the first", pointer)


def _hands(entries: list[HandEntry], pointer: str) -> tuple[HandShape, ...]:
    if len({entry.side for entry in entries}) < len(entries):
        raise LanguageError(f"two {entries[0].side} hands", pointer + build_pointer(1, "side"))
    hands = []
    for index, entry in enumerate(entries):
        with point_to(pointer + build_pointer(index)):
            hands.append(HandShape(entry.side, np.column_stack([entry.x, entry.y])))
    return tuple(hands)


def _check_salient(salient: list[str], trajectory: Trajectory | None, pointer: str) -> None:
    for index, name in enumerate(salient):
        if trajectory is not None and name not in trajectory.landmarks:
            raise LanguageError(
                f"salient landmark {name!r} has no path in the trajectory",
                pointer + build_pointer("salient", index),
            )
    if salient and trajectory is not None and trajectory.hands:
        raise LanguageError(
            "a held hand shape has no salient landmarks, a movement no held hands",
            pointer + "/salient",
        )
    if not salient and trajectory is not None and trajectory.moving_hands:
        raise LanguageError(
            "without salient landmarks no hand moves",
            pointer + build_pointer("trajectory", "moving_hands"),
        )
    if len(set(salient)) < len(salient):
        raise LanguageError("a landmark occurs twice", pointer + "/salient")


def _image(text: str, pointer: str) -> BinaryImage:
    try:
        return decode_png(base64.b64decode(text, validate=True), (SIZE, SIZE))
    except (binascii.Error, ValueError) as error:
        raise LanguageError(f"not a PNG in base64: {error}", pointer) from error


def _descriptors(
    entry: GestureEntry | DemonstrationEntry, image: BinaryImage, pointer: str
) -> dict[str, FloatArray]:
    """Check the lengths of known voters' descriptors; others are kept unchanged."""
    lengths = {voter.name: voter.length(len(entry.salient)) for voter in PAPER_VOTERS}
    for name, values in entry.descriptors.items():
        if len(values) != lengths.get(name, len(values)):
            raise LanguageError(
                f"{len(values)} values, expected {lengths[name]}",
                pointer + build_pointer("descriptors", name),
            )
    if not image.any():
        return {}
    return {name: np.array(values) for name, values in entry.descriptors.items()}
