"""Network cameras for tests: they serve until their context ends."""

from __future__ import annotations

import threading
from socketserver import TCPServer

from typing_extensions import Self


class CameraServer:
    """Serves in a thread until its context ends; then its connections break, as if unplugged.

    Parameters
    ----------
    server
        The listening server; closed when the context ends.
    off
        Set when the context ends, so that serving stops.

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
