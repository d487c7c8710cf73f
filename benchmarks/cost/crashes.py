"""Crashes: whether a server that is killed loses what it has acknowledged.

In each round clients upload clips (whole, in parts, as chapters of one recording), delete clips and
undo that, go on with uploads, and create, rename and delete languages, until the server is killed
by SIGKILL at a random moment, in half of the rounds after one of its worker processes. After the
next start every acknowledged change and every acknowledged part of an upload must be there, every
other change must be there in full or not at all, the audit log must hold every acknowledged change,
and no file may be without its row. At the end every job must have ended, and each one that is done
must have all frames of its clip.
"""

from __future__ import annotations

import base64
import os
import signal
import sqlite3
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Collection, Iterator
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Any, Final

import httpx

from app.recognition.recording.chapters import join_chapters
from benchmarks.cost.server import API, SERVE, small_clip
from benchmarks.figures import Figure, Measurement, share

FEWEST_SECONDS, MOST_SECONDS = 0.2, 2.0
"""Seconds from the clients' start to a kill: a request takes milliseconds, a job seconds."""

FRAMES: Final = 10
"""Frames of the uploaded clip."""

MOST_CLIPS, MOST_LANGUAGES = 12, 20
"""Numbers to keep; further ones are deleted, a change that is checked too."""

UNDONE: Final = 0.1
"""Share of the changes of clips that bring a deleted one back, if there is one."""

TUS: Final = {"Tus-Resumable": "1.0.0"}
OFFSETS: Final = {"Content-Type": "application/offset+octet-stream"}
FINAL: Final = ("done", "failed", "cancelled")

REPEATED: Final = (404, 409, 422, 429, 503)
"""Answers that clients may get of a server that is at its limits, or whose worker was killed."""


@dataclass
class Written:
    """Changes that the server has acknowledged, and the last ones sent without an answer.

    Attributes
    ----------
    languages
        Revision and name by id; None for a deleted language.
    attempts
        Name by id, or None for a deletion, of requests without an answer.
    clips
        By id whether the clip is kept.
    changing
        Ids of clips of which a deletion or its undoing was sent and not answered.
    parts
        Acknowledged bytes of the resumable uploads that are not complete, by address.
    unaudited
        Ids of acknowledged requests whose entries in the audit log were not looked for yet.
    acknowledged
        Number of changes.
    lost
        Missing or wrong things, in words.

    """

    languages: dict[str, tuple[int, str] | None] = field(default_factory=dict)
    attempts: dict[str, str | None] = field(default_factory=dict)
    clips: dict[str, bool] = field(default_factory=dict)
    changing: set[str] = field(default_factory=set)
    parts: dict[str, int] = field(default_factory=dict)
    unaudited: set[str] = field(default_factory=set)
    acknowledged: int = 0
    lost: list[str] = field(default_factory=list)


Client = Callable[[httpx.Client, Written, Random, bytes], None]


def edit(client: httpx.Client, written: Written, draw: Random, clip: bytes) -> None:
    """Create, rename or delete a language."""
    # Not a language with an unanswered request: its state is known only after the next start.
    kept = [
        key for key, state in written.languages.items() if state and key not in written.attempts
    ]
    name = f"language {draw.randrange(10**9)}"
    if not kept or draw.random() < 0.2:
        made = client.post(f"{API}/languages", json={"name": name}).raise_for_status().json()
        written.languages[made["id"]] = made["revision"], name
        return
    chosen = draw.choice(kept)
    place = f"{API}/languages/{chosen}"
    if len(kept) > MOST_LANGUAGES:
        written.attempts[chosen] = None
        client.delete(place).raise_for_status()
        written.languages[chosen] = None
    else:
        written.attempts[chosen] = name
        made = client.patch(place, json={"name": name}).raise_for_status().json()
        written.languages[chosen] = made["revision"], name
    del written.attempts[chosen]


def change_clips(client: httpx.Client, written: Written, draw: Random, clip: bytes) -> None:
    """Add a clip at once, in two parts or of two chapters; delete one, or undo that."""
    settled = {key: kept for key, kept in written.clips.items() if key not in written.changing}
    kept, gone = ([key for key, each in settled.items() if each is now] for now in (True, False))
    undoes = bool(gone) and draw.random() < UNDONE
    if undoes or len(kept) >= MOST_CLIPS:
        chosen = draw.choice(gone if undoes else kept)
        place = f"{API}/clips/{chosen}"
        written.changing.add(chosen)
        answer = client.post(f"{place}/restore") if undoes else client.delete(place)
        answer.raise_for_status()
        written.clips[chosen] = undoes
        written.changing.discard(chosen)
    elif draw.random() < 0.5:
        answer = client.post(f"{API}/clips", files={"file": ("dive.mkv", clip)})
        written.clips[answer.raise_for_status().json()["id"]] = True
    else:
        chapters = {}
        if draw.random() < 0.5:
            sizes = base64.b64encode(f"{len(clip)},{len(clip)}".encode()).decode()
            chapters, clip = {"Upload-Metadata": f"chapters {sizes}"}, clip + clip
        place, half = begin(client, len(clip), chapters), len(clip) // 2
        for start, part in ((0, clip[:half]), (half, clip[half:])):
            answer = send(client, place, start, part)
        written.clips[answer.headers["content-location"].rpartition("/")[2]] = True


def go_on(client: httpx.Client, written: Written, draw: Random, clip: bytes) -> None:
    """Begin a resumable upload, or go on with one."""
    if not written.parts or draw.random() < 0.3:
        written.parts[begin(client, len(clip))] = 0
        return
    place = draw.choice(list(written.parts))
    start = int(client.head(place, headers=TUS).raise_for_status().headers["upload-offset"])
    end = min(len(clip), start + draw.randrange(1, len(clip)))
    answer = send(client, place, start, clip[start:end])
    written.parts[place] = end
    if "content-location" in answer.headers:
        written.clips[answer.headers["content-location"].rpartition("/")[2]] = True
        del written.parts[place]


def begin(client: httpx.Client, size: int, further: dict[str, str] | None = None) -> str:
    """Begin a resumable upload; return its address."""
    headers = {**TUS, "Upload-Length": str(size), **(further or {})}
    begun = client.post(f"{API}/uploads", headers=headers).raise_for_status()
    return str(begun.headers["location"])


def send(client: httpx.Client, place: str, start: int, part: bytes) -> httpx.Response:
    """Send a part of an upload."""
    headers = {**TUS, **OFFSETS, "Upload-Offset": str(start)}
    return client.patch(place, content=part, headers=headers).raise_for_status()


def work(
    address: str, written: Written, client: Client, seed: int, clip: bytes, stop: threading.Event
) -> None:
    """Send changes until the server is gone or the round is over."""
    draw = Random(seed)

    def note(response: httpx.Response) -> None:
        """Remember a change that is acknowledged, other than a part of a file."""
        is_part = response.request.method == "PATCH" and "/uploads/" in response.url.path
        changed = response.request.method not in ("GET", "HEAD") and response.is_success
        if changed and (not is_part or "content-location" in response.headers):
            written.unaudited.add(response.headers["x-request-id"])

    hooks = {"response": [note]}
    with httpx.Client(base_url=address, timeout=30, event_hooks=hooks) as connection:
        while not stop.is_set():
            try:
                client(connection, written, draw, clip)
                written.acknowledged += 1
            except httpx.HTTPStatusError as error:
                if error.response.status_code not in REPEATED:
                    written.lost.append(f"{error.request.method} {error.request.url.path}: {error}")
                time.sleep(0.1)
            except httpx.HTTPError:
                return


@contextmanager
def serving(folder: Path) -> Iterator[tuple[str, subprocess.Popen[str]]]:
    """Run a server; yield its address and process, and kill it at the end."""
    command = [sys.executable, "-c", SERVE, str(folder)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            line = process.stdout.readline()
            assert line, "the server did not start on what the last kill left"
            yield next(word for word in line.split() if word.startswith("http://")), process
        finally:
            process.kill()


def kill_worker(server: int, draw: Random) -> None:
    """Kill one of the processes that a server has started, or one of their descendants."""
    parents = {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            parents[int(stat.parent.name)] = int(stat.read_text().rpartition(")")[2].split()[1])
    workers = [each for each, by in parents.items() if server in (by, parents.get(by))]
    with suppress(ProcessLookupError, IndexError):
        os.kill(draw.choice(workers), signal.SIGKILL)


def check(address: str, folder: Path, written: Written, digests: Collection[str]) -> None:
    """Compare the data of a restarted server with the acknowledged changes.

    `digests`: of the videos that clips may have.
    """
    with httpx.Client(base_url=address, timeout=60) as client:
        _check_languages(client, written)
        _check_clips(client, written, digests)
        _check_parts(client, written)
        _check_audit(client, written)
    _check_files(folder, written)


def _check_languages(client: httpx.Client, written: Written) -> None:
    languages = {each["id"]: each for each in client.get(f"{API}/languages").json()}
    for key, state in written.languages.items():
        found = languages.get(key)
        seen = None if found is None else (found["revision"], found["name"])
        allowed = [state]
        if key in written.attempts and state is not None:
            tried = written.attempts[key]
            allowed.append(None if tried is None else (state[0] + 1, tried))
        if seen not in allowed:
            written.lost.append(f"language {key}: {seen}, allowed were {allowed}")
    # What is stored without an acknowledgement is complete, and is used like the others.
    written.languages = dict.fromkeys(written.languages) | {
        key: (each["revision"], each["name"]) for key, each in languages.items()
    }
    written.attempts.clear()


def _check_clips(client: httpx.Client, written: Written, digests: Collection[str]) -> None:
    clips = {each["id"] for each in client.get(f"{API}/clips").json()}
    for key, kept in written.clips.items():
        if key not in written.changing and kept is not (key in clips):
            written.lost.append(f"clip {key}: kept {kept}, found {key in clips}")
    for key in clips:
        video = client.get(f"{API}/clips/{key}/video").content
        if sha256(video).hexdigest() not in digests:
            written.lost.append(f"clip {key}: other bytes than were sent")
    written.clips = {key: key in clips for key in written.clips.keys() | clips}
    written.changing.clear()


def _check_parts(client: httpx.Client, written: Written) -> None:
    """Ask each upload how far it is, and forget those that have become clips."""
    for place, acknowledged in list(written.parts.items()):
        answer = client.head(place, headers=TUS)
        offset = int(answer.headers.get("upload-offset", -1))
        if offset < acknowledged:
            written.lost.append(f"{place}: {acknowledged} bytes acknowledged, {offset} there")
        if offset < acknowledged or "content-location" in answer.headers:
            del written.parts[place]


def _check_audit(client: httpx.Client, written: Written) -> None:
    """Look for the entries of all acknowledged changes, the newest first."""
    before: dict[str, int] = {}
    while written.unaudited:
        page = client.get(f"{API}/audit", params={"limit": 1000} | before).json()
        written.unaudited -= {entry["request_id"] for entry in page}
        if not page:
            written.lost += [f"audit entry of request {each}" for each in written.unaudited]
            written.unaudited.clear()
            return
        before = {"before": page[-1]["id"]}


def _check_files(folder: Path, written: Written) -> None:
    with closing(sqlite3.connect(folder / "studio.db")) as database:
        (verdict,) = database.execute("PRAGMA quick_check").fetchone()
        rows = {key for (key,) in database.execute("SELECT id FROM clip")}
    if verdict != "ok":
        written.lost.append(f"database: {verdict}")
    for path in (folder / "clips").iterdir():
        # A restarted job may be running.
        if path.name.partition(".")[0] not in rows and not path.name.startswith("."):
            written.lost.append(f"orphan: {path.name}")


def _wait_for_jobs(address: str, written: Written) -> None:
    """Wait until every job has ended; one that is done must have every frame's poses once."""
    with httpx.Client(base_url=address, timeout=60) as client:
        for _ in range(300):
            clips: list[dict[str, Any]] = client.get(f"{API}/clips").json()
            if all(each["status"] in FINAL for each in clips):
                break
            time.sleep(1)
        for each in clips:
            if each["status"] not in FINAL:
                written.lost.append(f"job of clip {each['id']} without an end")
            elif each["status"] == "done":
                found = len(client.get(f"{API}/clips/{each['id']}/poses").json()["time"])
                if found != each["frames"] or found not in (FRAMES, 2 * FRAMES):
                    written.lost.append(f"poses of clip {each['id']}: {found} frames")


def crash(rounds: int, seed: int) -> Written:
    """Run the rounds, and return the acknowledged and lost changes."""
    written, draw = Written(), Random(seed)
    with TemporaryDirectory() as place:
        folder, joined = Path(place) / "data", Path(place) / "joined.mp4"
        clip = small_clip(Path(place) / "dive.mkv", frames=FRAMES)
        join_chapters([(Path(place) / "dive.mkv", None)] * 2, joined)
        digests = {sha256(each).hexdigest() for each in (clip, joined.read_bytes())}
        for _ in range(rounds):
            with serving(folder) as (address, process):
                check(address, folder, written, digests)
                stop = threading.Event()
                threads = [
                    threading.Thread(
                        target=work, args=(address, written, each, draw.random(), clip, stop)
                    )
                    for each in (edit, change_clips, go_on)
                ]
                for thread in threads:
                    thread.start()
                time.sleep(draw.uniform(FEWEST_SECONDS, MOST_SECONDS))
                if draw.random() < 0.5:
                    kill_worker(process.pid, draw)
                    time.sleep(draw.uniform(FEWEST_SECONDS, MOST_SECONDS))
                process.kill()
                stop.set()
                for thread in threads:
                    thread.join()
        with serving(folder) as (address, _):
            check(address, folder, written, digests)
            _wait_for_jobs(address, written)
    return written


def measure_crashes(quick: bool) -> Iterator[Figure]:
    """Yield the share of acknowledged changes that are lost, or that left something behind."""
    rounds = 2 if quick else 20
    written = crash(rounds, seed=1)
    for each in written.lost:
        print(f"lost: {each}", flush=True)
    yield share("lost", len(written.lost), written.acknowledged)
    yield Figure("rounds", rounds, rounds, unit="")


def measurements(folder: Path, methods: tuple[str, ...]) -> Iterator[Measurement]:
    """Yield the rounds."""
    yield Measurement(
        "crashes/sqlite",
        measure_crashes,
        "none",
        "a server killed again and again while clients change languages and clips",
        measures=("app",),
    )
