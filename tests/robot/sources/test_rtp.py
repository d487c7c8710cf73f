"""RTP: a vehicle's camera is watched by its port or its description, and silence is one line."""

from __future__ import annotations

import socket
import threading
import time
from contextlib import closing
from itertools import islice
from pathlib import Path

import pytest

from app.recognition.errors import SourceError
from app.robot import Frame, Source, SourceLost
from app.robot.sources import cameras
from app.robot.sources.cameras import DESCRIPTION
from app.robot.sources.registry import open_source
from tests.ports import free_port
from tests.robot.mjpeg_server import FRAME_SIZE
from tests.robot.rtp_camera import RtpCamera


@pytest.fixture
def port(monkeypatch: pytest.MonkeyPatch) -> int:
    monkeypatch.setattr(cameras, "SILENT_SECONDS", 0.5)
    return free_port()


def describe(port: int, tmp_path: Path) -> str:
    file = tmp_path / "camera.sdp"
    file.write_text(
        DESCRIPTION.format(group="127.0.0.1", port=port, kind=96, encoding="H264/90000")
    )
    return str(file)


@pytest.mark.parametrize("form", ["udp://@:{}", "sdp"])
def test_a_camera_that_sends_rtp_is_watched_until_it_is_gone(
    form: str, port: int, tmp_path: Path
) -> None:
    address = describe(port, tmp_path) if form == "sdp" else form.format(port)
    with RtpCamera(port, brightness=100):
        source = open_source(address)
        given = iter(source)
        seen = list(islice((each for each in given if isinstance(each, Frame)), 3))
    with closing(source):
        lost = next(each for each in given if isinstance(each, SourceLost))
    assert source.live
    assert source.frame_size == FRAME_SIZE
    assert [frame.image.mean() for frame in seen] == pytest.approx([100] * 3, abs=2)
    assert str(port) in lost.reason or "camera.sdp" in lost.reason


def test_a_transport_stream_is_watched_too(port: int) -> None:
    with RtpCamera(port, form="mpegts"), closing(open_source(f"udp://0.0.0.0:{port}")) as source:
        assert source.frame_size == FRAME_SIZE


@pytest.mark.parametrize("form", ["rtp", "mpegts"])
@pytest.mark.parametrize("named", ["127.0.0.1", "0.0.0.0"])
def test_the_first_sender_alone_is_watched_on_the_address_that_is_named(
    port: int, form: str, named: str
) -> None:
    with (
        RtpCamera(port, brightness=100, form=form),
        closing(open_source(f"udp://{named}:{port}")) as source,
        RtpCamera(port, brightness=240, form=form, host="127.0.0.5"),
    ):
        address = "".join(f"{int(part):02X}" for part in reversed(named.split(".")))
        sockets = Path("/proc/net/udp").read_text()
        assert f"{address}:{port:04X} " in sockets
        given = (each for each in source if isinstance(each, Frame))
        brightness = {round(frame.image.mean() / 10) for frame in islice(given, 30)}
    assert brightness == {10}


@pytest.mark.parametrize("form", ["udp://@:{}", "sdp"])
def test_a_program_that_has_the_port_of_rtcp_is_told(form: str, port: int, tmp_path: Path) -> None:
    address = describe(port, tmp_path) if form == "sdp" else form.format(port)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other, RtpCamera(port):
        other.bind(("127.0.0.1", port + 1))
        with pytest.raises(SourceError, match=rf"UDP port {port + 1}, .* beside {port}, cannot"):
            open_source(address)


def test_a_sender_that_is_named_is_waited_for(port: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cameras, "_sort_host", lambda host: (None, "", host))
    monkeypatch.setattr(cameras, "OPEN_SECONDS", 0.5)
    with (
        RtpCamera(port, host="127.0.0.5"),
        pytest.raises(SourceError, match=rf"nothing arrived on UDP port {port} from 127.0.0.6"),
    ):
        open_source(f"udp://127.0.0.6:{port}")
    monkeypatch.setattr(cameras, "OPEN_SECONDS", 10.0)
    with (
        RtpCamera(port, host="127.0.0.5"),
        closing(open_source(f"udp://127.0.0.5:{port}")) as source,
    ):
        assert source.frame_size == FRAME_SIZE


def test_one_packet_of_a_stranger_does_not_decide_what_the_stream_is(port: int) -> None:
    opened: list[Source] = []
    thread = threading.Thread(target=lambda: opened.append(open_source(f"udp://0.0.0.0:{port}")))
    thread.start()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
        stranger.bind(("127.0.0.9", 0))
        motion_jpeg = bytes([0x80, 26, *bytes(30)])
        while f":{port:04X} " not in Path("/proc/net/udp").read_text():
            time.sleep(0.01)
        for packet in (motion_jpeg, b"x"):
            stranger.sendto(packet, ("127.0.0.1", port))
    with RtpCamera(port):
        thread.join()
        with closing(opened[0]) as source:
            assert source.frame_size == FRAME_SIZE


@pytest.mark.parametrize("form", ["udp://0.0.0.0:{}", "rtp://192.168.2.2:{}", "sdp"])
def test_a_port_on_which_nothing_arrives_is_told_in_time(
    form: str, port: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cameras, "OPEN_SECONDS", 0.1)
    address = describe(port, tmp_path) if form == "sdp" else form.format(port)
    with pytest.raises(
        SourceError, match=rf"nothing arrived on UDP port {port}( from 192.168.2.2)? for 0.1 s"
    ):
        open_source(address)


def test_packets_that_are_no_video_are_told(port: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cameras, "OPEN_SECONDS", 0.5)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        over = threading.Event()

        def send() -> None:
            number = 0
            while not over.wait(0.01):
                number += 1
                head = bytes([0x80, 96, *number.to_bytes(2, "big"), *bytes(8)])
                sender.sendto(head + bytes(20), ("127.0.0.1", port))

        thread = threading.Thread(target=send)
        thread.start()
        with pytest.raises(SourceError, match=r"no picture could be decoded in 0\.5 s"):
            open_source(f"udp://0.0.0.0:{port}")
        over.set()
        thread.join()


def test_a_port_that_another_program_has_is_told(port: int) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("", port))
        with pytest.raises(SourceError, match=f"UDP port {port} cannot be listened on"):
            open_source(f"udp://0.0.0.0:{port}")


@pytest.mark.parametrize(
    ("content", "what"),
    [(None, "cannot be read"), ("hello", "no video over RTP"), ("m=audio 5004 RTP/AVP 0", "RTP")],
)
def test_a_file_that_describes_no_video_is_refused(
    tmp_path: Path, content: str | None, what: str
) -> None:
    file = tmp_path / "camera.sdp"
    if content is not None:
        file.write_text(content)
    with pytest.raises(SourceError, match=what):
        open_source(str(file))


@pytest.mark.parametrize("address", ["udp://0.0.0.0", "udp://0.0.0.0:99999"])
def test_an_address_without_a_port_is_refused(address: str) -> None:
    with pytest.raises(SourceError, match="names no port"):
        open_source(address)
