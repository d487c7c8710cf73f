"""Cameras of this machine, by OpenCV, and streams from the network, by FFmpeg through PyAV."""

from __future__ import annotations

import io
import re
from typing import Final
from urllib.parse import urlsplit

import av
import cv2
import numpy as np
from av.container import InputContainer

from app.recognition.errors import SourceError
from app.recognition.poses.frame import Image
from app.robot.sources.rtp import (
    Datagrams,
    describe_address,
    is_datagram_address,
    is_description_file,
    read_description,
)

OPEN_SECONDS: Final = 10.0
"""Longest wait in seconds for the first decodable picture of a stream: RTSP cameras send a key
frame every few seconds."""

SILENT_SECONDS: Final = 5.0
"""Seconds without a frame after which a stream counts as lost. The slowest stream in which a
gesture could be seen gives two frames a second (`poses.sequence.MAX_GAP_SECONDS`)."""

MOST_PIXELS: Final = 16_000_000
"""Largest number of pixels of one frame, as for clips (`VideoLimits`)."""

SCHEMES: Final = ("rtsp", "rtsps", "http", "https", "udp", "rtp", "tcp", "srt")
"""Schemes of addresses that are opened as streams."""

DATAGRAM_PROTOCOLS: Final = "rtp,srtp,udp"
"""Protocols that a session description may make FFmpeg open."""

PROTOCOLS: Final = "rtsp,rtsps,rtp,srtp,udp,tcp,tls,http,https,httpproxy,crypto,srt"
"""Protocols that FFmpeg may open for streams; not files, which a playlist from the network could
name."""


class CameraDevice:
    """A camera of this machine; a `Camera`.

    Parameters
    ----------
    device
        Number of the camera, from 0, or its device file.

    Raises
    ------
    SourceError
        When it cannot be opened.

    """

    def __init__(self, device: int | str) -> None:
        self._name = f"camera {device}"
        # OpenCV would repeat its warnings at every attempt; the source reports a fault once.
        cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_ERROR)
        self._capture = cv2.VideoCapture(device)
        if not self._capture.isOpened():
            raise SourceError(
                f"{self._name} cannot be opened: there is none, another program uses it, or this "
                "user may not; see which there are (on Linux: ls /dev/video*) and try again"
            )
        # A queue in the driver would delay every frame; not every driver supports this setting.
        self._capture.set(cv2.CAP_PROP_BUFFERSIZE, 1)

    def read(self) -> Image:
        """Wait for the next frame; see `app.robot.sources.live.Camera`."""
        got, image = self._capture.read()
        if not got or image is None:
            raise SourceError(f"{self._name} gave no frame: unplugged, or its driver stopped")
        return np.ascontiguousarray(cv2.cvtColor(image, cv2.COLOR_BGR2RGB), np.uint8)

    def close(self) -> None:
        """Release the camera for other programs."""
        self._capture.release()


class NetworkStream:
    """A stream from the network, such as a camera's RTSP, MJPEG or RTP; a `Camera`.

    Parameters
    ----------
    address
        Address with one of the `SCHEMES`, or the path of a session description.

    Raises
    ------
    SourceError
        When nothing answers, or the stream is no video.

    """

    def __init__(self, address: str) -> None:
        self._name = without_password(address)
        self._container = _open(address, self._name)
        try:
            stream = self._container.streams.video[0]
        except IndexError as error:
            self.close()
            raise SourceError(f"{self._name} holds no video; check the address") from error
        if not stream.codec_context.width:
            self.close()
            raise SourceError(
                f"{self._name} sends something, but no picture could be decoded in "
                f"{OPEN_SECONDS:g} s; for RTP it is taken for H.264 unless an .sdp file says more"
            )
        stream.thread_type = "SLICE"  # threads by frame would delay several frames
        self._frames = self._container.decode(stream)

    def read(self) -> Image:
        """Wait for the next frame; see `app.robot.sources.live.Camera`."""
        while True:
            try:
                frame = next(self._frames)
            except StopIteration as error:
                raise SourceError(f"{self._name} ended: the sender closed the stream") from error
            except av.error.InvalidDataError:
                continue  # a damaged frame counts as dropped
            except (av.error.FFmpegError, OSError) as error:
                raise SourceError(
                    f"{self._name} broke off ({error.strerror or error}): no frame for "
                    f"{SILENT_SECONDS:g} s, or the connection failed"
                ) from error
            if frame.width * frame.height > MOST_PIXELS:
                raise SourceError(
                    f"{self._name} sends {frame.width} x {frame.height} pixels, more than "
                    f"{MOST_PIXELS / 1e6:g} million; set the camera to a smaller picture"
                )
            return np.ascontiguousarray(frame.to_ndarray(format="rgb24"), np.uint8)

    def close(self) -> None:
        """Close the connection."""
        self._container.close()


def without_password(address: str) -> str:
    """Return an address as it may be shown and logged: without user name and password."""
    return re.sub(r"(?<=://)[^/@]*@", "", address)


def is_address(text: str) -> bool:
    """Return whether a text is the address of a stream."""
    return "://" in text and urlsplit(text).scheme.lower() in SCHEMES


def _open(address: str, name: str) -> InputContainer:
    datagrams = _describe(address)
    described = None if datagrams is None else datagrams.description
    options = {
        "protocol_whitelist": PROTOCOLS if described is None else DATAGRAM_PROTOCOLS,
        "fflags": "nobuffer",
        "rtsp_transport": "tcp",  # over UDP a lost packet smears the picture for seconds
    }
    if datagrams is not None:
        options |= {"localaddr": datagrams.local} if datagrams.local else {}
        options |= {"sources": datagrams.sender} if datagrams.sender else {}
    try:
        return av.open(
            address if described is None else io.BytesIO(described.encode()),
            "r",
            format=None if described is None else "sdp",
            timeout=(OPEN_SECONDS, SILENT_SECONDS),
            container_options=options,
            options={"max_pixels": str(MOST_PIXELS)},
            metadata_errors="replace",
        )
    except (av.error.FFmpegError, OSError) as error:
        raise SourceError(
            f"{name} cannot be opened ({error.strerror or error}); check the address, and whether "
            "the camera is on"
        ) from error


def _describe(address: str) -> Datagrams | None:
    """Describe a stream over UDP; None for any other stream."""
    if is_description_file(address):
        return read_description(address, OPEN_SECONDS)
    return describe_address(address, OPEN_SECONDS) if is_datagram_address(address) else None
