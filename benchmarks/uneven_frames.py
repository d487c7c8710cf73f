"""Uneven frames: what a robot's listener reads if a stalled machine or link drops frames.

A gesture of the sample languages is shown again and again, `PAUSE` seconds apart; the listener sees
the frames that are due at uneven steps (exponential) or even ones, with their true times. For each
rate: right and wrong takes, with the rule of `app.recognition.recording.recording` and without.
Then the longest gap that a take may have, chosen with each gesture left out in turn: the largest at
which no wrong take of the other gestures reaches from one showing into the next.

    python -m benchmarks.uneven_frames --showings 480

With `--live` a robot of the command line watches a camera of 25 pictures a second on this machine,
and is stopped (SIGSTOP) but for one picture at a time; an otherwise idle core is needed.

    python -m benchmarks.uneven_frames --live --showings 20
"""

from __future__ import annotations

import argparse
import json
import socket
import sys
from bisect import bisect
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache
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
from app.robot.active_language import ActiveLanguage
from app.robot.events import TakeRecognized
from app.robot.listeners.language_listener import create_listener
from languages.build import FOLDER

SHOWN = (
    ("osg-table-2", "line"),
    ("osg-table-2", "circle"),
    ("osg-table-2", "sweep"),
    ("osg-table-1", "circle"),
    ("osg-table-1", "wedge"),
    ("osg-table-1", "three"),
)
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

CANDIDATES = tuple(np.arange(0.6, 1.525, 0.05).round(2).tolist())
"""Longest gaps to choose from, in seconds."""


@dataclass(frozen=True)
class Read:
    """A take that got a label.

    Attributes
    ----------
    right
        Whether it is the label of the gesture shown.
    between
        Whether it begins in one showing and ends in the next.
    gap
        Seconds of the longest span in which a salute may have been missed.

    """

    right: bool
    between: bool
    gap: float


@cache
def load_clips(gesture: str) -> tuple[Recording, ...]:
    """Return the recordings of a gesture's test clips."""
    return tuple(record(FOLDER / "clips" / f"{gesture}-test-{number}.mp4") for number in (1, 2))


def play(
    gesture: str, rate: float, *, even: bool, random: np.random.Generator
) -> Iterator[tuple[float, PoseSequence, float]]:
    """Yield what is seen of `IN_A_STREAM` showings: when one began, a frame, its salute score."""
    clips, begun = load_clips(gesture), 0.0
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
            yield begun, pose, float(clip.salute[frame])
        begun += float(times[-1]) + STEP


def show(
    language: ActiveLanguage, gesture: str, showings: int, rate: float, *, even: bool, seed: int = 0
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
        random = np.random.default_rng((seed, stream))
        listener, starts = create_listener(language), list[float]()
        for begun, pose, salute in play(gesture, rate, even=even, random=random):
            if begun not in starts:
                starts.append(begun)
            with patch("app.recognition.recording.segmentation.find_missable", keep_longest):
                events = list(listener.feed(pose, salute))
            for event in events:
                if isinstance(event, TakeRecognized):
                    first, last = (bisect(starts, each) for each in (event.start, event.end))
                    yield Read(event.label == gesture, first != last, gap)


class Camera(ThreadingHTTPServer):
    """An MJPEG camera that shows the test clips of a gesture in turn, in real time."""

    def __init__(self, gesture: str) -> None:
        super().__init__(("127.0.0.1", 0), _Stream)
        self.pictures: list[bytes] = []
        for number in (1, 2):
            with av.open(str(FOLDER / "clips" / f"{gesture}-test-{number}.mp4")) as clip:
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


def show_live(language: Path, gesture: str, showings: int, rate: float, seed: int) -> Counter[str]:
    """Show a gesture to a robot that works for one picture at a time; return what it read."""
    random = np.random.default_rng(seed)
    with Camera(gesture) as camera:
        Thread(target=camera.serve_forever, daemon=True).start()
        address = f"http://127.0.0.1:{camera.server_port}/"
        command = [sys.executable, "-m", "app", "robot", "--language", str(language)]
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
    labels = (each["label"] for each in events if each["event"] == "take_recognized")
    return Counter("right" if each == gesture else f"wrong: {each}" for each in labels)


def count(reads: Sequence[Read], limit: float) -> tuple[int, int]:
    """Return how many right and wrong takes keep their label if gaps from `limit` on take it."""
    kept = [each.right for each in reads if each.gap < limit - 1e-9]
    return sum(kept), len(kept) - sum(kept)


def choose(reads: Sequence[Read]) -> float:
    """Return the largest candidate at which no wrong take between two showings keeps its label."""
    between = [each for each in reads if each.between]
    return max((each for each in CANDIDATES if not count(between, each)[1]), default=0.0)


def main() -> None:
    """Print a table of the rates for each gesture, and the choice with each gesture left out."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--showings", type=int, default=120, help="for each gesture and rate")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--languages", type=Path, default=FOLDER, help="folder of the languages")
    parser.add_argument("--live", action="store_true", help="a whole robot that is stopped")
    wanted = parser.parse_args()
    if wanted.live:
        name, gesture = SHOWN[0]
        for rate in UNEVEN:
            file = wanted.languages / f"{name}.json"
            found = show_live(file, gesture, wanted.showings, rate, wanted.seed)
            print(f"live  {rate} a second, {wanted.showings} showings: {dict(found)}", flush=True)
        return
    uneven: dict[tuple[str, str], list[Read]] = {each: [] for each in SHOWN}
    print("steps   rate  language     gesture   right (without the rule)   wrong (without)")
    for name, gesture in SHOWN:
        language = ActiveLanguage.load(wanted.languages / f"{name}.json", "full")
        for even, rate in [(False, each) for each in UNEVEN] + [(True, each) for each in EVEN]:
            reads = list(
                show(language, gesture, wanted.showings, rate, even=even, seed=wanted.seed)
            )
            right, wrong = count(reads, LIMIT)
            all_right, all_wrong = count(reads, np.inf)
            print(
                f"{'even' if even else 'uneven':6}  {rate:4}  {name:11}  {gesture:8}"
                f"  {right:5} ({all_right})  {wrong:5} ({all_wrong})",
                flush=True,
            )
            if not even:
                uneven[name, gesture] += reads
    print(
        f"\nlongest gap: {LIMIT:.2f} s here; chosen on the other gestures, read on the one left out"
    )
    for left in sorted({gesture for _, gesture in SHOWN}):
        others = [read for key, reads in uneven.items() if key[1] != left for read in reads]
        own = [read for key, reads in uneven.items() if key[1] == left for read in reads]
        limit = choose(others)
        right, wrong = count(own, limit)
        print(f"  {left:8}  {limit:.2f} s: {right} right, {wrong} wrong")


if __name__ == "__main__":
    main()
