"""Worker process: ``python -m app.api.workers COMMAND ...``, see `_read`.

It opens one clip or language file, writes one JSON object per line to stdout (see `messages`), and
ends as soon as its stdin is closed, which happens when the server dies.
"""

from __future__ import annotations

import argparse
import contextlib
import ctypes
import os
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import asdict
from pathlib import Path

import cv2

from app.api.workers.bag_export_request import BagExportRequest
from app.api.workers.clip_files import ClipFiles
from app.api.workers.language_files import check_language, import_language
from app.api.workers.pictures import Poster, Thumbnails, write_poster
from app.api.workers.test_takes import recognize_takes
from app.api.workers.worker_messages import (
    Failed,
    Finished,
    Message,
    Probed,
    Progressed,
    TopicSeen,
    dump,
    pose_in,
)
from app.bags.export_writer import write_bag as write_mcap
from app.clip_sources import VIDEO, ClipSource, ReadOptions, UnsupportedFile, source_named
from app.recognition.errors import LanguageError, ModelError, OsgError, VideoError
from app.recognition.estimation import create_estimator
from app.recognition.language.trigger_entry import entry_to_trigger
from app.recognition.poses.frame import Body, FrameLandmarks
from app.recognition.recording.recording import Recording
from app.recognition.recording.video import VideoFrame
from app.recognition.recording.video import probe as probe_video

PROGRESS_SECONDS = 0.1
"""Shortest time in seconds between two reports: as fast as an eye follows a progress bar."""

_SET_NAME = 15
"""Option of prctl(2) that names a process."""

Report = Callable[[Message], None]


def probe(source: ClipSource, file: Path, options: ReadOptions, report: Report) -> None:
    """Report the facts that a received file states about itself."""
    facts = source.probe(file, options)
    report(
        Probed(
            width=facts.width,
            height=facts.height,
            duration=facts.duration,
            frames=facts.frames,
            topics=tuple(TopicSeen(**asdict(topic)) for topic in facts.topics),
        )
    )


def record(
    source: ClipSource, file: Path, options: ReadOptions, files: ClipFiles, report: Report
) -> None:
    """Write a clip's recording, pictures and video, reporting progress and the newest pose."""
    partial = None
    if source.makes_video:
        partial = files.video.with_suffix(".part")
    else:
        # First, so that the clip's card has a picture early.
        write_poster(file, files.poster)
    steps = _Steps(report)
    pictures = _Pictures(files, poster=source.makes_video)

    def observe(frame: VideoFrame, found: FrameLandmarks) -> None:
        steps.observe(frame, found)
        pictures.add(frame)

    recorded = source.record(
        file, options, video=partial, progress=steps.progress, observer=observe
    )
    if partial is not None:
        partial.replace(files.video)
    pictures.write()
    steps.save(recorded.recording, files.recording)


def find_landmarks(
    source: ClipSource,
    file: Path,
    options: ReadOptions,
    target: Path,
    threads: int,
    report: Report,
) -> None:
    """Write only a clip's recording, with a number of threads for the models."""
    steps = _Steps(report)
    cv2.setNumThreads(threads)
    with closing(create_estimator(threads=threads)) as estimator:
        found = source.record(file, options, estimator=estimator, progress=steps.progress)
    steps.save(found.recording, target)


def write_bag(request: Path, bag: Path, files: ClipFiles, report: Report) -> None:
    """Write a clip and the recognitions that the request names as MCAP."""
    video: Path | None = None
    wanted = BagExportRequest.model_validate_json(request.read_bytes())
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
    named = [each.named() for each in wanted.recognitions]
    write_mcap(
        bag,
        recording,
        named,
        video=video,
        name=wanted.clip,
        trigger=entry_to_trigger(wanted.trigger),
        progress=progress,
    )
    report(Finished(frames=len(recording.poses), warnings=()))


class _Steps:
    """Receives the frames of a clip one by one, and calls `report` with the progress."""

    def __init__(self, report: Report) -> None:
        self._report = report
        self._reported = 0.0
        self._newest: tuple[VideoFrame, Body | None] | None = None

    def observe(self, frame: VideoFrame, found: FrameLandmarks) -> None:
        self._newest = frame, found.body

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

    def save(self, recorded: Recording, target: Path) -> None:
        frames = len(recorded.poses)
        self._report(Progressed(stage="saving", done=frames, total=frames))
        recorded.save(target)
        self._report(
            Finished(
                frames=frames,
                warnings=recorded.warnings,
                salute_warnings=recorded.salute_warnings,
            )
        )


class _Pictures:
    """Collects the pictures of a clip from its frames; `poster` where it has no poster yet."""

    def __init__(self, files: ClipFiles, *, poster: bool) -> None:
        self._files = files
        self._thumbnails = Thumbnails()
        self._poster = Poster(files.poster) if poster else None

    def add(self, frame: VideoFrame) -> None:
        self._thumbnails.add(frame.index, frame.image)
        if self._poster is not None:
            self._poster.add(frame.time, frame.image)

    def write(self) -> None:
        if self._poster is not None:
            self._poster.write()
        self._thumbnails.write(self._files.filmstrip)


def limit_resources(memory_bytes: int, cpu_seconds: int, file_bytes: int) -> None:
    """Set the system's limits for this process; 0 sets none. Without POSIX do nothing."""
    if os.name != "posix":
        return
    import resource

    limits = (
        (resource.RLIMIT_AS, memory_bytes),
        (resource.RLIMIT_CPU, cpu_seconds),
        # Limits each written file: an archive packed a million to one must not fill the disk.
        (resource.RLIMIT_FSIZE, file_bytes),
    )
    for kind, limit in limits:
        if limit:
            _, hard = resource.getrlimit(kind)
            most = limit if hard == resource.RLIM_INFINITY else min(limit, hard)
            # Both, because a process that a file has taken over could raise the first again.
            resource.setrlimit(kind, (most, most))
    # Crashes are expected here, and core dumps of videos are useless.
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    with contextlib.suppress(OSError):
        os.nice(5)  # The page stays responsive while a clip is read.


def end_with_server() -> None:
    """End this process as soon as its stdin is closed."""

    def wait() -> None:
        with contextlib.suppress(OSError):
            while os.read(sys.stdin.fileno(), 1024):
                pass
        os._exit(1)

    threading.Thread(target=wait, daemon=True).start()


def show_command(command: str) -> None:
    """Give this process the name ``osg COMMAND`` in lists of processes, where that is possible."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_SET_NAME, f"osg {command}".encode())


def main(arguments: Sequence[str] | None = None) -> None:
    """Run one command, by default that of the command line, and report the outcome."""
    chosen = _read(arguments)
    show_command(chosen.command)
    # Libraries that print must not write into the messages.
    channel = os.fdopen(os.dup(sys.stdout.fileno()), "w", buffering=1, encoding="utf-8")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    tempfile.tempdir = chosen.scratch
    # First, because the start of a thread may hang once memory is short.
    end_with_server()
    limit_resources(chosen.memory_bytes, chosen.cpu_seconds, chosen.file_bytes)

    def report(message: Message) -> None:
        channel.write(dump(message) + "\n")

    try:
        _run(chosen, report)
    except MemoryError:
        report(Failed(code="decoder", detail="the clip needs more memory than a job may use"))
    except UnsupportedFile as error:
        report(Failed(code="unsupported_media_type", detail=str(error)))
    except ModelError as error:
        report(Failed(code="model_missing", detail=str(error)))
    except LanguageError as error:
        report(Failed(code="language_invalid", detail=str(error), pointer=error.pointer))
    except OsgError as error:
        refusal = chosen.source.refuse(error, chosen.file)
        report(Failed(code=refusal.code, detail=refusal.detail))
    except OSError as error:
        detail = f"the server's storage cannot be used ({error.strerror}); free space and retry"
        report(Failed(code="storage_unavailable", detail=detail))


def _read(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="osg-studio worker")
    for name in ("memory-bytes", "cpu-seconds", "file-bytes"):
        parser.add_argument(f"--{name}", type=int, default=0)
    for name in ("reads", "writes"):
        parser.add_argument(f"--{name}", action="append", help="see `app.api.workers.rights`")
    parser.add_argument("--scratch", help="folder for what is unpacked")
    parser.add_argument(
        "--options", type=ReadOptions.model_validate_json, default=ReadOptions(), help="as JSON"
    )
    commands = parser.add_subparsers(dest="command", required=True)
    probing, recording = commands.add_parser("probe"), commands.add_parser("record")
    finding = commands.add_parser("landmarks")
    for command in (probing, recording, finding):
        command.add_argument("source", type=source_named)
        command.add_argument("file", type=Path)
    finding.add_argument("target", type=Path, help="the recording to write")
    finding.add_argument("--threads", type=int, required=True)
    exporting = commands.add_parser("session")
    exporting.set_defaults(source=VIDEO)
    exporting.add_argument("request", type=Path)
    exporting.add_argument("file", type=Path, help="the MCAP file to write")
    importing, checking = commands.add_parser("import"), commands.add_parser("check")
    testing = commands.add_parser("test")
    for command in (importing, checking, testing):
        command.set_defaults(source=VIDEO)
        command.add_argument("file", type=Path, help="the language file, or the request of a test")
        command.add_argument("target", type=Path, help="the JSON file, or folder of them, to write")
    importing.add_argument("--name", help="of a language whose file has none")
    for command in (recording, exporting):
        for name in ("video", "recording", "poster", "filmstrip"):
            command.add_argument(name, type=Path)
    return parser.parse_args(arguments)


def _run(chosen: argparse.Namespace, report: Report) -> None:
    match chosen.command:
        case "probe":
            probe(chosen.source, chosen.file, chosen.options, report)
        case "record":
            record(chosen.source, chosen.file, chosen.options, _files(chosen), report)
        case "landmarks":
            find_landmarks(
                chosen.source, chosen.file, chosen.options, chosen.target, chosen.threads, report
            )
        case "session":
            write_bag(chosen.request, chosen.file, _files(chosen), report)
        case "import":
            import_language(chosen.file, chosen.target, chosen.name, report)
        case "test":
            recognize_takes(chosen.file, chosen.target, report)
        case "check":
            check_language(chosen.file, chosen.target, report)


def _files(chosen: argparse.Namespace) -> ClipFiles:
    return ClipFiles(chosen.video, chosen.recording, chosen.poster, chosen.filmstrip)


if __name__ == "__main__":
    main()
