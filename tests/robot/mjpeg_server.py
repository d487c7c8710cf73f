"""An MJPEG camera: JPEG pictures one after another over HTTP, on a real socket."""

from __future__ import annotations

import math
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import cv2
import numpy as np

from tests.robot.camera_server import CameraServer

FRAME_SIZE = (64, 48)
BOUNDARY = "picture"


def picture(brightness: int) -> bytes:
    """Return a grey JPEG."""
    width, height = FRAME_SIZE
    grey = np.full((height, width, 3), brightness, np.uint8)
    return cv2.imencode(".jpg", grey)[1].tobytes()


class MjpegServer(CameraServer):
    """Sends pictures to every client.

    Parameters
    ----------
    port
        Where it listens; 0 finds a free one.
    pause
        Seconds between two pictures.
    brightness
        Brightness of all its pictures.
    pictures
        Number of pictures after which it sends nothing more, but keeps the connection.

    """

    def __init__(
        self,
        port: int = 0,
        *,
        pause: float = 0.02,
        brightness: int = 100,
        pictures: float = math.inf,
    ) -> None:
        jpeg, off = picture(brightness), threading.Event()

        class Handler(BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                self.send_response(200)
                kind = f"multipart/x-mixed-replace; boundary={BOUNDARY}"
                self.send_header("Content-Type", kind)
                self.end_headers()
                head = f"--{BOUNDARY}\r\nContent-Type: image/jpeg\r\nContent-Length: "
                try:
                    sent = 0
                    while not off.wait(pause):
                        if sent < pictures:
                            length = f"{len(jpeg)}\r\n\r\n"
                            self.wfile.write(f"{head}{length}".encode() + jpeg + b"\r\n")
                            sent += 1
                except OSError:
                    pass  # the client has disconnected

            def log_message(self, format: str, *args: object) -> None:
                """Say nothing on stderr."""

        super().__init__(ThreadingHTTPServer(("127.0.0.1", port), Handler), off)

    @property
    def address(self) -> str:
        """Name of a source for this camera, with a password."""
        return f"http://diver:secret@127.0.0.1:{self.port}/"
