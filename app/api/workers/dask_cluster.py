"""Dask cluster: runs worker processes on the machines of an existing cluster.

Where the clips are in an object store, its machines share no folder with the server. A task then
creates its own folder, copies the input files of its process into it, runs the process there as if
it were the server's folder, and returns the output files to the server.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import logging
import subprocess
import sys
import tempfile
from collections.abc import AsyncIterator, Iterable, Iterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final
from uuid import uuid4

from app.api.workers.executor import COMMAND, PACKAGE_PARENT, ExecutorLost, Lines, Order, TaskFiles
from app.api.workers.rights import environment_of_workers, line_of
from app.store.atomic_files import PARTIAL_SUFFIX
from app.store.database import StoreUnavailable
from app.store.models import new_id
from app.store.objects import open_object_store

if TYPE_CHECKING:
    from distributed import Client, Future

CONNECT_SECONDS: Final = 5.0
"""Longest time to reach the scheduler."""

LOOK_SECONDS: Final = 1.0
"""Seconds between two checks whether the scheduler still knows a silent task."""

LAST_LINES_SECONDS: Final = 10.0
"""Longest delay in seconds of a task's last lines after its end: they arrive by another channel."""

RESULT_SECONDS: Final = 600.0
"""Longest transfer of a task's files in seconds; a video of a gigabyte takes a minute."""

STARTED, LINE, FILES, ENDED, LOST = "started", "line", "files", "ended", "lost"
"""Kinds of what a task tells; `LOST` means that the clip cannot be fetched now."""

MOST_TOLD = 64 * 1024
"""Most bytes of a file that is told: the scheduler keeps the newest thousand messages."""

Contents = dict[str, bytes]
"""Files by their paths under the server's folder, with ``/`` between."""

_processes: dict[str, subprocess.Popen[bytes]] = {}
"""Running processes of this Dask worker, by task."""

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class OwnFolder:
    """The server's data folder, which no other machine sees.

    Attributes
    ----------
    root
        The folder, which a task's folder replaces on its machine.
    clips
        The folder of its copies of clips, in `root`.
    storage
        Address of the object store that has the clips' files.

    """

    root: Path
    clips: Path
    storage: str

    def prepare(self, order: Order, folder: Path) -> Order:
        """Fill a task's folder with the files of clips that it reads; return its order there.

        Raises
        ------
        StoreUnavailable
            When the object store does not answer, or has no such file.

        """

        def moved(path: Path) -> Path:
            there = folder / path.relative_to(self.root)
            there.parent.mkdir(parents=True, exist_ok=True)
            return there

        files, objects = order.files, open_object_store(self.storage)
        for path in files.inputs:
            name = path.relative_to(self.clips).as_posix()
            if not objects.download(name, moved(path)):
                raise StoreUnavailable(f"{self.storage} holds no {name}")
        scratch = moved(order.scratch)
        scratch.mkdir()
        return replace(
            order,
            task=order.task.replace(_quoted(self.root), _quoted(folder)),
            files=TaskFiles(*(tuple(map(moved, each)) for each in (files.inputs, files.outputs))),
            scratch=scratch,
        )

    def put(self, contents: Contents) -> None:
        """Write files that a task returned, in place of earlier ones."""
        for path, content in contents.items():
            target = self.root / path
            if not target.parent.is_dir():
                continue  # The clip or the waiting request is gone.
            partial = target.with_name(f".{target.name}.{new_id()}{PARTIAL_SUFFIX}")
            try:
                partial.write_bytes(content)
                partial.replace(target)
            finally:
                partial.unlink(missing_ok=True)


def _quoted(path: Path) -> str:
    """Return a path as it is written in a JSON document."""
    return json.dumps(str(path), ensure_ascii=False)[1:-1]


def run_worker(order: Order, task: str, topic: str, own: OwnFolder | None) -> Contents:
    """Run an order's process to its end on a Dask worker; tell its lines under `topic`.

    If the server's folder is not seen here, the files that the process has written are returned,
    and small ones, such as the clip's first picture, are told before the line that follows them.
    """
    from distributed import get_worker

    def tell(kind: str, content: str | Contents) -> None:
        get_worker().log_event(topic, (task, kind, content))

    written = Contents()
    with tempfile.TemporaryDirectory(prefix="osg-task-") as folder:
        if own is not None:
            try:
                order = own.prepare(order, Path(folder))
            except StoreUnavailable as error:
                tell(LOST, str(error))
                return {}
        tell(STARTED, get_worker().address)
        waiting = order.files.outputs if own is not None else ()
        for line in _lines(order, task):
            small = [
                path for path in waiting if path.is_file() and path.stat().st_size <= MOST_TOLD
            ]
            if small:
                tell(FILES, _contents(small, folder))
                waiting = tuple(path for path in waiting if path not in small)
            tell(LINE, line)
        if own is not None:
            written = _contents(order.files.outputs, folder)
    tell(ENDED, "")
    return written


def _contents(files: Iterable[Path], folder: str) -> Contents:
    """Return those of the files in a task's folder that are written."""
    written = [path for path in files if path.is_file()]
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in written}


def _lines(order: Order, task: str) -> Iterator[str]:
    """Yield the lines of a worker process."""
    process = subprocess.Popen(
        [sys.executable, *COMMAND],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        cwd=PACKAGE_PARENT,
        env=environment_of_workers(),
    )
    _processes[task] = process
    try:
        assert process.stdin is not None
        assert process.stdout is not None
        with contextlib.suppress(BrokenPipeError):  # It has ended already.
            process.stdin.write(line_of(order))
            process.stdin.flush()
        for line in process.stdout:
            yield line.decode()
    finally:
        _processes.pop(task, None)
        process.kill()
        process.wait()


def end_worker(task: str) -> None:
    """End the process of a task, where it runs on this Dask worker."""
    if (process := _processes.get(task)) is not None:
        process.kill()


class DaskCluster:
    """Runs worker processes as tasks of a Dask cluster.

    Its machines must have the same version installed, and access to the clips' folder under the
    same path or to the object store of the clips. Dask repeats a task whose machine vanishes.

    Parameters
    ----------
    address
        The scheduler's ``HOST:PORT``.
    own
        The server's folder, if the machines of the cluster do not see it.

    """

    def __init__(self, address: str, own: OwnFolder | None = None) -> None:
        self._address = address
        self._own = own
        self._topic = f"osg-{uuid4().hex}"
        self._told: dict[str, asyncio.Queue[tuple[str, Any]]] = {}
        self._client: Client | None = None
        self._connecting = asyncio.Lock()

    @asynccontextmanager
    async def start(self, order: Order) -> AsyncIterator[Lines]:
        """Run a task on a machine with a free place; see `Executor`."""
        client, task = await self._connected(), f"osg-{uuid4().hex}"
        told = self._told[task] = asyncio.Queue()
        given = (order, task, self._topic, self._own)
        future = client.submit(run_worker, *given, key=task, pure=False)
        try:
            yield _TaskLines(client, future, told, self._own)
        finally:
            del self._told[task]
            with contextlib.suppress(Exception):  # The scheduler may be gone.
                await asyncio.wait_for(self._end(client, future, task), CONNECT_SECONDS)

    async def close(self) -> None:
        """Leave the cluster."""
        if self._client is not None:
            with contextlib.suppress(Exception):
                await asyncio.wait_for(self._client.close(), CONNECT_SECONDS)

    async def _end(self, client: Client, future: Future[Contents], task: str) -> None:
        if not future.done():
            await future.cancel()
            # Cancelling only keeps a task from beginning; a running task is ended where it runs.
            await client.run(end_worker, task, on_error="ignore")
        future.release()

    async def _connected(self) -> Client:
        """Return a client that is connected to the scheduler; a new one after a lost connection."""
        from distributed import Client

        async with self._connecting:
            if self._client is None or self._client.status != "running":
                await self.close()
                try:
                    self._client = await Client(
                        f"tcp://{self._address}",
                        asynchronous=True,
                        set_as_default=False,
                        timeout=CONNECT_SECONDS,
                        name="osg-studio",
                    )
                except (OSError, TimeoutError) as error:
                    self._client = None
                    raise ExecutorLost(f"no Dask scheduler answers at {self._address}") from error
            # Each time: a client that has reconnected by itself has lost its subscriptions.
            self._client.subscribe_topic(self._topic, self._hear)
            return self._client

    def _hear(self, event: tuple[float, Any]) -> None:
        task, kind, content = event[1]
        if task in self._told:
            self._told[task].put_nowait((kind, content))


class _TaskLines:
    """The lines that a task tells."""

    def __init__(
        self,
        client: Client,
        future: Future[Contents],
        told: asyncio.Queue[tuple[str, Any]],
        own: OwnFolder | None,
    ) -> None:
        self._client, self._future, self._told, self._own = client, future, told, own
        self._silence = 0.0
        self._machine: str | None = None
        self._held = b""
        self._ended = False

    async def readline(self, silence_seconds: float | None = None) -> bytes:
        """Return the next line; see `Lines`."""
        while not self._ended:
            kind, content = await self._next(silence_seconds)
            if kind == LINE and self._own is None:
                return str(content).encode()
            if kind == LINE:
                # The last line says that all is written, but large files arrive after it.
                held, self._held = self._held, str(content).encode()
                if held:
                    return held
            elif kind == FILES and self._own is not None:
                await asyncio.to_thread(self._own.put, content)
            elif kind == ENDED:
                self._ended = True
                await self._put_result()
            # The task was restarted on another machine and repeats its messages.
        held, self._held = self._held, b""
        return held

    async def _put_result(self) -> None:
        """Write the files that a task returns at its end, if they are not where they belong."""
        if self._own is None or self._future.status == "error":
            return
        try:
            found: Contents = await asyncio.wait_for(self._future, RESULT_SECONDS)
        except Exception as error:
            raise ExecutorLost(f"what a task has written did not come: {error}") from error
        await asyncio.to_thread(self._own.put, found)

    async def _next(self, silence_seconds: float | None = None) -> tuple[str, Any]:
        while True:
            with contextlib.suppress(TimeoutError):
                kind, content = await asyncio.wait_for(self._told.get(), LOOK_SECONDS)
                self._silence = 0.0
                if kind == LOST:
                    raise ExecutorLost(content)
                if kind == STARTED:
                    self._machine = content
                return kind, content
            self._silence += LOOK_SECONDS
            if await self._waits_for_a_place():
                self._silence = 0.0
            elif silence_seconds is not None and self._silence > silence_seconds:
                raise TimeoutError
            if self._client.status != "running" or self._future.status in ("cancelled", "lost"):
                raise ExecutorLost("the Dask scheduler is gone")
            if self._future.status == "error":
                # The task has crashed several machines, and would do so again.
                reason = await self._future.exception()
                logger.warning("a task of the Dask cluster failed: %r", reason)
                return ENDED, ""
            if self._future.status == "finished" and self._silence > LAST_LINES_SECONDS:
                raise ExecutorLost("the last lines of a task were not heard")

    async def _waits_for_a_place(self) -> bool:
        """Return whether the task runs nowhere: it has not begun, or its machine is gone."""
        if self._machine is not None and self._client.status == "running":
            with contextlib.suppress(OSError, TimeoutError):
                places = self._client.ncores(workers=[self._machine])
                if not (await asyncio.wait_for(places, CONNECT_SECONDS)).get(self._machine):
                    self._machine = None
        return self._machine is None and self._future.status == "pending"
