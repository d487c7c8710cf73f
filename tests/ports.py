"""Ports of this machine for servers and cameras that the tests start."""

from __future__ import annotations

import random
import socket
from contextlib import ExitStack, suppress

LOWEST, HIGHEST = 20_000, 32_000
"""Below the ports that systems give to sockets without one of their own; tests open many."""


def free_port() -> int:
    """Return a port that nobody has for TCP or UDP, nor the next one for UDP, which RTCP takes."""
    # Workers must not choose alike, whatever seeds their generators.
    choice = random.SystemRandom()
    while True:
        port = choice.randrange(LOWEST, HIGHEST, 2)
        wanted = [(socket.SOCK_STREAM, port), (socket.SOCK_DGRAM, port)]
        with suppress(OSError), ExitStack() as stack:
            for kind, number in (*wanted, (socket.SOCK_DGRAM, port + 1)):
                stack.enter_context(socket.socket(socket.AF_INET, kind)).bind(("", number))
            return port
