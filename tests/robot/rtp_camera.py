"""A vehicle's camera: H.264 in RTP packets, sent by PyAV to a UDP port until it is left."""

from __future__ import annotations

import threading
from fractions import Fraction

import av
import numpy as np
from typing_extensions import Self

from tests.robot.mjpeg_server import FRAME_SIZE
from tests.robot.rtsp_server import RATE


class RtpCamera:
    """Sends grey pictures, with their parameters before each key picture, as BlueOS does.

    Parameters
    ----------
    port
        Where to send to, on this machine.
    brightness
        Of the pictures.
    form
        ``rtp``, or ``mpegts`` for a transport stream without RTP.
    host
        Address of this machine that it sends from.

    """

    def __init__(
        self, port: int, brightness: int = 100, form: str = "rtp", host: str = "127.0.0.1"
    ) -> None:
        self._port, self._brightness, self._form = port, brightness, form
        self._host = host
        self._off = threading.Event()
        self._thread = threading.Thread(target=self._send)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._off.set()
        self._thread.join()

    def _send(self) -> None:
        width, height = FRAME_SIZE
        image = np.full((height, width, 3), self._brightness, np.uint8)
        scheme = "rtp" if self._form == "rtp" else "udp"
        with av.open(
            f"{scheme}://127.0.0.1:{self._port}?pkt_size=1316&localaddr={self._host}",
            "w",
            format=self._form,
        ) as container:
            options = {"tune": "zerolatency", "x264-params": "repeat-headers=1:keyint=5"}
            stream = container.add_stream("libx264", rate=RATE, options=options)
            stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
            number = 0
            while not self._off.wait(1 / RATE):
                frame = av.VideoFrame.from_ndarray(image, format="rgb24")
                frame.pts, frame.time_base = number, Fraction(1, RATE)
                for packet in stream.encode(frame):
                    container.mux(packet)
                number += 1
