"""Crash rounds: kills a server and what it uses while clients write, and checks what is left.

``python -m benchmarks.crash --rounds 60`` starts a server on one folder again and again. In each
round five clients upload clips (whole, in parts, and as chapters of one recording), delete clips
and undo that, begin resumable uploads and go on with them, export sessions, create, rename and
delete languages, import language files, invite others, send takes by their links and withdraw
these, until the server is killed by SIGKILL at a random moment, in most rounds after something
else: a worker process, or a part of the backends that ``--with postgres dask s3`` gives the server,
which is then started again. In every tenth round a backup is made meanwhile. After the next start
every acknowledged change and every acknowledged part of an upload must be there, every other change
must be there in full or not at all, the audit log must
hold every acknowledged change, no file may be without its row, and the backup must hold what was
acknowledged before it. At the end every job must have ended, and each one that is done must have
all frames of its clip. The exit code is 1 if anything is lost.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import random
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Collection, Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from typing import Any, Final

import httpx
import pytest

from app.recognition.recording.chapters import join_chapters
from benchmarks.backends import BACKENDS, Backends, backends
from benchmarks.cost.load import SERVE, small_clip
from benchmarks.crash_clients import (
    API,
    GUEST,
    TUS,
    Client,
    Written,
    edit,
    go_on,
    import_file,
    invite,
    upload,
)

DATABASE: Final = "OSG_DATABASE_URL"
"""Environment variable for the URL of a database other than SQLite in the folder."""

FEWEST_SECONDS, MOST_SECONDS = 0.2, 3.0
"""Seconds from the clients' start to a kill: a request takes milliseconds, a job seconds."""

MOST_SURVIVAL_SECONDS = 3.0
"""Seconds that a server may run after another process was killed: it notices within two."""

FRAMES = 10
"""Frames of the uploaded clip."""

FINAL: Final = ("done", "failed", "cancelled")

WORKER: Final = "worker process"

ROUNDS_A_BACKUP: Final = 10


@contextmanager
def serving(folder: Path) -> Iterator[tuple[str, subprocess.Popen[str]]]:
    """Run a server; yield its address and process, and kill it at the end."""
    command = [sys.executable, "-c", SERVE, str(folder)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            line = process.stdout.readline()
            if not line:
                raise SystemExit("the server did not start on what the last kill left")
            yield next(word for word in line.split() if word.startswith("http://")), process
        finally:
            process.kill()


def workers_of(pid: int) -> list[int]:
    """Return the processes that a server has started, and their descendants."""
    parents = {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            parent = stat.read_text().rpartition(")")[2].split()[1]
            parents[int(stat.parent.name)] = int(parent)
    return [each for each, parent in parents.items() if pid in (parent, parents.get(parent))]


def work(address: str, written: Written, client: Client, seed: int, stop: threading.Event) -> None:
    """Send changes until the server is gone or the round is over."""
    draw = random.Random(seed)

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
                client(connection, written, draw)
            except httpx.HTTPStatusError as error:
                if error.response.status_code == 422 and "/languages" not in str(error.request.url):
                    written.refused += 1
                elif error.response.status_code not in (404, 409, 429, 503):
                    written.lost.append(f"{error.request.method} {error.request.url.path}: {error}")
                time.sleep(0.1)
            except httpx.HTTPError:
                return


def check(address: str, folder: Path, written: Written, digests: Collection[str]) -> None:
    """Compare the data of a restarted server with the acknowledged changes.

    `digests`: of the videos that clips may have.
    """
    with httpx.Client(base_url=address, timeout=60) as client:
        found = {each["id"]: each for each in client.get(f"{API}/languages").json()}
        for key, state in written.languages.items():
            _check_language(key, state, found.get(key), written)
        listed = client.get(f"{API}/clips").json()
        # Clips of invited people go when their takes are returned.
        clips = {each["id"] for each in listed if not each["name"].startswith(GUEST)}
        for key, kept in written.clips.items():
            if key in written.deleting:
                written.clips[key] = key in clips
            elif kept is not (key in clips):
                written.lost.append(f"clip {key}: kept {kept}, found {key in clips}")
            elif kept:
                video = client.get(f"{API}/clips/{key}/video").content
                if hashlib.sha256(video).hexdigest() not in digests:
                    written.lost.append(f"clip {key}: other bytes than were sent")
        _check_parts(client, written)
        _check_invitations(client, found, written)
        _check_audit(client, written)
        written.attempts.clear()
        written.deleting.clear()
        # A clip stored without an acknowledgement is complete, and is used like the others.
        for key in clips - written.clips.keys():
            written.clips[key] = True
        for key in found.keys() - written.languages.keys():
            written.languages[key] = found[key]["revision"], found[key]["name"]
    _check_files(folder, written)


def _check_parts(client: httpx.Client, written: Written) -> None:
    """Ask each upload how far it is, and forget those that have become clips."""
    for place, acknowledged in list(written.parts.items()):
        answer = client.head(place, headers=TUS)
        offset = int(answer.headers.get("upload-offset", -1))
        if offset < acknowledged:
            written.lost.append(f"{place}: {acknowledged} bytes acknowledged, {offset} there")
        if offset < acknowledged or "content-location" in answer.headers:
            del written.parts[place]


def _check_invitations(client: httpx.Client, languages: Collection[str], written: Written) -> None:
    """Look for all invitations with their takes; those of a deleted language went with it."""
    for key, (language, token) in list(written.invitations.items()):
        if language not in languages:
            del written.invitations[key]
            continue
        listed = client.get(f"{API}/languages/{language}/invitations").json()
        found = next((each for each in listed if each["id"] == key), None)
        if found is None or (found["closed"] is None) is not (token is not None):
            written.lost.append(f"invitation {key}: withdrawn {token is None}, found {found}")
            continue
        sent = {take for take, invitation in written.takes.items() if invitation == key}
        missing = sent - {take["id"] for take in found["shown"]}
        written.lost += [f"take {take} of invitation {key}" for take in missing]


def _check_audit(client: httpx.Client, written: Written) -> None:
    """Look for the entries of all acknowledged changes, the newest first."""
    before: dict[str, int] = {}
    while written.unaudited:
        page = client.get(f"{API}/audit", params={"limit": 1000} | before).json()
        found = written.unaudited & {entry["request_id"] for entry in page}
        written.audited += len(found)
        written.unaudited -= found
        if not page:
            written.lost += [f"audit entry of request {each}" for each in written.unaudited]
            written.unaudited.clear()
            return
        before = {"before": page[-1]["id"]}


def back_up(folder: Path, written: Written) -> None:
    """Back a running server up, restore the file elsewhere, and compare the two."""
    # What is begun or undone meanwhile may be in the backup or not.
    clips = {key for key, kept in written.clips.items() if kept} - written.deleting
    invitations = {key for key, (_, token) in written.invitations.items() if token}
    file, other = folder.with_name("backup.zip"), folder.with_name("restored")
    for command in (["backup", str(file), str(folder)], ["restore", str(file), str(other)]):
        run = [sys.executable, "-m", "app", *command[:2], "--data-dir", command[2]]
        environment = dict(os.environ)
        if command[0] == "restore":
            environment.pop(DATABASE, None)
            environment.pop("OSG_STORAGE", None)
        ended = subprocess.run(run, env=environment, capture_output=True, text=True, check=False)
        if ended.returncode:
            written.lost.append(f"{command[0]}: {ended.stderr.strip()}")
            return
    with closing(sqlite3.connect(other / "studio.db")) as database:
        rows = {key for (key,) in database.execute("SELECT id FROM clip")}
        links = {key for (key,) in database.execute("SELECT id FROM invitation")}
    written.lost += [f"clip {key} in the backup" for key in clips - rows]
    written.lost += [f"invitation {key} in the backup" for key in invitations - links]
    written.backups += 1
    shutil.rmtree(other)
    file.unlink()


def _check_language(
    key: str, state: tuple[int, str] | None, found: dict[str, object] | None, written: Written
) -> None:
    seen = None if found is None else (found["revision"], found["name"])
    allowed = [state]
    if key in written.attempts and state is not None:
        tried = written.attempts[key]
        allowed.append(None if tried is None else (state[0] + 1, tried))
    if seen not in allowed:
        written.lost.append(f"language {key}: {seen}, allowed were {allowed}")
    else:
        written.languages[key] = allowed[allowed.index(seen)]


def _check_files(folder: Path, written: Written) -> None:
    if DATABASE in os.environ:
        return  # Files without a row stay for a day if another server may be writing them.
    with closing(sqlite3.connect(folder / "studio.db")) as database:
        (verdict,) = database.execute("PRAGMA quick_check").fetchone()
        rows = {key for (key,) in database.execute("SELECT id FROM clip")}
    if verdict != "ok":
        written.lost.append(f"database: {verdict}")
    for path in (folder / "clips").iterdir():
        # A restarted job may be running.
        if path.name.partition(".")[0] not in rows and not path.name.startswith("."):
            written.lost.append(f"orphan: {path.name}")


def crash(
    rounds: int, seed: int, names: Collection[str] = (), longest: float = MOST_SECONDS
) -> Written:
    """Run the rounds with the named backends, and return the acknowledged and lost changes.

    `longest`: most seconds of a round before the first kill.
    """
    written, draw = Written(), random.Random(seed)
    with (
        tempfile.TemporaryDirectory() as place,
        backends(names, Path(place), draw) as beside,
        _environment(beside),
    ):
        folder = Path(place) / "data"
        clip = small_clip(Path(place) / "dive.mkv", frames=FRAMES)
        joined = Path(place) / "joined.mp4"
        join_chapters([(Path(place) / "dive.mkv", None)] * 2, joined)
        digests = {hashlib.sha256(each).hexdigest() for each in (clip, joined.read_bytes())}

        def add(client: httpx.Client, state: Written, chance: random.Random) -> None:
            upload(client, state, chance, clip)

        def add_slowly(client: httpx.Client, state: Written, chance: random.Random) -> None:
            go_on(client, state, chance, clip)

        def ask(client: httpx.Client, state: Written, chance: random.Random) -> None:
            invite(client, state, chance, clip)

        for number in range(rounds):
            with serving(folder) as (address, process):
                check(address, folder, written, digests)
                stop = threading.Event()
                threads = [
                    threading.Thread(
                        target=work, args=(address, written, each, draw.randrange(10**9), stop)
                    )
                    for each in (edit, import_file, add, add_slowly, ask)
                ]
                for thread in threads:
                    thread.start()
                time.sleep(draw.uniform(FEWEST_SECONDS, longest))
                if number % ROUNDS_A_BACKUP == ROUNDS_A_BACKUP - 1:
                    back_up(folder, written)
                written.kills[_kill_beside(process.pid, beside, draw)] += 1
                process.kill()
                stop.set()
                for thread in threads:
                    thread.join()
            if (number + 1) % 10 == 0:
                print(
                    f"{number + 1} rounds, {written.acknowledged} changes acknowledged, "
                    f"{len(written.lost)} lost",
                    flush=True,
                )
        with serving(folder) as (address, _):
            check(address, folder, written, digests)
            _wait_for_jobs(address, written)
    return written


@contextmanager
def _environment(beside: Backends) -> Iterator[None]:
    """Set the environment so that the servers use the backends."""
    with pytest.MonkeyPatch.context() as environment:
        for name, value in beside.environment.items():
            environment.setenv(name, value)
        yield


def _kill_beside(server: int, beside: Backends, draw: random.Random) -> str:
    """Kill nothing or one process beside the server; return what was killed."""
    chosen = draw.choice(["", WORKER, *beside.faults])
    if chosen == WORKER:
        workers = [each for pid in (server, *beside.dask_workers()) for each in workers_of(pid)]
        if not workers:
            return "server"
        with suppress(ProcessLookupError):
            os.kill(draw.choice(workers), signal.SIGKILL)
    elif chosen:
        beside.faults[chosen]()
    else:
        return "server"
    time.sleep(draw.uniform(0, MOST_SURVIVAL_SECONDS))
    return f"{chosen}, then server"


def _wait_for_jobs(address: str, written: Written, seconds: float = 300.0) -> None:
    """Wait until every job has come to an end."""
    end = time.monotonic() + seconds
    with httpx.Client(base_url=address, timeout=60) as client:
        while True:
            clips = client.get(f"{API}/clips").json()
            still = [each["id"] for each in clips if each["status"] not in FINAL]
            if not still:
                _check_ends(client, clips, written)
                return
            if time.monotonic() > end:
                written.lost.append(f"jobs without an end: {still}")
                return
            time.sleep(1)


def _check_ends(client: httpx.Client, clips: list[dict[str, Any]], written: Written) -> None:
    """Record how the jobs ended; one that is done must have every frame's poses exactly once."""
    for each in clips:
        written.ends[each["error_code"] or each["status"]] += 1
        if each["status"] == "done":
            found = len(client.get(f"{API}/clips/{each['id']}/poses").json()["time"])
            if found != each["frames"] or found not in (FRAMES, 2 * FRAMES):
                written.lost.append(f"poses of clip {each['id']}: {found} frames")


def main() -> None:
    """Run the rounds and print what they found."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--rounds", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--with", dest="backends", nargs="+", choices=BACKENDS, default=())
    parser.add_argument(
        "--longest",
        type=float,
        default=MOST_SECONDS,
        help="seconds of a round; more where jobs hardly come to an end, as on a loaded machine",
    )
    given = parser.parse_args()
    written = crash(given.rounds, given.seed, given.backends, given.longest)
    for name, counted in (("kills", written.kills), ("jobs", written.ends)):
        print(f"{name}: {', '.join(f'{each} {number}' for each, number in counted.most_common())}")
    print(
        f"{given.rounds} rounds, {written.acknowledged} changes acknowledged, {written.refused} "
        "uploads refused whose probing process was killed"
    )
    print(f"{written.joined} clips of chapters, {written.undone} deletions undone")
    print(f"{written.audited} audit entries found, {written.backups} backups restored and compared")
    print("\n".join(written.lost) or "nothing lost, no orphan, every job came to an end")
    sys.exit(bool(written.lost))


if __name__ == "__main__":
    main()
