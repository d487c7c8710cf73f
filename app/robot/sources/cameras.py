"""Cameras of this machine, by OpenCV, and streams from the network, by FFmpeg through PyAV.

RTP packets do not state their content. A session description (SDP, RFC 8866) does: it is read from
a file, or made here for the usual cameras of vehicles, which send H.264 to a port, 5600 on a
BlueROV2.
"""

from __future__ import annotations

import io
import re
import socket
import struct
import time as clock
from dataclasses import dataclass
from ipaddress import ip_address
from pathlib import Path
from typing import Final
from urllib.parse import urlsplit

import av
import cv2
import numpy as np
from av.container import InputContainer

from app.recognition.errors import SourceError
from app.recognition.poses.frame import Image

DATAGRAM_SCHEMES: Final = ("udp", "rtp")
"""Schemes of addresses on which packets arrive without a request."""

ENDING: Final = ".sdp"
"""Ending of session description files."""

MOST_BYTES: Final = 65536
"""Largest size of a session description, and of a packet."""

RTP_VERSION: Final = 2
"""Version number in the first two bits of a packet (RFC 3550, 5.1)."""

LEAST_HEAD: Final = 12
"""Smallest header of an RTP packet, in bytes."""

FIXED_TYPES: Final = {26: "JPEG/90000", 32: "MPV/90000", 33: "MP2T/90000"}
"""Payload types with a fixed video format (RFC 3551, table 5); all others are taken for H.264."""

DESCRIPTION: Final = """v=0
o=- 0 0 IN IP4 127.0.0.1
s=-
c=IN IP4 {group}
t=0 0
m=video {port} RTP/AVP {kind}
a=rtpmap:{kind} {encoding}
"""

SENDER: Final = "a=source-filter: incl IN IP4 * {sender}\n"
"""Line of a session description that admits one sender alone (RFC 4570)."""

LEAST_PACKETS: Final = 3
"""Packets after which a sender counts as the camera; a camera sends them within a second."""

MOST_SENDERS: Final = 1000
"""Senders after which the wait ends: so many are no cameras."""


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


def is_datagram_address(address: str) -> bool:
    """Return whether an address names a UDP port on which packets arrive."""
    return "://" in address and urlsplit(address).scheme.lower() in DATAGRAM_SCHEMES


def is_description_file(text: str) -> bool:
    """Return whether a text is the path of a session description."""
    return text.lower().endswith(ENDING) and "://" not in text


@dataclass(frozen=True)
class Datagrams:
    """How to listen to a stream of datagrams.

    Attributes
    ----------
    description
        Session description for FFmpeg; None for a stream without RTP.
    local
        Address of this machine to listen on; empty: all.
    sender
        The only address whose packets count; empty: all.

    """

    description: str | None
    local: str
    sender: str


def describe_address(address: str, seconds: float) -> Datagrams:
    """Describe the stream at an address.

    Parameters
    ----------
    address
        Address such as ``udp://0.0.0.0:5600``. A host that is an address of this machine is the
        one to listen on, a multicast group is joined, any other host is the sender.
    seconds
        How long to wait for the first packets.

    Raises
    ------
    SourceError
        When the address has no port, the port is taken, or nothing arrives.

    """
    place = urlsplit(address.replace("://@", "://"))
    try:
        port = place.port
    except ValueError:
        port = None
    if not port:
        raise SourceError(f"{address} names no port; give one, such as udp://0.0.0.0:5600")
    group, local, sender = _sort_host(place.hostname)
    packet, sender = wait_for_packets(port, group, local, sender, seconds)
    if len(packet) < LEAST_HEAD or packet[0] >> 6 != RTP_VERSION:
        return Datagrams(None, local, "" if group else sender)
    _require_next(port, local)
    kind = packet[1] & 0x7F
    encoding = FIXED_TYPES.get(kind, "H264/90000")
    text = DESCRIPTION.format(group=group or "0.0.0.0", port=port, kind=kind, encoding=encoding)
    if group is None:
        text += SENDER.format(sender=sender)
    return Datagrams(text, local, "")


def read_description(path: str, seconds: float) -> Datagrams:
    """Read a session description, and wait until something arrives on its port.

    Raises
    ------
    SourceError
        When the file cannot be read or describes no video over RTP, or nothing arrives.

    """
    try:
        content = Path(path).read_bytes()
    except OSError as error:
        raise SourceError(f"{path} cannot be read: {error.strerror or error}") from error
    text = content[:MOST_BYTES].decode("utf-8", "replace")
    media = re.search(r"^m=video (\d{1,5})(?:/\d+)? RTP/", text, re.MULTILINE)
    if media is None or not 0 < int(media[1]) < 65536:
        raise SourceError(
            f'{path} describes no video over RTP; it needs a line "m=video PORT RTP/AVP"'
        )
    connection = re.search(r"^c=IN IP4 ([\d.]+)", text, re.MULTILINE)
    # Cameras name there themselves, this machine, or nobody: it says nothing about the sender.
    group, local, _ = _sort_host(connection and connection[1])
    port = int(media[1])
    wait_for_packets(port, group, local, "", seconds)
    _require_next(port, local)
    return Datagrams(text, local, "")


def wait_for_packets(
    port: int, group: str | None, local: str, sender: str, seconds: float
) -> tuple[bytes, str]:
    """Wait for a sender of several packets; return one of them, and who it is.

    A single packet of a stranger does not decide what the stream is.

    Parameters
    ----------
    port
        The port.
    group
        Address of a multicast group to join; None for packets to this machine.
    local
        Address of this machine to listen on; empty: all.
    sender
        The only sender that counts; empty: any.
    seconds
        How long to wait.

    Raises
    ------
    SourceError
        When the port is taken, or nothing arrives.

    """
    counts: dict[str, int] = {}
    until = clock.monotonic() + seconds
    with _listen(port, local) as listening:
        try:
            if group is not None:
                member = struct.pack("4sl", socket.inet_aton(group), socket.INADDR_ANY)
                listening.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, member)
            while (left := until - clock.monotonic()) > 0 and len(counts) < MOST_SENDERS:
                listening.settimeout(left)
                packet, (host, _) = listening.recvfrom(MOST_BYTES)
                if sender and host != sender:
                    continue
                counts[host] = counts.get(host, 0) + 1
                if counts[host] >= LEAST_PACKETS:
                    return packet, host
        except TimeoutError:
            pass
        except OSError as error:
            of = f" of group {group}" if group else ""
            raise SourceError(
                f"packets{of} cannot be received on UDP port {port} ({error.strerror or error}); "
                "is this machine in the camera's network?"
            ) from error
    by = f" from {sender}" if sender else ""
    raise SourceError(
        f"nothing arrived on UDP port {port}{by} for {seconds:g} s; is the camera on, does it "
        "send to this machine's address, and does the firewall let it through?"
    )


def _require_next(port: int, local: str) -> None:
    """Check that the port after that of RTP is free: FFmpeg listens there for RTCP."""
    _listen(port + 1, local, f", which RTP needs beside {port},").close()


def _listen(port: int, local: str, why: str = "") -> socket.socket:
    """Return a socket that listens on a UDP port; of one that is taken tell what to do."""
    listening = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        listening.bind((local, port))
    except (OSError, OverflowError) as error:
        listening.close()
        raise SourceError(
            f"UDP port {port}{why} cannot be listened on "
            f"({getattr(error, 'strerror', None) or error}); another program may have it, such as "
            "a ground station: stop it, or send to another port"
        ) from error
    return listening


def _sort_host(host: str | None) -> tuple[str | None, str, str]:
    """Return the multicast group, the address of this machine, or the sender that a host is."""
    try:
        address = ip_address(host or "0.0.0.0")
    except ValueError:
        return None, "", ""  # a name, which may be anybody's
    if address.is_multicast:
        return str(address), "", ""
    if address.is_unspecified or address.version != 4:
        return None, "", ""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as trial:
        try:
            trial.bind((str(address), 0))
        except OSError:
            return None, "", str(address)
    return None, str(address), ""
