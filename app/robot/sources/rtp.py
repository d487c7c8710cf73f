"""RTP streams over UDP: inspects the packets on a port, and describes them for FFmpeg.

RTP packets do not state their content. A session description (SDP, RFC 8866) does: it is read from
a file, or made here for the usual cameras of vehicles, which send H.264 to a port, 5600 on a
BlueROV2.
"""

from __future__ import annotations

import re
import socket
import struct
import time as clock
from dataclasses import dataclass
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

SENDER: Final = "a=source-filter: incl IN IP4 * {sender}\n"
"""Line of a session description that admits one sender alone (RFC 4570)."""

LEAST_PACKETS: Final = 3
"""Packets after which a sender counts as the camera; a camera sends them within a second."""

MOST_SENDERS: Final = 1000
"""Senders after which the wait ends: so many are no cameras."""


def is_datagram_address(address: str) -> bool:
    """Return whether an address names a UDP port on which packets arrive."""
    return "://" in address and urlsplit(address).scheme.lower() in SCHEMES


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
    wait_for_packets(int(media[1]), group, local, "", seconds)
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
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listening:
        try:
            listening.bind((local, port))
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
            raise SourceError(
                f"UDP port {port} cannot be listened on ({error.strerror or error}); another "
                "program may have it, such as a ground station: stop it, or send to another port"
            ) from error
    by = f" from {sender}" if sender else ""
    raise SourceError(
        f"nothing arrived on UDP port {port}{by} for {seconds:g} s; is the camera on, does it "
        "send to this machine's address, and does the firewall let it through?"
    )


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
