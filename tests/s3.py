"""A real S3 over HTTP, in a thread of the tests' own; skipped where moto is not installed."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest

BUCKET = "dives"


class S3Server:
    """An S3 server with one bucket.

    Parameters
    ----------
    port
        Where it listens; 0 lets the system choose, and it stays the same when it begins again.

    """

    def __init__(self, port: int = 0) -> None:
        self.port = port
        self._server: Any = None

    @property
    def address(self) -> str:
        """Its URL."""
        return f"http://127.0.0.1:{self.port}"

    def start(self) -> None:
        """Begin to answer; what it has kept is in the memory of the test's process."""
        from moto.server import ThreadedMotoServer

        self._server = ThreadedMotoServer("127.0.0.1", self.port, verbose=False)
        self._server.start()
        _, self.port = self._server.get_host_and_port()

    def stop(self) -> None:
        """Stop answering."""
        self._server.stop()

    def client(self) -> Any:
        """Return a client of it."""
        import boto3

        return boto3.client("s3", endpoint_url=self.address)

    def names(self) -> set[str]:
        """Return the names of all objects."""
        listed = self.client().list_objects_v2(Bucket=BUCKET)
        return {each["Key"] for each in listed.get("Contents", ())}


@contextmanager
def s3_server(monkeypatch: pytest.MonkeyPatch) -> Iterator[S3Server]:
    """Serve an empty bucket, which the environment names, until the context ends."""
    pytest.importorskip("boto3")
    pytest.importorskip("moto.server")
    server = S3Server()
    monkeypatch.setenv("AWS_ACCESS_KEY_ID", "tests")
    monkeypatch.setenv("AWS_SECRET_ACCESS_KEY", "tests")
    monkeypatch.setenv("AWS_DEFAULT_REGION", "us-east-1")
    server.start()
    monkeypatch.setenv("AWS_ENDPOINT_URL", server.address)
    try:
        server.client().create_bucket(Bucket=BUCKET)
        yield server
        for name in server.names():
            server.client().delete_object(Bucket=BUCKET, Key=name)
    finally:
        server.stop()
