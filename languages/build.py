"""Language builder: builds the sample languages from demonstration clips.

Run ``python -m languages.build`` from the repository's root; ``make languages`` does the same.
"""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from app.recognition import Gesture, Language, find_takes
from app.recognition.phrases.grammar import Grammar
from app.recognition.phrases.phrase import Group, OneOf, Phrase, Slot, SlotType
from languages.render.signs import SIGNS, name_clip

FOLDER = Path(__file__).resolve().parent
CREATED = datetime(2026, 11, 21, tzinfo=UTC)
"""Fixed, so that building again from the same clips gives the same file."""


@dataclass(frozen=True)
class Entry:
    """One gesture: what is shown, what it may mean to a robot, and its clip."""

    label: str
    description: str
    command: str | None = None
    clip: str | None = None

    @property
    def path(self) -> Path:
        """The demonstration clip."""
        return FOLDER / (self.clip or f"clips/{self.label}-demonstration.mp4")


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

DIVERS_SIGNS = tuple(
    Entry(label, sign.meaning, clip=f"signs/{name_clip(label)}.mp4")
    for label, sign in SIGNS.items()
)
"""Signs that recreational divers learn (see `languages.render.signs` for the source); what a robot
should do at them is left to its owner."""

PHRASES = Grammar(
    start="circle",
    end="circle",
    cancel="line",
    slot_types=(
        SlotType("number", "number", {"three": 3}),
        SlotType("how long", "text", {"infinity": "until told otherwise"}),
    ),
    phrases=(
        Phrase(
            "come here",
            (OneOf(("sweep",)),),
            command={"do": "come_here"},
            says="come here",
        ),
        Phrase(
            "go to the waypoint",
            (OneOf(("triangle",)), Slot("waypoint", "number", least=0, default=1)),
            command={"do": "go_to_waypoint", "waypoint": "{waypoint}"},
            says="go to waypoint {waypoint}",
        ),
        Phrase(
            "align",
            (OneOf(("square",)), Slot("times", "number", least=0, default=1)),
            command={"do": "align", "times": "{times}"},
            says="align yourself[, {times} times]",
        ),
        Phrase(
            "keep aligned",
            (OneOf(("square",)), Slot("how_long", "how long")),
            command={"do": "align", "until": "{how_long}"},
            says="align yourself {how_long}",
        ),
        Phrase(
            "survey",
            (
                OneOf(("wedge",)),
                Slot("metres", "number"),
                Group((OneOf(("square",)), Slot("turns", "number")), least=0),
            ),
            command={"do": "survey", "metres": "{metres}", "turns": "{turns}"},
            says="survey {metres} metres ahead[, then turn {turns} times]",
        ),
    ),
)
"""What Table 2 leaves to the robot: readiness opens and closes a message, stop cancels it, and the
number three counts."""


@dataclass(frozen=True)
class Sample:
    """One language that comes with the program."""

    name: str
    entries: tuple[Entry, ...]
    author: str = "OSG Studio, after Joshi and Sattar 2025"
    grammar: Grammar | None = None


LANGUAGES = {
    "osg-table-1": Sample("Table 1: three signs", TABLE_2[:3]),
    "osg-table-2": Sample("Table 2: eight signs", TABLE_2, grammar=PHRASES),
    "signs-of-divers": Sample(
        f"Divers' signs: {len(DIVERS_SIGNS)} signs", DIVERS_SIGNS, "OSG Studio, after RSTC 2005"
    ),
}


def make_gesture(entry: Entry) -> Gesture:
    """Make a gesture from the only closed take of its demonstration clip."""
    (take,) = [take for take in find_takes(entry.path) if take.closed]
    return Gesture.from_demonstration(
        entry.label, take.poses, description=entry.description, command=entry.command
    )


def main() -> None:
    """Write every language beside this file."""
    gestures = {entry: make_gesture(entry) for entry in (*TABLE_2, *DIVERS_SIGNS)}
    for stem, sample in LANGUAGES.items():
        language = Language(
            name=sample.name,
            gestures=[gestures[entry] for entry in sample.entries],
            author=sample.author,
            created=CREATED,
            grammar=sample.grammar,
        )
        language.save(FOLDER / f"{stem}.json")


if __name__ == "__main__":
    main()
