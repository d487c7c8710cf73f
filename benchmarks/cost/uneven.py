"""Uneven frames: what a robot's listener reads if a stalled machine or link drops frames.

A gesture of the sample languages is shown again and again, `PAUSE` seconds apart; the listener sees
the frames that are due at uneven steps (exponential) or even ones, with their true times. For each
rate: right and wrong takes, with the rule of `app.recognition.recording.recording` and without.

`live`: a robot of the command line watches a camera of 25 pictures a second on this machine, and is
stopped (SIGSTOP) but for one picture at a time; an otherwise idle core is needed.
"""

from __future__ import annotations

import json
import socket
import sys
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from signal import SIGCONT, SIGSTOP
from subprocess import DEVNULL, PIPE, Popen
from threading import Thread
from time import monotonic, sleep
from unittest.mock import patch

import av
import cv2
import numpy as np

from app.recognition import PoseSequence, Recording, record
from app.recognition.recording.recording import LONGER_HELD, find_missable
from app.recognition.recording.salute import HOLD_SECONDS
from app.recognition.recording.trimming import SETTING_OUT, Span
from app.resources import samples_dir
from app.robot.active_language import ActiveLanguage
from app.robot.events import TakeRecognized
from app.robot.listeners.language_listener import create_listener
from benchmarks.cost.robot import MEASURES
from benchmarks.figures import Figure, Measurement, Results, share, table

FOLDER = samples_dir()

SHOWN = {
    "line": ("osg-table-2", "line"),
    "circle": ("osg-table-2", "circle"),
    "sweep": ("osg-table-2", "sweep"),
    "circle-of-3": ("osg-table-1", "circle"),
    "wedge-of-3": ("osg-table-1", "wedge"),
    "three-of-3": ("osg-table-1", "three"),
}
"""Languages and gestures, each shown by the two test clips of the gesture in turn."""

UNEVEN, EVEN = (3, 4, 5, 6, 8), (4, 5, 6, 8)
"""Frames a second."""

PAUSE, STEP = 1.5, 0.04
"""Seconds between two showings, in which the last pose is held, and between two frames there."""

ONE_PICTURE = 0.08
"""Seconds in which a robot reads one picture, on a core of a laptop."""

IN_A_STREAM = 6
"""Showings that one listener sees, one after the other."""

LIMIT = HOLD_SECONDS + LONGER_HELD + SETTING_OUT
"""Seconds from which a gap takes the label."""


@dataclass(frozen=True)
class Read:
    """A take that got a label.

    Attributes
    ----------
    right
        Whether it is the label of the gesture shown.
    gap
        Seconds of the longest span in which a salute may have been missed.

    """

    right: bool
    gap: float


def find_clips(gesture: str) -> list[Path]:
    """Return a gesture's test clips."""
    return [FOLDER / "clips" / f"{gesture}-test-{number}.mp4" for number in (1, 2)]


def play(
    clips: Sequence[Recording], rate: float, *, even: bool, random: np.random.Generator
) -> Iterator[tuple[PoseSequence, float]]:
    """Yield what is seen of `IN_A_STREAM` showings: a frame, and its salute score."""
    begun = 0.0
    for number in range(IN_A_STREAM):
        clip = clips[number % len(clips)]
        held = clip.poses.time[-1] + np.arange(1, int(PAUSE / STEP)) * STEP
        times = np.concatenate([clip.poses.time, held])
        due = float(random.uniform(0, 1 / rate))
        for at, time in enumerate(times.tolist()):
            if time < due:
                continue
            due = due + 1 / rate if even else time + random.exponential(1 / rate)
            frame = min(at, len(clip.poses) - 1)
            shown = float(clip.poses.time[frame])
            pose = replace(clip.poses.between(shown, shown), time=np.array([begun + time]))
            yield pose, float(clip.salute[frame])
        begun += float(times[-1]) + STEP


def show(
    language: ActiveLanguage,
    gesture: str,
    clips: Sequence[Recording],
    showings: int,
    rate: float,
    *,
    even: bool,
) -> Iterator[Read]:
    """Show a gesture to listeners, and yield the takes with a label."""
    gap = 0.0

    def keep_longest(moments: Sequence[float], start: float, end: float, hold: float) -> tuple[()]:
        nonlocal gap
        # A hold of less than nothing finds every span between two frames.
        spans: tuple[Span, ...] = find_missable(moments, start, end, hold - LIMIT)
        gap = max((each.end - each.start for each in spans), default=0.0)
        return ()

    for stream in range(showings // IN_A_STREAM):
        listener, random = create_listener(language), np.random.default_rng((1, stream))
        for pose, salute in play(clips, rate, even=even, random=random):
            with patch("app.recognition.recording.segmentation.find_missable", keep_longest):
                events = list(listener.feed(pose, salute))
            for event in events:
                if isinstance(event, TakeRecognized):
                    yield Read(event.label == gesture, gap)


def measure_gesture(name: str, gesture: str, quick: bool) -> Iterator[Figure]:
    """Yield right and wrong takes of a gesture's showings, with the rule and without."""
    language = ActiveLanguage.load(FOLDER / f"{name}.json", "full")
    clips = [record(each) for each in find_clips(gesture)]
    showings = IN_A_STREAM if quick else 480
    for even, rate in [(False, each) for each in UNEVEN] + [(True, each) for each in EVEN]:
        reads = [*show(language, gesture, clips, showings, rate, even=even)]
        for rule, kept in (("", [e for e in reads if e.gap < LIMIT - 1e-9]), ("-without", reads)):
            steps = f"{'even' if even else 'uneven'}-{rate}"
            right = sum(each.right for each in kept)
            yield share(f"{steps}/right{rule}", right, showings)
            yield share(f"{steps}/wrong{rule}", len(kept) - right, showings)


class Camera(ThreadingHTTPServer):
    """An MJPEG camera that shows the test clips of a gesture in turn, in real time."""

    def __init__(self, gesture: str) -> None:
        super().__init__(("127.0.0.1", 0), _Stream)
        self.pictures: list[bytes] = []
        for each in find_clips(gesture):
            with av.open(str(each)) as clip:
                shown = [
                    cv2.imencode(".jpg", frame.to_ndarray(format="bgr24"))[1].tobytes()
                    for frame in clip.decode(video=0)
                ]
            self.pictures += shown + shown[-1:] * int(PAUSE / STEP)
        self.began = monotonic()


class _Stream(BaseHTTPRequestHandler):
    def do_GET(self) -> None:
        """Send the picture of the moment, again and again; who stands still misses some."""
        assert isinstance(self.server, Camera)
        self.connection.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 2**15)
        self.send_response(200)
        self.send_header("Content-Type", "multipart/x-mixed-replace; boundary=next")
        self.end_headers()
        pictures, last = self.server.pictures, -1
        with suppress(OSError):
            while True:
                at = int((monotonic() - self.server.began) / STEP)
                if at == last:
                    sleep(STEP / 4)
                    continue
                last = at
                picture = pictures[at % len(pictures)]
                head = (
                    f"--next\r\nContent-Type: image/jpeg\r\nContent-Length: {len(picture)}\r\n\r\n"
                )
                self.wfile.write(head.encode() + picture + b"\r\n")

    def log_message(self, format: str, *args: object) -> None:
        """Write nothing about a request."""


def show_live(rate: float, quick: bool) -> Iterator[Figure]:
    """Show a gesture to a robot that works for one picture at a time, and yield what it read."""
    name, gesture = SHOWN["line"]
    random, showings = np.random.default_rng(1), 3 if quick else 10
    with Camera(gesture) as camera:
        Thread(target=camera.serve_forever, daemon=True).start()
        address = f"http://127.0.0.1:{camera.server_port}/"
        command = [sys.executable, "-m", "app", "robot", "--language", f"{FOLDER / name}.json"]
        robot = Popen([*command, "--source", address], stdout=PIPE, stderr=DEVNULL, text=True)
        assert robot.stdout is not None
        for line in robot.stdout:
            if json.loads(line)["event"] == "recognition_ready":
                break
        end = monotonic() + showings * len(camera.pictures) * STEP / 2
        while monotonic() < end:
            robot.send_signal(SIGSTOP)
            sleep(max(0.0, random.exponential(1 / rate) - ONE_PICTURE))
            robot.send_signal(SIGCONT)
            sleep(ONE_PICTURE)
        robot.terminate()
        events = [json.loads(line) for line in robot.stdout]
        robot.wait()
        camera.shutdown()
    read = [each["label"] == gesture for each in events if each["event"] == "take_recognized"]
    yield share("right", sum(read), showings)
    yield share("wrong", len(read) - sum(read), showings)


def measurements(folder: Path, methods: tuple[str, ...]) -> Iterator[Measurement]:
    """Yield the showings of each gesture, and those to a whole robot at some rates."""
    for key, shown in SHOWN.items():
        yield Measurement(
            f"uneven/{key}",
            partial(measure_gesture, *shown),
            "two rendered clips",
            "480 showings a rate, at exponential and at even steps",
            measures=MEASURES,
        )
    for rate in (4, 8):
        yield Measurement(
            f"uneven/live-{rate}",
            partial(show_live, rate),
            "two rendered clips",
            "a robot that is stopped but for one picture at a time, ten showings of `line`",
            measures=MEASURES,
            alone=True,
        )


def write_uneven(results: Results) -> str:
    """Write right and wrong showings at uneven steps: in brackets without the rule."""
    rows = []
    for rate in UNEVEN:
        cells = [f"{rate}"]
        for key in SHOWN:
            right, all_right, wrong, all_wrong = (
                results.show(f"uneven/{key}", f"uneven-{rate}/{each}", "hits")
                for each in ("right", "right-without", "wrong", "wrong-without")
            )
            cells.append(f"{right} ({all_right}), {wrong} ({all_wrong})")
        rows.append(cells)
    names = (f"`{key.replace('-of-3', '` of 3')}" + "`" * ("-" not in key) for key in SHOWN)
    return table(("frames a second", *names), rows)


TABLES = {"uneven": write_uneven}
