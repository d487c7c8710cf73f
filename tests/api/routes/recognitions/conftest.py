"""The tests of a file share one server."""

from tests.api.shared_server import server, settings

__all__ = ["server", "settings"]
