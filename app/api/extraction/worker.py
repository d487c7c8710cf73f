"""The process that opens clips: ``python -m app.api.extraction.worker probe|extract ...``.

It writes one JSON object per line to stdout (see `messages`) and ends by itself when its stdin is
closed, which is what happens when the server dies.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from app.api.extraction.clip_files import ClipFiles
from app.api.extraction.messages import (
    BagProbed,
    Failed,
    Finished,
    KeypointsProbed,
    Message,
    Probed,
    Progressed,
    TopicSeen,
    dump,
    pose_in,
)

if TYPE_CHECKING:
    from app.api.extraction.keypoint_source import KeypointSource
    from app.recognition.estimation.water import WaterCorrection
    from app.recognition.poses.frame import Body, FrameLandmarks
    from app.recognition.recording.recording import Recording
    from app.recognition.recording.video import VideoFrame

PROGRESS_SECONDS = 0.1
"""Shortest time between two reports: what an eye follows on a progress bar."""

Report = Callable[[Message], None]


def probe(clip: Path, report: Report) -> None:
    """Report what the clip says about itself."""
    from app.recognition.recording import video

    report(Probed(**asdict(video.probe(clip))))


def probe_bag(bag: Path, report: Report) -> None:
    """Report which topics of a dive recording a clip can be made of."""
    from app.bags.bag_kind import HEAD_BYTES, bag_kind
    from app.bags.staging import is_bag_archive
    from app.bags.topic_summary import usable_topics

    with bag.open("rb") as file:
        kind = bag_kind(file.read(HEAD_BYTES))
    if kind == "zip" and not is_bag_archive(bag):
        detail = "the archive holds no dive recording (no .mcap and no .db3 file)"
        report(Failed(code="unsupported_media_type", detail=detail))
        return
    report(BagProbed(topics=tuple(TopicSeen(**asdict(topic)) for topic in usable_topics(bag))))


def extract(files: ClipFiles, water: WaterCorrection, report: Report) -> None:
    """Write the clip's pictures and recording, reporting progress and the newest pose."""
    from app.api.extraction.pictures import write_poster
    from app.recognition.recording import extraction

    # First of all: a card with a picture says more than one without.
    write_poster(files.video, files.poster)
    steps = _Steps(files, report, poster=False)
    recorded = extraction.record(
        files.video, progress=steps.progress, observer=steps.observe, water=water
    )
    steps.save(recorded)


def extract_bag(
    bag: Path, topic: str | None, files: ClipFiles, water: WaterCorrection, report: Report
) -> None:
    """Write the video, pictures and recording of a topic, reporting as `extract` does."""
    from app.bags import record_bag

    steps = _Steps(files, report, poster=True)
    partial = files.video.with_suffix(".part")
    recorded = record_bag(
        bag, topic, video=partial, progress=steps.progress, observer=steps.observe, water=water
    )
    partial.replace(files.video)
    steps.save(recorded)


def probe_keypoints(file: Path, told: KeypointSource, report: Report) -> None:
    """Report what a keypoint file holds; all of it is read, as there is no other way to know."""
    from app.api.extraction.keypoint_clip import read_recording
    from app.keypoint_files import is_openpose_archive

    if told.ending == ".zip" and not is_openpose_archive(file):
        detail = (
            "the archive holds neither a dive recording (no .mcap and no .db3 file) nor frames of "
            "OpenPose (*_keypoints.json)"
        )
        report(Failed(code="unsupported_media_type", detail=detail))
        return
    read = read_recording(file, told)
    if isinstance(read, Failed):
        report(read)
        return
    poses = read.poses
    width, height = poses.frame_size
    report(KeypointsProbed(width=width, height=height, duration=poses.duration, frames=len(poses)))


def extract_keypoints(file: Path, told: KeypointSource, files: ClipFiles, report: Report) -> None:
    """Write the video of a keypoint file's skeleton, pictures and recording, as `extract` does."""
    from app.api.extraction.keypoint_clip import read_recording
    from app.bags import show_recording

    read = read_recording(file, told)
    if isinstance(read, Failed):
        report(read)
        return
    steps = _Steps(files, report, poster=True)
    partial = files.video.with_suffix(".part")
    show_recording(read, partial, steps.progress, steps.observe)
    partial.replace(files.video)
    steps.save(read)


def write_session(wanted: Path, session: Path, files: ClipFiles, report: Report) -> None:
    """Write a clip's session as MCAP, with the recognitions that the file `wanted` tells."""
    from app.api.extraction.mcap_request import SessionWishes
    from app.bags.session_writer import write_session as write
    from app.recognition.errors import VideoError
    from app.recognition.recording.recording import Recording
    from app.recognition.recording.video import probe as probe_video

    video: Path | None = None
    wishes = SessionWishes.model_validate_json(wanted.read_bytes())
    reported = 0.0

    def progress(done: int, total: int) -> None:
        nonlocal reported
        if (now := time.monotonic()) - reported >= PROGRESS_SECONDS:
            reported = now
            report(Progressed(stage="saving", done=done, total=total))

    recording = Recording.load(files.recording)
    with contextlib.suppress(VideoError):
        probe_video(files.video)
        video = files.video
    named = [wish.named() for wish in wishes.recognitions]
    write(session, recording, named, video=video, name=wishes.clip, progress=progress)
    report(Finished(frames=len(recording.poses), warnings=()))


class _Steps:
    """Takes the frames of a clip one by one, and reports how far the work is.

    Parameters
    ----------
    files
        What to write.
    report
        Hears of it.
    poster
        Whether the still picture is still to be written.

    """

    def __init__(self, files: ClipFiles, report: Report, *, poster: bool) -> None:
        from app.api.extraction.pictures import Poster, Thumbnails

        self._files, self._report = files, report
        self._reported = 0.0
        self._newest: tuple[VideoFrame, Body | None] | None = None
        self._thumbnails = Thumbnails()
        self._poster = Poster(files.poster) if poster else None

    def observe(self, frame: VideoFrame, found: FrameLandmarks) -> None:
        self._newest = frame, found.body
        self._thumbnails.add(frame.index, frame.image)
        if self._poster is not None:
            self._poster.add(frame.time, frame.image)

    def progress(self, done: int, total: int) -> None:
        if (now := time.monotonic()) - self._reported < PROGRESS_SECONDS and done != total:
            return
        self._reported = now
        seconds, pose = None, None
        if self._newest is not None:
            frame, body = self._newest
            height, width = frame.image.shape[:2]
            seconds = round(frame.time, 3)
            pose = pose_in(body.xy, width, height) if body else None
        self._report(Progressed(stage="poses", done=done, total=total, time=seconds, pose=pose))

    def save(self, recorded: Recording) -> None:
        frames = len(recorded.poses)
        self._report(Progressed(stage="saving", done=frames, total=frames))
        if self._poster is not None:
            self._poster.write()
        self._thumbnails.write(self._files.filmstrip)
        recorded.save(self._files.recording)
        self._report(Finished(frames=frames, warnings=recorded.warnings))


def limit_resources(memory_bytes: int, cpu_seconds: int, file_bytes: int) -> None:
    """Have the system hold this process to these limits; 0 is none, as where POSIX is absent."""
    if os.name != "posix":
        return
    import resource

    limits = (
        (resource.RLIMIT_AS, memory_bytes),
        (resource.RLIMIT_CPU, cpu_seconds),
        # Of one file that is written: what was packed by a million to one must not fill the disk.
        (resource.RLIMIT_FSIZE, file_bytes),
    )
    for kind, limit in limits:
        if limit:
            _, hard = resource.getrlimit(kind)
            soft = limit if hard == resource.RLIM_INFINITY else min(limit, hard)
            resource.setrlimit(kind, (soft, hard))
    # A crash is expected here, and a core dump of a video is of no use to anybody.
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    with contextlib.suppress(OSError):
        os.nice(5)  # The page stays quick while a clip is read.


def end_with_server() -> None:
    """End this process as soon as its stdin is closed."""

    def wait() -> None:
        with contextlib.suppress(OSError):
            while os.read(sys.stdin.fileno(), 1024):
                pass
        os._exit(1)

    threading.Thread(target=wait, daemon=True).start()


def main() -> None:
    """Run one command and report how it went."""
    chosen = _arguments()
    # Libraries that print must not write into the messages.
    channel = os.fdopen(os.dup(sys.stdout.fileno()), "w", buffering=1, encoding="utf-8")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    tempfile.tempdir = chosen.scratch
    limit_resources(chosen.memory_bytes, chosen.cpu_seconds, chosen.file_bytes)
    end_with_server()

    def report(message: Message) -> None:
        channel.write(dump(message) + "\n")

    from app.recognition.errors import (
        BagError,
        ModelError,
        OsgError,
        TopicError,
    )

    try:
        _run(chosen, report)
    except MemoryError:
        report(Failed(code="decoder", detail="the clip needs more memory than a job may use"))
    except ModelError as error:
        report(Failed(code="model_missing", detail=str(error)))
    except OsgError as error:
        codes: dict[type, str] = {TopicError: "topic_needed", BagError: "bag_unreadable"}
        # Our own name of the file means nothing to whoever sent it.
        name = _received(chosen).name
        detail = str(error).replace(name, "the clip")
        report(Failed(code=codes.get(type(error), "video_unreadable"), detail=detail))
    except OSError as error:
        detail = f"the server's storage cannot be used ({error.strerror}); free space and retry"
        report(Failed(code="storage_unavailable", detail=detail))


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="osg-studio worker")
    for name in ("memory-bytes", "cpu-seconds", "file-bytes"):
        parser.add_argument(f"--{name}", type=int, default=0)
    parser.add_argument("--scratch", help="folder for what is unpacked")
    commands = parser.add_subparsers(dest="command", required=True)
    clip = ("clip", "recording", "poster", "filmstrip")
    for command, paths in {
        "probe": ("clip",),
        "probe-bag": ("bag",),
        "extract": clip,
        "extract-bag": ("bag", *clip),
        "probe-keypoints": ("keypoints",),
        "extract-keypoints": ("keypoints", *clip),
        "session": ("wanted", "session", *clip),
    }.items():
        taking = commands.add_parser(command)
        for name in paths:
            taking.add_argument(name, type=Path)
        taking.add_argument("--water", default="auto")
        taking.add_argument("--topic")
        taking.add_argument("--told", help="how a keypoint file is read, as JSON")
    return parser.parse_args()


def _run(chosen: argparse.Namespace, report: Report) -> None:
    match chosen.command:
        case "probe":
            probe(chosen.clip, report)
        case "probe-bag":
            probe_bag(chosen.bag, report)
        case "extract":
            extract(_files(chosen), chosen.water, report)
        case "extract-bag":
            extract_bag(chosen.bag, chosen.topic, _files(chosen), chosen.water, report)
        case "probe-keypoints":
            probe_keypoints(chosen.keypoints, _told(chosen), report)
        case "extract-keypoints":
            extract_keypoints(chosen.keypoints, _told(chosen), _files(chosen), report)
        case "session":
            write_session(chosen.wanted, chosen.session, _files(chosen), report)


def _received(chosen: argparse.Namespace) -> Path:
    """Return the file that somebody sent."""
    named = vars(chosen)
    received: Path = named.get("bag") or named.get("keypoints") or named["clip"]
    return received


def _told(chosen: argparse.Namespace) -> KeypointSource:
    from app.api.extraction.keypoint_source import KeypointSource

    return KeypointSource.model_validate_json(chosen.told)


def _files(chosen: argparse.Namespace) -> ClipFiles:
    return ClipFiles(chosen.clip, chosen.recording, chosen.poster, chosen.filmstrip)


if __name__ == "__main__":
    main()
