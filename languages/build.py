"""Build the two sample languages of the paper from their demonstration clips.

Run ``python -m languages.build`` from the repository's root; ``make languages`` does the same.
"""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from app.recognition import Gesture, Language, find_takes

FOLDER = Path(__file__).resolve().parent
CREATED = datetime(2026, 11, 21, tzinfo=UTC)
"""Fixed, so that building again from the same clips gives the same file."""


@dataclass(frozen=True)
class Entry:
    """One row of the paper's Table 2: what is drawn, and what it may mean to a robot."""

    label: str
    description: str
    command: str


TABLE_2 = (
    Entry("circle", "Circular motion performed by the right hand", "Signal readiness"),
    Entry("wedge", "V-shaped gesture using the right hand", "Go in a direction"),
    Entry("three", "The right hand draws the number 3", "The number three"),
    Entry("infinity", "The right hand draws a lying eight", "Repeat continuously"),
    Entry("sweep", "Both hands sweep up and down in an arc", "Come here"),
    Entry("triangle", "The right hand draws a triangle", "Go to the waypoint"),
    Entry("square", "The right hand draws a square", "Align yourself"),
    Entry("line", "Horizontal sweeping motion of the right hand", "Stop what you are doing"),
)
"""Joshi and Sattar 2025, Table 2; its first three rows are Table 1."""

LANGUAGES = {
    "osg-table-1": ("Table 1: three signs", TABLE_2[:3]),
    "osg-table-2": ("Table 2: eight signs", TABLE_2),
}


def gesture(entry: Entry) -> Gesture:
    """Make a gesture from the only closed take of its demonstration clip."""
    clip = FOLDER / "clips" / f"{entry.label}-demonstration.mp4"
    (take,) = [take for take in find_takes(clip) if take.closed]
    return Gesture.from_demonstration(
        entry.label, take.poses, description=entry.description, command=entry.command
    )


def main() -> None:
    """Write every language beside this file."""
    gestures = {entry.label: gesture(entry) for entry in TABLE_2}
    for stem, (name, entries) in LANGUAGES.items():
        language = Language(
            name=name,
            gestures=[gestures[entry.label] for entry in entries],
            author="OSG Studio, after Joshi and Sattar 2025",
            created=CREATED,
        )
        language.calibrated().save(FOLDER / f"{stem}.json")


if __name__ == "__main__":
    main()
