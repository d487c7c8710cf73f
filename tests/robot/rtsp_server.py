"""A camera in the network: H.264 over RTSP, on a real socket.

FFmpeg encodes and makes the RTP packets; the conversation of RFC 2326 that a watcher has with a
camera, and packets within its connection (interleaved), are all that is done here.
"""

from __future__ import annotations

import socket
import socketserver
import threading
from collections.abc import Generator
from contextlib import closing, suppress
from fractions import Fraction

import av
import numpy as np

from tests.robot.camera_server import CameraServer
from tests.robot.mjpeg_server import FRAME_SIZE

LARGEST_PACKET = 65535
"""Largest number of bytes in an interleaved packet."""

RATE = 25
"""Pictures a second, about."""

SDP = """v=0
o=- 0 0 IN IP4 127.0.0.1
s=reef
c=IN IP4 127.0.0.1
t=0 0
m=video 0 RTP/AVP 96
a=rtpmap:96 H264/90000
a=fmtp:96 packetization-mode=1
a=control:trackID=0
"""


class RtspServer(CameraServer):
    """Sends pictures to every client.

    Parameters
    ----------
    brightness
        Brightness of all its pictures.

    """

    def __init__(self, brightness: int = 100) -> None:
        off = threading.Event()

        class Handler(socketserver.StreamRequestHandler):
            def handle(self) -> None:
                while request := self._request():
                    method, number = request
                    self._answer(method, number)
                    if method == "PLAY":
                        self._play()
                        return

            def _request(self) -> tuple[str, str] | None:
                """Return the method and the sequence number of the next request."""
                lines = list(iter(lambda: self.rfile.readline().decode().strip(), ""))
                if not lines:
                    return None
                heads = dict(line.lower().split(": ", 1) for line in lines[1:])
                return lines[0].split()[0], heads["cseq"]

            def _answer(self, method: str, number: str) -> None:
                heads = {
                    "OPTIONS": ["Public: OPTIONS, DESCRIBE, SETUP, PLAY, TEARDOWN"],
                    "DESCRIBE": ["Content-Type: application/sdp", f"Content-Length: {len(SDP)}"],
                    "SETUP": ["Transport: RTP/AVP/TCP;unicast;interleaved=0-1", "Session: 1"],
                    "PLAY": ["Session: 1"],
                }.get(method, [])
                body = SDP if method == "DESCRIBE" else ""
                answer = "\r\n".join(["RTSP/1.0 200 OK", f"CSeq: {number}", *heads, "", body])
                self.wfile.write(answer.encode())

            def _play(self) -> None:
                with suppress(OSError), closing(rtp_packets(brightness)) as packets:
                    for packet in packets:
                        if off.is_set():
                            return
                        self.wfile.write(b"$\0" + len(packet).to_bytes(2, "big") + packet)

        class Server(socketserver.ThreadingTCPServer):
            daemon_threads = True

        super().__init__(Server(("127.0.0.1", 0), Handler), off)

    @property
    def address(self) -> str:
        """Name of a source for this camera."""
        return f"rtsp://127.0.0.1:{self.port}/reef"


def rtp_packets(brightness: int) -> Generator[bytes]:
    """Encode grey pictures without end, and return what RTP makes of them."""
    width, height = FRAME_SIZE
    image = np.full((height, width, 3), brightness, np.uint8)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as packets:
        packets.bind(("127.0.0.1", 0))
        packets.settimeout(1 / RATE)  # no more packets for so long: time for the next picture
        port = packets.getsockname()[1]
        with av.open(f"rtp://127.0.0.1:{port}", "w", format="rtp") as container:
            options = {"tune": "zerolatency", "x264-params": "repeat-headers=1:keyint=5"}
            stream = container.add_stream("libx264", rate=RATE, options=options)
            stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
            number = 0
            while True:
                frame = av.VideoFrame.from_ndarray(image, format="rgb24")
                frame.pts, frame.time_base = number, Fraction(1, RATE)
                for packet in stream.encode(frame):
                    container.mux(packet)
                number += 1
                with suppress(TimeoutError):
                    while True:
                        yield packets.recv(LARGEST_PACKET)
