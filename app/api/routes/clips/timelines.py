"""Routes of a clip's timeline: thumbnails, salute confidence, wrist speed."""

from __future__ import annotations

import json

import numpy as np
from fastapi import APIRouter, Response

from app.api.http.downloads import JPEG, send_picture
from app.api.http.problems import file_responses, problem_responses
from app.api.http.schemas.values import SoFar, TriggerLanguage, View
from app.api.services.clip_responses import shows_pictures
from app.api.services.clip_takes import trigger_of
from app.api.services.running_studio import CurrentStudio, computed_briefly
from app.api.workers.pictures import thumbnails_in
from app.recognition import PoseError, Recording
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.recording.extraction import find_turn
from app.recognition.recording.segmentation import list_unseen
from app.recognition.recording.video import Turn

router = APIRouter(prefix="/clips", tags=["clips"])

WRISTS = ("left_wrist", "right_wrist")

TIME_DIGITS = 6
"""Decimals of a second: containers count in microseconds at the finest."""

CURVE_DIGITS = 3
"""Decimals of a curve's value: more than a curve forty pixels high can show."""


class TimelineView(View):
    """What lies along a clip's time, one value a frame."""

    time: list[float]
    """Seconds, by the container."""
    salute: list[float]
    """Score of the salute, or of the language's other trigger, 0 to 1."""
    speed: dict[str, list[float | None]]
    """Per wrist, torso lengths a second; null where it was not seen."""
    unseen: list[list[float]]
    """First and last second of each span in which a salute may have been missed: a hole, or a part
    of a take in which too little was seen."""
    unit: str
    """Of the speed's lengths: torso_length, or extent without a torso."""
    thumbnails: int
    """How many the filmstrip has."""
    turn: Turn
    """Degrees, clockwise, by which the picture must be turned for the diver to be upright."""


@router.get(
    "/{clip_id}/timeline", response_model=TimelineView, responses=problem_responses(404, 409)
)
@computed_briefly
def get_timeline(
    clip_id: str,
    studio: CurrentStudio,
    language_id: TriggerLanguage = None,
    so_far: SoFar = False,
) -> Response:
    """Return the curves along the clip, one value a frame."""
    recording = studio.recording(clip_id, so_far=so_far)
    trigger = trigger_of(studio, language_id)
    scores = np.maximum(*trigger.score(recording.poses, recording.salute))
    has_thumbnails = studio.clips.filmstrip(clip_id).is_file()
    speeds, unit = wrist_speeds(recording)
    content = {
        "time": np.round(recording.poses.time, TIME_DIGITS).tolist(),
        "salute": np.round(scores, CURVE_DIGITS).tolist(),
        "speed": {name: _with_nulls(speed) for name, speed in speeds.items()},
        "unseen": [[each.start, each.end] for each in list_unseen(recording, trigger)],
        "unit": unit,
        "thumbnails": thumbnails_in(len(recording.poses)) if has_thumbnails else 0,
        "turn": find_turn(recording.poses) if shows_pictures(studio.clips.get(clip_id).clip) else 0,
    }
    return Response(json.dumps(content, allow_nan=False), media_type="application/json")


@router.get(
    "/{clip_id}/filmstrip",
    response_class=Response,
    responses=file_responses("Thumbnails side by side", JPEG),
)
def get_filmstrip(clip_id: str, studio: CurrentStudio) -> Response:
    """Send the thumbnails along the clip, once its poses are found."""
    studio.clips.get(clip_id)
    missing = "there are no thumbnails of this clip yet"
    return send_picture(studio.clips.filmstrip(clip_id), "no_filmstrip", missing)


def wrist_speeds(recording: Recording) -> tuple[dict[str, FloatArray], str]:
    """Return each wrist's speed ``(T,)``, and the unit of its lengths.

    NaN where a wrist was not seen, and throughout if nobody is in view or the wrist is missing.
    """
    count = len(recording.poses)
    speeds = {name: np.full(count, np.nan) for name in WRISTS}
    try:
        trajectory = Trajectory.from_poses(recording.poses)
    except PoseError:
        return speeds, "torso_length"
    # Other programs' keypoints may have no wrist.
    for name in set(WRISTS) & set(trajectory.landmarks):
        path = trajectory.xy[:, trajectory.landmarks.index(name)]
        moves = (
            np.gradient(path, trajectory.time, axis=0) if count > 1 else np.full_like(path, np.nan)
        )
        speeds[name] = np.asarray(np.hypot(moves[:, 0], moves[:, 1]))
    return speeds, trajectory.unit


def _with_nulls(values: FloatArray) -> list[float | None]:
    rounded = np.round(values, CURVE_DIGITS)
    return [None if np.isnan(value) else float(value) for value in rounded]
