"""Dask cluster: runs worker processes on the machines of an existing cluster."""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING, Any, Final
from uuid import uuid4

from app.api.workers.executor import ExecutorLost, Lines

if TYPE_CHECKING:
    from distributed import Client, Future

CONNECT_SECONDS: Final = 5.0
"""Longest time to reach the scheduler."""

LOOK_SECONDS: Final = 1.0
"""Between two looks whether a silent task is still known."""

LAST_LINES_SECONDS: Final = 10.0
"""How long the last lines of a task may take after it has ended: they come by another way."""

logger = logging.getLogger(__name__)


class DaskCluster:
    """Runs worker processes as tasks of a Dask cluster.

    Its machines see the clips' folder under the same path, and have the same version installed.
    Dask runs a task again whose machine vanishes.

    Parameters
    ----------
    address
        The scheduler's ``HOST:PORT``.

    """

    def __init__(self, address: str) -> None:
        self._address = address
        self._topic = f"osg-{uuid4().hex}"
        self._lines: dict[str, asyncio.Queue[tuple[str, str]]] = {}
        self._client: Client | None = None
        self._connecting = asyncio.Lock()

    @asynccontextmanager
    async def start(self, arguments: Sequence[str]) -> AsyncIterator[Lines]:
        """Run a process on a machine that has a place; see `Executor`."""
        from app.api.workers.dask_task import end_worker, run_worker

        client, task = await self._connected(), f"osg-{uuid4().hex}"
        queue = self._lines[task] = asyncio.Queue()
        future = client.submit(run_worker, list(arguments), task, self._topic, key=task, pure=False)
        try:
            lines = _TaskLines(client, future, queue)
            await lines.wait_for_start()
            yield lines
        finally:
            del self._lines[task]
            with contextlib.suppress(Exception):  # The scheduler may be gone, and all with it.
                await asyncio.wait_for(self._end(client, future, end_worker, task), CONNECT_SECONDS)

    async def close(self) -> None:
        """Leave the cluster."""
        if self._client is not None:
            with contextlib.suppress(Exception):
                await asyncio.wait_for(self._client.close(), CONNECT_SECONDS)

    async def _end(self, client: Client, future: Future[None], end_worker: Any, task: str) -> None:
        if not future.done():
            await future.cancel()
            # Cancelling keeps a task from beginning; one that has begun is ended where it runs.
            await client.run(end_worker, task, on_error="ignore")
        future.release()

    async def _connected(self) -> Client:
        """Return a client that has a scheduler, a new one after the former was lost."""
        from distributed import Client

        async with self._connecting:
            if self._client is not None and self._client.status == "running":
                # One that has connected again by itself is subscribed to nothing.
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
        task, kind, line = event[1]
        if task in self._lines:
            self._lines[task].put_nowait((kind, line))


class _TaskLines:
    """The lines that a task tells."""

    def __init__(
        self, client: Client, future: Future[None], queue: asyncio.Queue[tuple[str, str]]
    ) -> None:
        self._client, self._future, self._queue = client, future, queue
        self._silence = 0.0

    async def wait_for_start(self) -> None:
        """Wait until the task has a place and begins."""
        from app.api.workers.dask_task import STARTED

        while (await self._next())[0] != STARTED:
            pass

    async def readline(self) -> bytes:
        """Return the next line; see `Lines`."""
        from app.api.workers.dask_task import ENDED, LINE

        while True:
            kind, line = await self._next()
            if kind == LINE:
                return line.encode()
            if kind == ENDED:
                return b""
            # Begun again on another machine: what it tells is told again.

    async def _next(self) -> tuple[str, str]:
        from app.api.workers.dask_task import ENDED

        while True:
            with contextlib.suppress(TimeoutError):
                told = await asyncio.wait_for(self._queue.get(), LOOK_SECONDS)
                self._silence = 0.0
                return told
            self._silence += LOOK_SECONDS
            if self._client.status != "running" or self._future.status in ("cancelled", "lost"):
                raise ExecutorLost("the Dask scheduler is gone")
            if self._future.status == "error":
                # It took several machines with it: what it does to them it does again.
                logger.warning("a task of the Dask cluster failed: %s", self._future.key)
                return ENDED, ""
            if self._future.status == "finished" and self._silence > LAST_LINES_SECONDS:
                raise ExecutorLost("the last lines of a task were not heard")
