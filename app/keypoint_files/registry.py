"""Registry of keypoint file formats: a new one is a module with a `KeypointFormat`, named here."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Final

from pydantic import AfterValidator

from app.keypoint_files.deeplabcut import DEEPLABCUT
from app.keypoint_files.keypoint_table import KeypointFormat
from app.keypoint_files.mediapipe_json import MEDIAPIPE_JSON
from app.keypoint_files.mediapipe_table import MEDIAPIPE_TABLE
from app.keypoint_files.openpose import OPENPOSE, is_openpose
from app.keypoint_files.pose_format import POSE_FORMAT
from app.keypoint_files.sleap import SLEAP
from app.recognition.errors import KeypointFileError
from app.recognition.recording.file_kinds import find_file_kind, read_head

FORMATS: Final = (DEEPLABCUT, MEDIAPIPE_TABLE, MEDIAPIPE_JSON, SLEAP, POSE_FORMAT)
"""Formats of single files. Of several with one ending the first that recognises a file reads it;
the last of them says what is wrong with a file that none recognises."""

FILE_ENDINGS: Final = tuple(dict.fromkeys(each for form in FORMATS for each in form.endings))

ENDINGS: Final = (*FILE_ENDINGS, *OPENPOSE.endings)
"""Endings of files, and of the archive that holds a folder of OpenPose."""


def require_ending(ending: str) -> str:
    """Return an ending if there is such a format; otherwise raise `ValueError`."""
    if ending not in ENDINGS:
        raise ValueError(f"Input should be one of {', '.join(ENDINGS)}")
    return ending


Ending = Annotated[str, AfterValidator(require_ending)]
"""Ending by which `app.keypoint_files.read_keypoints` chooses the format."""


def is_keypoint_file(path: Path) -> bool:
    """Return whether a file or folder is read as keypoints and not as a video."""
    return is_openpose(path) if path.is_dir() else path.suffix.lower() in FILE_ENDINGS


def find_format(path: Path) -> KeypointFormat:
    """Return a file's or folder's format.

    Raises
    ------
    KeypointFileError
        When there is no such file, or its ending is not that of a keypoint file.

    """
    if path.is_dir():
        return OPENPOSE
    if not path.is_file():
        raise KeypointFileError(f"{path} is not a file; give the path of a keypoint file")
    named = [each for each in FORMATS if path.suffix.lower() in each.endings]
    if not named:
        raise KeypointFileError(
            f"{path.name} is no keypoint file by its ending; there are: "
            f"{', '.join(FILE_ENDINGS)}, and folders of OpenPose"
        )
    head = read_head(path)
    if (kind := find_file_kind(head)) is not None:
        raise KeypointFileError(f"{path} is {kind.name} and no keypoint file; {kind.remedy}")
    return next((each for each in named if each.recognises(head, path.name)), named[-1])


def keypoint_ending(head: bytes, name: str) -> str | None:
    """Return the ending by which a file that begins with `head` is read; None without keypoints."""
    for each in (OPENPOSE, *FORMATS):
        if each.recognises(head, name):
            named = (ending for ending in each.endings if name.lower().endswith(ending))
            return next(named, each.endings[0])
    return None
