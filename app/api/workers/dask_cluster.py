"""Dask cluster: runs worker processes on the machines of an existing cluster."""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections.abc import AsyncIterator, Iterable, Sequence
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING, Any, Final
from uuid import uuid4

from app.api.workers.executor import ExecutorLost, Lines, TaskFiles
from app.api.workers.rights import rights_to
from app.api.workers.task_folders import Contents, OwnFolders

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

Told = tuple[str, Any]
"""Message of a task: its kind, and a line or a file."""

logger = logging.getLogger(__name__)


class DaskCluster:
    """Runs worker processes as tasks of a Dask cluster.

    Its machines must have the same version installed, and access to the clips' folder under the
    same path or to the object store of the clips. Dask repeats a task whose machine vanishes.

    Parameters
    ----------
    address
        The scheduler's ``HOST:PORT``.
    own
        The server's folders, if the machines of the cluster do not see them.

    """

    def __init__(self, address: str, own: OwnFolders | None = None) -> None:
        self._address = address
        self._own = own
        self._topic = f"osg-{uuid4().hex}"
        self._lines: dict[str, asyncio.Queue[Told]] = {}
        self._client: Client | None = None
        self._connecting = asyncio.Lock()

    @asynccontextmanager
    async def start(self, arguments: Sequence[str], files: TaskFiles) -> AsyncIterator[Lines]:
        """Run a process on a machine with a free place; see `Executor`."""
        from app.api.workers.dask_task import end_worker, run_worker

        workspace = None
        if self._own is not None:
            workspace = await asyncio.to_thread(self._own.describe, files)
        client, task = await self._connected(), f"osg-{uuid4().hex}"
        queue = self._lines[task] = asyncio.Queue()
        given = ([*rights_to(files), *arguments], task, self._topic, workspace)
        future = client.submit(run_worker, *given, key=task, pure=False)
        try:
            lines = _TaskLines(client, future, queue, self._own)
            await lines.wait_for_start()
            yield lines
        finally:
            del self._lines[task]
            with contextlib.suppress(Exception):  # The scheduler may be gone.
                await asyncio.wait_for(self._end(client, future, end_worker, task), CONNECT_SECONDS)

    async def close(self) -> None:
        """Leave the cluster."""
        if self._client is not None:
            with contextlib.suppress(Exception):
                await asyncio.wait_for(self._client.close(), CONNECT_SECONDS)

    async def _end(
        self, client: Client, future: Future[Contents], end_worker: Any, task: str
    ) -> None:
        if not future.done():
            await future.cancel()
            # Cancelling only keeps a task from beginning; a running task is ended where it runs.
            await client.run(end_worker, task, on_error="ignore")
        future.release()

    async def _connected(self) -> Client:
        """Return a client that is connected to the scheduler; a new one after a lost connection."""
        from distributed import Client

        async with self._connecting:
            if self._client is not None and self._client.status == "running":
                # A client that has reconnected by itself has lost its subscriptions.
                self._client.subscribe_topic(self._topic, self._hear)
                return self._client
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
            self._client.subscribe_topic(self._topic, self._hear)
            return self._client

    def _hear(self, event: tuple[float, Any]) -> None:
        task, kind, content = event[1]
        if task in self._lines:
            self._lines[task].put_nowait((kind, content))


class _TaskLines:
    """The lines that a task sends."""

    def __init__(
        self,
        client: Client,
        future: Future[Contents],
        queue: asyncio.Queue[Told],
        own: OwnFolders | None,
    ) -> None:
        self._client, self._future, self._queue, self._own = client, future, queue, own
        self._silence = 0.0
        self._machine: str | None = None
        self._held: str | None = None
        self._ended = False

    async def wait_for_start(self) -> None:
        """Wait until the task has a place and begins."""
        from app.api.workers.dask_task import ENDED, LOST, STARTED

        while True:
            kind, content = await self._next()
            if kind == LOST:
                raise ExecutorLost(content)
            if kind == ENDED:
                self._ended = True
            if kind in (STARTED, ENDED):
                return

    async def readline(self, silence_seconds: float | None = None) -> bytes:
        """Return the next line; see `Lines`."""
        from app.api.workers.dask_task import ENDED, FILE, LINE, LOST

        while not self._ended:
            kind, content = await self._next(silence_seconds)
            if kind == LINE and self._own is None:
                return str(content).encode()
            if kind == LINE:
                # The last line says that all is written, but large files arrive after it.
                held, self._held = self._held, content
                if held is not None:
                    return held.encode()
            elif kind == FILE:
                await self._put([content])
            elif kind == LOST:
                raise ExecutorLost(content)
            elif kind == ENDED:
                self._ended = True
                if self._own is not None:
                    await self._put((await self._result()).items())
            # The task was restarted on another machine and repeats its messages.
        held, self._held = self._held, None
        return b"" if held is None else held.encode()

    async def _result(self) -> Contents:
        """Return the files that a task returns at its end."""
        if self._future.status == "error":
            return {}
        try:
            found: Contents = await asyncio.wait_for(self._future, RESULT_SECONDS)
        except Exception as error:
            raise ExecutorLost(f"what a task has written did not come: {error}") from error
        return found

    async def _put(self, files: Iterable[tuple[str, bytes]]) -> None:
        """Write files where the process would have written them on this machine."""
        assert self._own is not None
        for path, content in files:
            await asyncio.to_thread(self._own.put, path, content)

    async def _next(self, silence_seconds: float | None = None) -> Told:
        from app.api.workers.dask_task import ENDED, STARTED

        while True:
            with contextlib.suppress(TimeoutError):
                kind, content = await asyncio.wait_for(self._queue.get(), LOOK_SECONDS)
                self._silence = 0.0
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
