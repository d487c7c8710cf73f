"""Requirements of a language: the landmarks it uses, and the models that find them."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import get_args

import numpy as np

from app.recognition.errors import LandmarkError
from app.recognition.features.motion import find_followed_landmarks, list_limbs
from app.recognition.language.language import Language
from app.recognition.models.storage import ModelName
from app.recognition.poses.landmarks import HIPS, SHOULDERS
from app.recognition.poses.sequence import PoseSequence


@dataclass(frozen=True)
class Requirements:
    """The requirements of recognising a language.

    Attributes
    ----------
    salient
        The gestures' salient landmarks, in alphabetical order: without one of them its gestures
        are never recognised.
    limbs
        Other landmarks of the same arms, which make recognition more certain where seen.
    torso
        Landmarks that normalise distance and drift; without them the unit is the extent of the
        movement.
    models
        Names of the models that find them, see ``osg-studio models``.

    """

    salient: tuple[str, ...]
    limbs: tuple[str, ...]
    torso: tuple[str, ...]
    models: tuple[str, ...]


def find_requirements(language: Language) -> Requirements:
    """Return the requirements of a language."""
    shown = [each for gesture in language.gestures for each in gesture.single_demonstrations()]
    salient = find_followed_landmarks([each.salient for each in shown])
    known = {
        name for each in shown if each.trajectory is not None for name in each.trajectory.landmarks
    }
    torso = (*SHOULDERS, *HIPS)
    ends = {end for limb in list_limbs(salient) for end in limb}
    limbs = tuple(sorted((ends & known) - {*salient, *torso}))
    return Requirements(salient, limbs, torso, get_args(ModelName))


def require_trigger(language: Language, landmarks: Collection[str], source: str) -> None:
    """Check that a source of poses has the landmarks by which a language's trigger is seen.

    Parameters and errors are those of `require_landmarks`. A salute needs hands instead.
    """
    for name in language.trigger.landmarks:
        if name not in landmarks:
            raise LandmarkError(
                f"{source} gives no landmark {name!r}, by which the trigger of {language.name!r} "
                f"is seen; it gives {', '.join(landmarks)}. Use another source, or choose another "
                "trigger",
                name,
            )


def require_seen_landmarks(language: Language, poses: PoseSequence, source: str) -> None:
    """Check that poses show the salient landmarks in some frame; otherwise `require_landmarks`."""
    seen = [poses.landmarks[row] for row in np.flatnonzero(poses.seen.any(axis=0))]
    require_landmarks(language, seen, source)


def require_landmarks(language: Language, landmarks: Collection[str], source: str) -> None:
    """Check that a source of poses has the salient landmarks of a demonstration of every gesture.

    Parameters
    ----------
    language
        The language to recognise.
    landmarks
        Names of the source's landmarks, seen or not.
    source
        Its name in the message.

    Raises
    ------
    LandmarkError
        With the first missing landmark, the gesture that uses it, and what to do.

    """
    for gesture in language.gestures:
        shown = gesture.single_demonstrations()
        if any(set(each.salient) <= set(landmarks) for each in shown):
            continue
        for name in gesture.salient:
            if name not in landmarks:
                raise LandmarkError(
                    f"{source} gives no landmark {name!r}, which {gesture.label!r} of "
                    f"{language.name!r} follows; it gives {', '.join(landmarks)}. Use another "
                    f"source, or define the gesture by landmarks that this one has",
                    name,
                )
