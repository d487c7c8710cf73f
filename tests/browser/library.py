"""A clip and a language for a browser test, made without extracting any pose."""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import httpx
from playwright.sync_api import Route

from app.recognition import Recording
from app.store import Clip
from tests.api.recordings import recording_of
from tests.api.running import Running
from tests.recognition.damaged_clips import write_clip


@dataclass(frozen=True)
class Library:
    """The data of a test.

    Attributes
    ----------
    clip, language
        Ids.
    client
        HTTP client of the server.

    """

    clip: str
    language: str
    client: httpx.Client

    @property
    def address(self) -> dict[str, str]:
        """The query of a link to the clip and the language."""
        return {"clip": self.clip, "language": self.language}

    def add_gesture(self, label: str, clip: str | None = None, description: str = "") -> None:
        """Save the take of a clip as a gesture."""
        body = {"label": label, "clip_id": clip or self.clip, "description": description}
        answer = self.client.post(f"/api/v1/languages/{self.language}/gestures", json=body)
        assert answer.status_code == 201, answer.text

    def recognise(self, expected: str | None = None, profile: str | None = None) -> str:
        """Recognise the clip, and return the recognition's id."""
        body = {
            "clip_id": self.clip,
            "language_id": self.language,
            "expected": expected,
            "profile": profile,
        }
        answer = self.client.post("/api/v1/recognitions", json=body)
        assert answer.status_code == 201, answer.text
        return str(answer.json()["id"])


def add_clip(
    server: Running,
    *shapes: str,
    name: str = "dive.mp4",
    video: Path | None = None,
    recording: Recording | None = None,
) -> str:
    """Add a clip with one take per shape and a small or the given video; return its id.

    `recording` replaces the recording of these shapes.
    """
    recording = recording_of(*shapes) if recording is None else recording
    clips = server.studio.clips
    partial = clips.new_partial()
    if video is None:
        partial.write_bytes(_small_video(len(recording.poses)))
    else:
        shutil.copyfile(video, partial)
    width, height = recording.poses.frame_size
    clip = Clip(
        name=name,
        media_type="video/mp4",
        size=partial.stat().st_size,
        width=width,
        height=height,
        duration=recording.poses.duration,
    )
    added = clips.add(clip, partial, "test")
    server.studio.jobs.start(added.job.id)
    recording.save(clips.recording(clip.id))
    server.studio.jobs.complete(
        added.job.id, len(recording.poses), recording.warnings, recording.salute_warnings
    )
    return clip.id


@cache
def _small_video(frames: int) -> bytes:
    with TemporaryDirectory() as folder:
        return write_clip(Path(folder, "small.mp4"), frames=frames).read_bytes()


def library_of(server: Running, client: httpx.Client, name: str) -> Library:
    """Add a clip of a circle, and a language of a circle and a line, both called `name`."""
    language = client.post("/api/v1/languages", json={"name": name}).json()["id"]
    library = Library(add_clip(server, "circle", name=f"{name}.mp4"), language, client)
    library.add_gesture("circle")
    library.add_gesture("line", add_clip(server, "line", name=f"{name} line.mp4"))
    return library


def answer_late(route: Route) -> None:
    """Answer a request of the page a second later than the server does."""
    answer = route.fetch()
    route.request.frame.page.wait_for_timeout(1000)
    route.fulfill(response=answer)
