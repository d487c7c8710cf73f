"""RTP streams over UDP: inspects the packets on a port, and describes them for FFmpeg.

RTP packets do not state their content. A session description (SDP, RFC 8866) does: it is read from
a file, or made here for the usual cameras of vehicles, which send H.264 to a port, 5600 on a
BlueROV2.
"""

from __future__ import annotations

import re
import socket
import struct
from ipaddress import ip_address
from pathlib import Path
from typing import Final
from urllib.parse import urlsplit

from app.recognition.errors import SourceError

SCHEMES: Final = ("udp", "rtp")
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


def is_datagram_address(address: str) -> bool:
    """Return whether an address names a UDP port on which packets arrive."""
    return "://" in address and urlsplit(address).scheme.lower() in SCHEMES


def is_description_file(text: str) -> bool:
    """Return whether a text is the path of a session description."""
    return text.lower().endswith(ENDING) and "://" not in text


def describe_address(address: str, seconds: float) -> str | None:
    """Return the session description of the stream at an address; None if it is no RTP.

    Parameters
    ----------
    address
        Address such as ``udp://0.0.0.0:5600``. The host matters only for multicast.
    seconds
        How long to wait for the first packet.

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
    group = _find_group(place.hostname)
    packet = wait_for_packet(port, group, seconds)
    if len(packet) < LEAST_HEAD or packet[0] >> 6 != RTP_VERSION:
        return None
    kind = packet[1] & 0x7F
    encoding = FIXED_TYPES.get(kind, "H264/90000")
    return DESCRIPTION.format(group=group or "0.0.0.0", port=port, kind=kind, encoding=encoding)


def read_description(path: str, seconds: float) -> str:
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
    wait_for_packet(int(media[1]), _find_group(connection and connection[1]), seconds)
    return text


def wait_for_packet(port: int, group: str | None, seconds: float) -> bytes:
    """Return the first packet that arrives at a UDP port.

    Parameters
    ----------
    port
        The port.
    group
        Address of a multicast group to join; None for packets to this machine.
    seconds
        How long to wait.

    Raises
    ------
    SourceError
        When the port is taken, or nothing arrives.

    """
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listening:
        try:
            listening.bind(("", port))
            if group is not None:
                member = struct.pack("4sl", socket.inet_aton(group), socket.INADDR_ANY)
                listening.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, member)
            listening.settimeout(seconds)
            return listening.recv(MOST_BYTES)
        except TimeoutError:
            raise SourceError(
                f"nothing arrived on UDP port {port} for {seconds:g} s; is the camera on, does it "
                "send to this machine's address, and does the firewall let it through?"
            ) from None
        except OSError as error:
            raise SourceError(
                f"UDP port {port} cannot be listened on ({error.strerror or error}); another "
                "program may have it, such as a ground station: stop it, or send to another port"
            ) from error


def _find_group(host: str | None) -> str | None:
    """Return the host if it is a multicast group, otherwise None."""
    try:
        return host if host and ip_address(host).is_multicast else None
    except ValueError:
        return None
