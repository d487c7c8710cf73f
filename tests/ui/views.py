"""Views of a small clip: a diver of numbers, and a video in which nobody is."""

from __future__ import annotations

from pathlib import Path

from app.recognition import Gesture, Language, Recognizer, Recording, takes_in
from app.ui.workspace import WorkspaceView
from tests.api.recordings import recording_of
from tests.recognition.damaged_clips import write_clip

GESTURES = ("circle", "line")


def language_of(*labels: str) -> Language:
    """Return a language of the shapes in `tests.api.recordings`, each under its own name."""
    gestures = []
    for label in labels:
        (take,) = takes_in(recording_of(label))
        gestures.append(Gesture.from_demonstration(label, take.poses))
    return Language(name="pool", gestures=gestures)


def view_in(
    folder: Path, shape: str = "circle", *, recognised: bool = False, expected: str | None = None
) -> WorkspaceView:
    """Return a view of the one take of a clip in which `shape` is drawn."""
    recording: Recording = recording_of(shape)
    (take,) = takes_in(recording)
    language = language_of(*GESTURES) if recognised else None
    return WorkspaceView(
        title="dive.mp4",
        video=write_clip(folder / "dive.mp4"),
        recording=recording,
        start=take.stroke_start,
        end=take.stroke_end,
        recognition=Recognizer(language).recognize(take.poses) if language else None,
        expected=expected,
        language=language,
    )
