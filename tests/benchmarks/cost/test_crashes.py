"""Crash rounds: whatever a server loses is seen."""

from __future__ import annotations

from pathlib import Path

from app.settings import Settings
from benchmarks.cost.crashes import Written, check
from tests.api.running import running


def test_whatever_is_missing_after_a_start_is_named(tmp_path: Path) -> None:
    written = Written(
        languages={"1" * 32: (1, "pool"), "2" * 32: None, "3" * 32: (2, "reef")},
        attempts={"3" * 32: None},
        clips={"4" * 32: True, "5" * 32: False, "6" * 32: True},
        changing={"6" * 32},
        parts={f"/api/v1/uploads/{'7' * 32}": 10},
        unaudited={"8" * 32},
    )
    settings = Settings(data_dir=tmp_path, samples_dir=tmp_path / "none")
    with running(settings) as server:
        (tmp_path / "clips" / f"{'9' * 32}.mp4").write_bytes(b"video")
        check(server.address, tmp_path, written, ())
    assert [each.partition(":")[0] for each in written.lost] == [
        f"language {'1' * 32}",
        f"clip {'4' * 32}",
        f"/api/v1/uploads/{'7' * 32}",
        f"audit entry of request {'8' * 32}",
        "orphan",
    ]
    written.lost.clear()
    with running(settings) as server:
        (tmp_path / "clips" / f"{'9' * 32}.mp4").unlink(missing_ok=True)
        check(server.address, tmp_path, written, ())
    assert written.lost == [], "what was missing is known, and is not looked for again"
