"""Gesture entries: gestures and their demonstrations to and from the language file."""

from __future__ import annotations

import base64
import binascii
from itertools import pairwise
from typing import Any

import numpy as np

from app.recognition.errors import LanguageError, point_to
from app.recognition.features.contour import BinaryImage
from app.recognition.features.png import decode_png, encode_png
from app.recognition.features.trajectory_image import SIZE
from app.recognition.gestures.demonstration import Demonstration, check_diver
from app.recognition.gestures.gesture import Gesture, check_command, check_label
from app.recognition.gestures.switches import AUTOMATIC, Switches
from app.recognition.language.file_schema import (
    DemonstrationEntry,
    GestureEntry,
    HandEntry,
    PathEntry,
    RatesEntry,
    TrajectoryEntry,
)
from app.recognition.poses.frame import HandShape
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.text.strict_json import build_pointer
from app.recognition.voters.registry import PAPER_VOTERS

HANDS = ("hands", "then_hands", "moving_hands")
"""Keys of a trajectory that hold shapes of hands."""


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
