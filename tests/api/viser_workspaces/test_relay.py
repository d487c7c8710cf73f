"""The relay: viser behind our own port, for our own pages only."""

import asyncio

import httpx
import pytest
import websockets
from websockets.exceptions import ConnectionClosed, InvalidHandshake
from websockets.typing import Origin, Subprotocol

from tests.api.running import Running

PROTOCOL = Subprotocol("viser-v1.1.1")


@pytest.fixture
def workspace_id(client: httpx.Client) -> str:
    """Return the id of an open workspace."""
    return str(client.post("/api/v1/workspaces").json()["id"])


def socket_of(server: Running, workspace_id: str) -> str:
    return f"{server.address.replace('http', 'ws')}/viser/{workspace_id}"


async def first_message(url: str, origin: str | None) -> tuple[str | None, bytes]:
    """Open a websocket, and return the subprotocol agreed on and the first message."""
    async with websockets.connect(
        url,
        origin=None if origin is None else Origin(origin),
        subprotocols=[PROTOCOL],
        max_size=None,
        proxy=None,
        open_timeout=60,
    ) as connection:
        message = await asyncio.wait_for(connection.recv(), 60)
        return connection.subprotocol, message if isinstance(message, bytes) else message.encode()


def test_messages_and_subprotocol_pass_through(server: Running, workspace_id: str) -> None:
    subprotocol, message = asyncio.run(
        first_message(socket_of(server, workspace_id), server.address)
    )
    assert subprotocol == PROTOCOL
    assert len(message) > 0


def test_a_workspace_that_is_not_there_is_refused(server: Running) -> None:
    with pytest.raises((InvalidHandshake, ConnectionClosed)):
        asyncio.run(first_message(socket_of(server, "nothing"), server.address))


def test_closing_the_workspace_closes_its_websocket(
    server: Running, client: httpx.Client, workspace_id: str
) -> None:
    async def outlive() -> None:
        url = socket_of(server, workspace_id)
        async with websockets.connect(
            url, subprotocols=[PROTOCOL], max_size=None, proxy=None, open_timeout=60
        ) as connection:
            await asyncio.wait_for(connection.recv(), 60)
            await asyncio.to_thread(client.delete, f"/api/v1/workspaces/{workspace_id}")
            while True:
                await asyncio.wait_for(connection.recv(), 60)

    with pytest.raises(ConnectionClosed):
        asyncio.run(outlive())


def test_visers_page_may_talk_to_this_server_only(client: httpx.Client, workspace_id: str) -> None:
    policy = client.get(f"/viser/{workspace_id}/").headers["content-security-policy"]
    directives = dict(part.strip().split(" ", 1) for part in policy.split(";"))
    assert directives["connect-src"] == "'self' data: blob:"
    assert "'unsafe-inline'" in directives["script-src"]
    assert directives["frame-ancestors"] == "'self'"
    assert directives["default-src"] == "'none'"
