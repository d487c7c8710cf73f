"""Workspace registry: limits the open workspaces and closes idle ones."""

from __future__ import annotations

import asyncio
import time as clock
from threading import Lock

from app.ui.workspace import Workspace

SWEEP_SECONDS = 15.0
"""Seconds between two searches for idle workspaces, which live for minutes."""


class TooManyWorkspacesError(RuntimeError):
    """Raised when as many workspaces are open as the registry allows."""


class WorkspaceRegistry:
    """All open workspaces.

    Parameters
    ----------
    limit
        Most open workspaces. Each costs a thread or two and, with a clip on display, 10 MB.
    ttl
        Seconds for which a workspace without a connected browser is kept: a reload, or a laptop's
        nap.

    """

    def __init__(self, limit: int = 32, ttl: float = 600.0) -> None:
        self.limit, self.ttl = limit, ttl
        self._lock = Lock()
        self._workspaces: dict[str, Workspace] = {}

    def create(self, *, owner: str = "", dark: bool = True) -> Workspace:
        """Open a workspace of a name; when the limit is reached, the one idle longest makes room.

        Raises
        ------
        TooManyWorkspacesError
            When the limit is reached and a browser shows each of them.

        """
        self.close_idle(self.ttl)
        with self._lock:
            full = len(self._workspaces) >= self.limit
            idle = [w for w in self._workspaces.values() if not w.connected] if full else []
        if full and not idle:
            raise TooManyWorkspacesError(
                f"{self.limit} tabs are open, as many as this server takes; close one of them"
            )
        if full:
            self.remove(min(idle, key=lambda workspace: workspace.last_seen).id)
        workspace = Workspace(owner=owner, dark=dark)
        with self._lock:
            self._workspaces[workspace.id] = workspace
        return workspace

    def get(self, name: str, owner: str = "") -> Workspace | None:
        """Return an open workspace of a name, counted as used; None if it has no such one."""
        with self._lock:
            workspace = self._workspaces.get(name)
        if workspace is None or workspace.owner != owner:
            return None
        workspace.last_seen = clock.monotonic()
        return workspace

    def port_of(self, name: str, owner: str = "") -> int | None:
        """Return the loopback port of a workspace's viser server; None as in `get`."""
        workspace = self.get(name, owner)
        return None if workspace is None else workspace.port

    def remove(self, name: str) -> bool:
        """Close a workspace; False when there is none of that name."""
        with self._lock:
            workspace = self._workspaces.pop(name, None)
        if workspace is None:
            return False
        workspace.close()
        return True

    def close_idle(self, seconds: float) -> None:
        """Close the workspaces that no browser has shown for `seconds`."""
        with self._lock:
            workspaces = list(self._workspaces.values())
        for workspace in workspaces:
            if workspace.connected:
                workspace.last_seen = clock.monotonic()
            elif clock.monotonic() - workspace.last_seen > seconds:
                self.remove(workspace.id)

    async def sweep(self) -> None:
        """Close idle workspaces again and again; runs until it is cancelled."""
        while True:
            await asyncio.sleep(SWEEP_SECONDS)
            await asyncio.to_thread(self.close_idle, self.ttl)

    def close(self) -> None:
        """Close all workspaces."""
        for workspace in list(self._workspaces.values()):
            self.remove(workspace.id)

    def __len__(self) -> int:
        """Count the open workspaces."""
        return len(self._workspaces)
