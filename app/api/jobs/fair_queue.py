"""Fair queue: round robin between clients, first in first out within each."""

from __future__ import annotations

import asyncio
from collections import OrderedDict, deque


class FairQueue:
    """Ids of waiting jobs by client; a client with a hundred jobs does not delay the others."""

    def __init__(self) -> None:
        self._waiting: OrderedDict[str, deque[str]] = OrderedDict()
        self._known: set[str] = set()
        self._changed = asyncio.Condition()

    async def put(self, client: str, job_id: str) -> None:
        """Add a job at the end of its client's queue, unless it is in it already."""
        async with self._changed:
            if job_id in self._known:
                return
            self._known.add(job_id)
            self._waiting.setdefault(client, deque()).append(job_id)
            self._changed.notify()

    async def get(self) -> str:
        """Take the next job, waiting for one."""
        async with self._changed:
            await self._changed.wait_for(lambda: self._waiting)
            client, jobs = next(iter(self._waiting.items()))
            job_id = jobs.popleft()
            self._known.discard(job_id)
            if jobs:
                self._waiting.move_to_end(client)
            else:
                del self._waiting[client]
            return job_id
