"""osg-reference: the published implementation's files (IRVLab/One-Shot-Gesture-Recognition, 2025).

One JSON object: per label ``{"image": 224 lists of 224 integers, "salient_keypoints": upper-case
MediaPipe names}``. It has no trajectory, author, units or versions, so reading one is lossy.
"""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import numpy.typing as npt

from app.recognition.errors import LanguageError, point_to
from app.recognition.features.contour import BinaryImage
from app.recognition.features.trajectory_image import SIZE
from app.recognition.gestures.gesture import Gesture
from app.recognition.language.file_schema import MAX_GESTURES
from app.recognition.language.language import Language
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
