"""Rendered divers in mittens, who hold an arm pose instead of a salute before and after a gesture.

``python -m languages.render circle-by-belly --out tests/posed_clips`` renders a clip again, and
``languages.record`` rounds its landmarks.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

from app.recognition import Gesture, Language, Recording, takes_in
from app.recognition.triggers.trigger import ArmPose, Trigger

POSED_CLIPS = Path(__file__).parent / "posed_clips"

BELLY = (1.0, 2.0)
"""Seconds of each clip in which the left forearm is held across the belly."""

HEAD = (5.2, 6.2)
"""Seconds of ``wedge-by-belly-and-head`` in which the left hand is held on the head."""


def posed_clip(name: str) -> Path:
    """Return a clip's file; only ``circle-by-belly`` and ``circle-by-belly-2`` have one."""
    return POSED_CLIPS / f"{name}.mp4"


@cache
def posed_recording(name: str) -> Recording:
    """Return the landmarks of a clip; also of ``wedge-by-belly`` and of that ``-and-head``."""
    return Recording.load(POSED_CLIPS / f"{name}.npz")


def belly_pose() -> ArmPose:
    return ArmPose.from_poses(posed_recording("circle-by-belly").poses.between(*BELLY))


def head_pose() -> ArmPose:
    return ArmPose.from_poses(posed_recording("wedge-by-belly-and-head").poses.between(*HEAD))


BY_BELLY = Trigger("pose", belly_pose())
BY_BELLY_AND_HEAD = Trigger("pose", belly_pose(), head_pose())


@cache
def posed_language(trigger: Trigger = BY_BELLY) -> Language:
    """Return a language of a circle and a wedge with an arm trigger, from a clip each."""
    circle, wedge = (
        takes_in(posed_recording(name), trigger=shown)[0].poses
        for name, shown in (
            ("circle-by-belly", BY_BELLY),
            ("wedge-by-belly-and-head", BY_BELLY_AND_HEAD),
        )
    )
    gestures = [
        Gesture.from_demonstration("circle", circle),
        Gesture.from_demonstration("wedge", wedge),
    ]
    return replace(Language("posed", gestures), trigger=trigger)
