"""Route of the pair difference: two gestures of a language side by side."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

import numpy as np
from fastapi import APIRouter, Query

from app.api.http.problems import problem_responses
from app.api.http.schemas.values import Label, View
from app.api.routes.asked_revisions import CurrentRevision
from app.api.services.gesture_edits import gesture_in
from app.api.services.running_studio import computed
from app.recognition.explanation.alignment import Alignment, PairDifference, compare_pair
from app.recognition.gestures.gesture import Gesture

DIGITS = 3
"""Decimals of places and seconds: a millisecond, and half a millimetre of a diver."""

Place = tuple[float, float] | None
"""Torso lengths from the torso's centre, x right and y down; null where not seen."""


class PathsView(View):
    """A gesture's demonstration, as it is drawn."""

    label: str
    salient: list[str]
    time: list[float]
    """Seconds of each moment."""
    paths: dict[str, list[Place]]
    """Per landmark its place at each moment, torso lengths from the torso's centre."""


class ContrastView(View):
    """Two gestures of a language, and in what they differ."""

    gestures: tuple[PathsView, PathsView]
    differs: tuple[str | None, str | None]
    """In what the first differs from the second, and the second from the first; null where they
    cannot be compared."""
    alignment: Alignment | None
    """Which moment of the first corresponds to which of the second."""


router = APIRouter(prefix="/languages", tags=["languages"])


@router.get("/{language_id}/contrast", responses=problem_responses(404))
@computed
def contrast_gestures(
    asked: CurrentRevision,
    advance: Callable[[], None],
    one: Annotated[Label, Query(description="A gesture's label")],
    other: Annotated[Label, Query(description="Another one's")],
) -> ContrastView:
    """Return in what two gestures differ, and which of their moments correspond."""
    recognizer = asked.studio.recognizer(asked.state, "full")
    language = recognizer.language
    for label in (one, other):
        gesture_in(language, label)
    first, second = language.labels.index(one), language.labels.index(other)
    advance()
    forth = compare_pair(recognizer, first, second)
    advance()
    back = compare_pair(recognizer, second, first)
    return ContrastView(
        gestures=(_paths(language.gestures[first]), _paths(language.gestures[second])),
        differs=(_words(forth), _words(back)),
        alignment=None if forth is None else forth.alignment,
    )


def _words(found: PairDifference | None) -> str | None:
    return None if found is None else found.words


def _paths(gesture: Gesture) -> PathsView:
    shown = gesture.trajectory
    paths: dict[str, list[Place]] = {}
    time: list[float] = []
    if shown is not None:
        time = np.round(shown.time - shown.time[0], DIGITS).tolist()
        for landmark, places in zip(shown.landmarks, np.moveaxis(shown.xy, 1, 0), strict=True):
            paths[landmark] = [
                (x, y) if np.isfinite((x, y)).all() else None
                for x, y in np.round(places, DIGITS).tolist()
            ]
    return PathsView(label=gesture.label, salient=list(gesture.salient), time=time, paths=paths)
