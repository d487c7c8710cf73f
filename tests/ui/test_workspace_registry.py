"""The registry: a limit, a time to live, and nothing left behind."""

from __future__ import annotations

import asyncio
import contextlib
import threading
from collections.abc import Iterator

import pytest

from app.ui import workspace_registry as module
from app.ui.workspace import Workspace
from app.ui.workspace_registry import TooManyWorkspacesError, WorkspaceRegistry


@pytest.fixture
def registry() -> Iterator[WorkspaceRegistry]:
    registry = WorkspaceRegistry(limit=2)
    yield registry
    registry.close()


def test_a_workspace_is_found_by_its_id_until_it_is_removed(registry: WorkspaceRegistry) -> None:
    workspace = registry.create()
    assert registry.get(workspace.id) is workspace
    assert registry.port_of(workspace.id) == workspace.port
    assert registry.remove(workspace.id)
    assert registry.get(workspace.id) is None
    assert registry.port_of(workspace.id) is None
    assert not registry.remove(workspace.id)


def test_ids_cannot_be_guessed_from_one_another(registry: WorkspaceRegistry) -> None:
    ids = {registry.create().id, registry.create().id}
    assert len(ids) == 2
    assert all(len(name) >= 20 for name in ids)


def test_beyond_the_limit_the_one_idle_longest_makes_room(registry: WorkspaceRegistry) -> None:
    registry.ttl = float("inf")
    first, second = registry.create(), registry.create()
    first.last_seen, second.last_seen = 2.0, 1.0
    third = registry.create()
    assert registry.get(second.id) is None
    assert registry.get(first.id) is first
    assert registry.get(third.id) is third


def test_a_workspace_that_a_browser_shows_is_never_taken_away(
    registry: WorkspaceRegistry, monkeypatch: pytest.MonkeyPatch
) -> None:
    registry.create()
    registry.create()
    monkeypatch.setattr(Workspace, "connected", True)
    with pytest.raises(TooManyWorkspacesError, match="2 tabs are open"):
        registry.create()
    registry.close_idle(0)
    assert len(registry) == 2


def test_idle_workspaces_are_swept_away(
    registry: WorkspaceRegistry, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "SWEEP_SECONDS", 0.01)
    registry.ttl = 0.0
    registry.create()

    async def sweep_until_empty() -> None:
        sweeper = asyncio.create_task(registry.sweep())
        while len(registry):
            await asyncio.sleep(0.01)
        sweeper.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await sweeper

    asyncio.run(asyncio.wait_for(sweep_until_empty(), 60))


def test_closing_leaves_no_thread_behind() -> None:
    before = set(threading.enumerate())
    registry = WorkspaceRegistry()
    registry.create()
    registry.create()
    registry.close()
    assert len(registry) == 0
    ours = {"playback", "filmstrip"}
    assert not [t for t in set(threading.enumerate()) - before if t.name in ours]
