"""Dives from end to end: a robot in its own process, its camera, its page and its vehicle."""

from __future__ import annotations

import signal
import time
from collections.abc import Callable
from pathlib import Path
from urllib.error import HTTPError

import pytest

pytest.importorskip("pymavlink", reason="needs the extra mavlink")

from tests.cli.robots.test_robot import (
    EMERGENCY_TABLE,
    running,
    until,
    until_words,
    upload,
)
from tests.ports import free_port
from tests.robot.mavlink.vehicle import sailing
from tests.short_clips import thinned


@pytest.mark.slow
def test_sigterm_ends_a_robot_whose_vehicle_does_not_answer(
    installed_models: None, sample_clips: Path, thin_clip: Callable[[str], Path], tmp_path: Path
) -> None:
    table = tmp_path / "vehicle.toml"
    table.write_text(EMERGENCY_TABLE.replace("circle", "line"))
    language = sample_clips.parent / "osg-table-2.json"
    with running(
        *("robot", "--language", language, "--source", thin_clip("line-test-1")),
        *("--mavlink", "udpout:127.0.0.1:9", "--vehicle", table),
    ) as process:
        until(process, "take_recognized")
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=30)  # it was 60 seconds and more


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "has_page"),
    [(signal.SIGTERM, False), (signal.SIGINT, True)],
    ids=["alone", "upload"],
)
def test_a_signal_while_the_bridge_closes_ends_the_robot_in_order(
    installed_models: None,
    sample_clips: Path,
    thin_clip: Callable[[str], Path],
    tmp_path: Path,
    number: signal.Signals,
    has_page: bool,
) -> None:
    """The vehicle denies the emergency, so the bridge goes on with it at the end of the clip."""
    table = tmp_path / "vehicle.toml"
    table.write_text(EMERGENCY_TABLE.replace("circle", "line"))
    language = sample_clips.parent / "osg-table-2.json"
    page = ("--page", "127.0.0.1:0", "--upload") if has_page else ()
    with (
        sailing(refused=frozenset({176})) as vehicle,  # MAV_CMD_DO_SET_MODE
        running(
            *("robot", "--language", language, "--source", thin_clip("line-test-1"), *page),
            *("--mavlink", f"udpout:127.0.0.1:{vehicle.port}", "--vehicle", table),
        ) as process,
    ):
        until(process, "source_ended")
        time.sleep(0.3)
        process.send_signal(number)
        _, error = process.communicate(timeout=30)
    assert process.returncode == 0, error
    said = "NOT DONE, robot has ended: surface; DO_SET_MODE SURFACE was sent "
    assert said in " ".join(error.split())


@pytest.mark.slow
def test_an_emergency_that_a_signal_stops_is_told_as_done_when_the_vehicle_shows_it(
    installed_models: None,
    sample_clips: Path,
    thin_clip: Callable[[str], Path],
    tmp_path: Path,
) -> None:
    """The vehicle accepts the mode, and shows it only after the signal."""
    table = tmp_path / "vehicle.toml"
    table.write_text(EMERGENCY_TABLE.replace("circle", "line"))
    language = sample_clips.parent / "osg-table-2.json"
    clip = thinned(sample_clips / "line-test-1.mp4", tmp_path / "long.mp4", 6)
    with (
        sailing(is_slow=True) as vehicle,
        running(
            *("robot", "--language", language, "--source", clip),
            *("--mavlink", f"udpout:127.0.0.1:{vehicle.port}", "--vehicle", table),
        ) as process,
    ):
        until_words(process, "vehicle: EMERGENCY")
        while not vehicle.asked:
            time.sleep(0.01)
        process.send_signal(signal.SIGTERM)
        until_words(process, "vehicle: NOT DONE, robot is stopped")
        vehicle.is_slow = False
        _, error = process.communicate(timeout=30)
    assert process.returncode == 0, error
    assert "done after all: surface" in error
    assert vehicle.mode == 9  # SUB_MODE_SURFACE


@pytest.mark.slow
def test_a_vehicle_table_waits_for_an_emergency_and_ends_an_open_take(
    installed_models: None, sample_clips: Path, tmp_path: Path
) -> None:
    """The dive is a clip: its clock is that of its pictures, whatever else the machine does."""
    table = tmp_path / "vehicle.toml"
    content = EMERGENCY_TABLE.replace("circle", "line")
    table.write_text(content)
    newer = content.replace("version = 1", "version = 1\nstale_seconds = 4.0")
    port = free_port()
    clip = thinned(sample_clips / "line-test-1.mp4", tmp_path / "long.mp4", 12)
    with (
        sailing(is_slow=True) as vehicle,
        running(
            *("robot", "--language", sample_clips.parent / "osg-table-2.json"),
            *("--source", clip, "--page", f"127.0.0.1:{port}", "--upload"),
            *("--mavlink", f"udpout:127.0.0.1:{vehicle.port}", "--vehicle", table),
        ) as process,
    ):
        until_words(process, "vehicle: EMERGENCY")
        with pytest.raises(HTTPError) as refused:
            upload(port, "vehicle", newer.encode())
        assert refused.value.code == 422
        assert "an emergency is in progress" in refused.value.read().decode()
        assert table.read_text() == content
        vehicle.is_slow = False
        until_words(process, "vehicle: done: surface")
        # The recognition begins anew, and an open take commands nothing.
        process.send_signal(signal.SIGHUP)
        until(process, "language_changed")
        while until(process, "state_changed")["state"] != "recording":
            pass
        asked = vehicle.asked
        upload(port, "vehicle", newer.encode())
        ended = until(process, "source_ended")
        assert ended["stopped"]
        assert vehicle.asked == asked
        until(process, "recognition_ready")
        assert table.read_text() == newer
        process.send_signal(signal.SIGTERM)
        _, error = process.communicate(timeout=30)
    assert process.returncode == 1, error  # no take was recognised with the newer table
