"""The process that opens clips: ``python -m app.api.extraction.worker probe|extract ...``.

It writes one JSON object per line to stdout (see `messages`) and ends by itself when its stdin is
closed, which is what happens when the server dies.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from app.api.extraction.messages import (
    Failed,
    Finished,
    Message,
    Probed,
    Progressed,
    dump,
    pose_in,
)

if TYPE_CHECKING:
    from app.recognition.estimation.base import Body, FrameLandmarks
    from app.recognition.estimation.water import WaterCorrection
    from app.recognition.video import VideoFrame

PROGRESS_SECONDS = 0.1
"""Shortest time between two reports: what an eye follows on a progress bar."""

Report = Callable[[Message], None]


def probe(clip: Path, report: Report) -> None:
    """Report what the clip says about itself."""
    from app.recognition import video

    report(Probed(**asdict(video.probe(clip))))


def extract(
    clip: Path,
    recording: Path,
    poster: Path,
    filmstrip: Path,
    water: WaterCorrection,
    report: Report,
) -> None:
    """Write the clip's pictures and recording, reporting progress and the newest pose."""
    from app.api.extraction.pictures import Thumbnails, write_poster
    from app.recognition import extraction, video

    write_poster(clip, poster)
    info = video.probe(clip)
    reported, newest_time = 0.0, 0.0
    newest: Body | None = None
    thumbnails = Thumbnails()

    def observe(frame: VideoFrame, found: FrameLandmarks) -> None:
        nonlocal newest_time, newest
        newest_time, newest = frame.time, found.body
        thumbnails.add(frame.index, frame.image)

    def progress(done: int, total: int) -> None:
        nonlocal reported
        if (now := time.monotonic()) - reported >= PROGRESS_SECONDS or done == total:
            reported = now
            pose = pose_in(newest.xy, info.width, info.height) if newest else None
            seconds = round(newest_time, 3)
            report(Progressed(stage="poses", done=done, total=total, time=seconds, pose=pose))

    recorded = extraction.record(clip, progress=progress, observer=observe, water=water)
    frames = len(recorded.poses)
    report(Progressed(stage="saving", done=frames, total=frames))
    thumbnails.write(filmstrip)
    recorded.save(recording)
    report(Finished(frames=frames, warnings=recorded.warnings))


def limit_resources(memory_bytes: int, cpu_seconds: int) -> None:
    """Have the system end this process at these limits; 0 is none, as where POSIX is absent."""
    if os.name != "posix":
        return
    import resource

    for kind, limit in ((resource.RLIMIT_AS, memory_bytes), (resource.RLIMIT_CPU, cpu_seconds)):
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
    parser = argparse.ArgumentParser(prog="osg-studio worker")
    parser.add_argument("--memory-bytes", type=int, default=0)
    parser.add_argument("--cpu-seconds", type=int, default=0)
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("probe").add_argument("clip", type=Path)
    extracting = commands.add_parser("extract")
    for name in ("clip", "recording", "poster", "filmstrip"):
        extracting.add_argument(name, type=Path)
    extracting.add_argument("--water", default="auto")
    chosen = parser.parse_args()

    # Libraries that print must not write into the messages.
    channel = os.fdopen(os.dup(sys.stdout.fileno()), "w", buffering=1, encoding="utf-8")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    limit_resources(chosen.memory_bytes, chosen.cpu_seconds)
    end_with_server()

    def report(message: Message) -> None:
        channel.write(dump(message) + "\n")

    from app.recognition.errors import ModelError, RecognitionError

    try:
        if chosen.command == "probe":
            probe(chosen.clip, report)
        else:
            files = (chosen.clip, chosen.recording, chosen.poster, chosen.filmstrip)
            extract(*files, chosen.water, report)
    except MemoryError:
        report(Failed(code="decoder", detail="the clip needs more memory than a job may use"))
    except ModelError as error:
        report(Failed(code="model_missing", detail=str(error)))
    except RecognitionError as error:
        # Our own name of the file means nothing to whoever sent it.
        detail = str(error).replace(chosen.clip.name, "the clip")
        report(Failed(code="video_unreadable", detail=detail))
    except OSError as error:
        detail = f"the server's storage cannot be used ({error.strerror}); free space and retry"
        report(Failed(code="storage_unavailable", detail=detail))


if __name__ == "__main__":
    main()
