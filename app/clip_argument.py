"""Clips as they are named on the command line, and what is read from them."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from app.recognition import PoseSequence, Recognition, Recording, Take, record, takes_in
from app.recognition.errors import GestureError
from app.recognition.estimation.water import WaterCorrection
from app.recognition.spotting import Spotter
from app.terminal import people, progress_bar


@dataclass(frozen=True)
class Demonstration:
    """What ``LABEL=CLIP`` or ``LABEL=CLIP@START-END`` on the command line names.

    Attributes
    ----------
    label
        The gesture's label.
    clip
        The clip's file.
    span
        First and last second of the stroke when the user gives them, else None.

    """

    label: str
    clip: Path
    span: tuple[float, float] | None = None

    @classmethod
    def parse(cls, text: str) -> Demonstration:
        """Read an argument.

        Raises
        ------
        GestureError
            When it is not of that form.

        """
        label, equals, rest = text.partition("=")
        if not equals or not label.strip() or not rest:
            raise GestureError(
                f"{text!r} is not LABEL=CLIP: name the gesture and its clip, as in circle=dive.mp4"
            )
        clip, span = clip_and_span(rest)
        return cls(label.strip(), clip, span)


def clip_and_span(text: str) -> tuple[Path, tuple[float, float] | None]:
    """Split ``CLIP@START-END`` (seconds); a file whose very name looks so is taken as it is."""
    number = r"\d+(?:\.\d+)?"
    match = re.fullmatch(rf"(.+)@({number})-({number})", text)
    if match is None or Path(text).exists():
        return Path(text), None
    return Path(match[1]), (float(match[2]), float(match[3]))


def demonstration_poses(
    demonstration: Demonstration, water: WaterCorrection = "auto"
) -> PoseSequence:
    """Return the stroke of the only closed take of a clip, or of the range given by hand.

    Raises
    ------
    GestureError
        When the clip does not hold exactly one closed take and no range is given.

    """
    clip = demonstration.clip
    recording = read_clip(clip, water)
    if demonstration.span:
        return take_by_hand(recording, demonstration.span).poses
    takes = takes_in(recording)
    closed = [take for take in takes if take.closed]
    if len(closed) != 1:
        found = f"{len(closed)} closed and {len(takes) - len(closed)} unclosed takes"
        raise GestureError(
            f"{clip} holds {found}, a demonstration needs one closed take between two salutes; "
            f"record it again, or give the range by hand: {demonstration.label}={clip}@START-END"
        )
    return closed[0].poses


def take_by_hand(recording: Recording, span: tuple[float, float]) -> Take:
    """Make a take of the range the user gives, in seconds of the clip; nothing is trimmed.

    Raises
    ------
    GestureError
        When fewer than two frames lie in the range.

    """
    start, end = span
    poses = recording.poses.between(start, end)
    if len(poses) < 2:
        last = recording.poses.time[-1]
        raise GestureError(
            f"{start:g}-{end:g} s holds {len(poses)} frames of a clip that ends at {last:.2f} s; "
            "give START < END inside the clip"
        )
    return Take(
        start=start,
        end=end,
        closed=True,
        poses=poses,
        stroke_start=start,
        stroke_end=end,
        untrimmed=poses,
    )


def spotted_takes(
    spotter: Spotter, recording: Recording, span: tuple[float, float] | None
) -> list[tuple[Take, Recognition]]:
    """Find the gestures in a recording, or in a range of it, without salutes around them."""
    poses = recording.poses.between(*span) if span else recording.poses
    return [
        (take_by_hand(recording, (found.start, found.end)), found.recognition)
        for found in spotter.listen(poses)
    ]


def read_clip(clip: Path, water: WaterCorrection = "auto") -> Recording:
    """Extract a clip's landmarks behind a progress bar, and print the recording's warnings."""
    with progress_bar(clip.name) as advance:
        recording = record(clip, progress=advance, water=water)
    for warning in recording.warnings:
        people.print(f"{clip}: {warning}")
    return recording
