"""Cameras in the network as tests have them: they serve until they are left."""

from __future__ import annotations

import threading
from socketserver import TCPServer

from typing_extensions import Self


class CameraServer:
    """Serves in a thread until it is left; then its connections break, as when a plug is pulled.

    Parameters
    ----------
    server
        What listens; it is closed when this is left.
    off
        Set when this is left, so that who is being served is served no longer.

    """

    def __init__(self, server: TCPServer, off: threading.Event) -> None:
        self._off = off
        self._server = server
        self._thread = threading.Thread(target=server.serve_forever, args=(0.02,))

    @property
    def port(self) -> int:
        """Where it listens."""
        return int(self._server.server_address[1])

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._off.set()
        self._server.shutdown()
        self._thread.join()
        self._server.server_close()
