"""What a robot needs to understand a language: landmarks to follow, and models to find them."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import get_args

from app.recognition.errors import LandmarkError
from app.recognition.features.motion import find_followed_landmarks, list_limbs
from app.recognition.language.language import Language
from app.recognition.models import ModelName
from app.recognition.poses.landmarks import HIPS, SHOULDERS


@dataclass(frozen=True)
class Requirements:
    """What recognising a language takes.

    Attributes
    ----------
    salient
        Landmarks that carry a gesture, in alphabetical order: without one of them the gestures
        that follow it are never recognised.
    limbs
        Landmarks that make recognition surer where they are seen: the arms those belong to.
    torso
        Landmarks that distance and drift are taken out by; without them the recording's own
        extent is the unit.
    models
        Names of the models that find them, see ``osg-studio models``.

    """

    salient: tuple[str, ...]
    limbs: tuple[str, ...]
    torso: tuple[str, ...]
    models: tuple[str, ...]


def find_requirements(language: Language) -> Requirements:
    """Tell what recognising a language takes."""
    salient = find_followed_landmarks([gesture.salient for gesture in language.gestures])
    known = {
        name
        for gesture in language.gestures
        if gesture.trajectory is not None
        for name in gesture.trajectory.landmarks
    }
    torso = (*SHOULDERS, *HIPS)
    ends = {end for limb in list_limbs(salient) for end in limb}
    limbs = tuple(sorted((ends & known) - {*salient, *torso}))
    return Requirements(salient, limbs, torso, get_args(ModelName))


def require_landmarks(language: Language, landmarks: Collection[str], source: str) -> None:
    """Refuse a source of poses that lacks what a language's gestures follow.

    Parameters
    ----------
    language
        The language to recognise.
    landmarks
        Names of the landmarks that the source gives, seen or not.
    source
        What it is called, for the message.

    Raises
    ------
    LandmarkError
        Naming the first landmark that is missing, the gesture that follows it, and what to do.

    """
    for gesture in language.gestures:
        for name in gesture.salient:
            if name not in landmarks:
                raise LandmarkError(
                    f"{source} gives no landmark {name!r}, which {gesture.label!r} of "
                    f"{language.name!r} follows; it gives {', '.join(landmarks)}. Use another "
                    f"source, or define the gesture by landmarks that this one has",
                    name,
                )
