"""What the tests of several parts of the bridge share."""

import pytest

from app.robot.mavlink import talk


@pytest.fixture
def closes_soon(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let a bridge over real sockets give up an order that nobody answers soon after its end."""
    monkeypatch.setattr(talk, "CLOSE_SECONDS", 0.2)
