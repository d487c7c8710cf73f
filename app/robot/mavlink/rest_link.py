"""mavlink2rest link: MAVLink messages as JSON over HTTP, as BlueOS offers them."""

from __future__ import annotations

import http.client
import json
import math
import struct
import time as clock
from collections.abc import Mapping
from typing import Any, Final
from urllib.parse import urlsplit

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from app.recognition.errors import VehicleError
from app.robot.mavlink.actions import OUR_COMPONENT, Message
from app.robot.mavlink.peer import Sender

ANSWER_SECONDS: Final = 2.0
"""Seconds for the server to answer; it runs on the vehicle and answers from memory."""

POLL_SECONDS: Final = 0.1
"""Seconds between two polls: well below the vehicle's heartbeat period of one second."""

WANTED: Final = (
    "HEARTBEAT",
    "COMMAND_ACK",
    "SYSTEM_TIME",
    "VFR_HUD",
    "NAV_CONTROLLER_OUTPUT",
    "PARAM_VALUE",
    "AUTOPILOT_VERSION",
)
"""Messages that report the state of the vehicle, and what an output does; further ones are polled
once they are requested (``SET_MESSAGE_INTERVAL``)."""

RENAMED: Final = {"type": "mavtype"}
"""Fields with another name in mavlink2rest, where ``type`` names the message."""


class RestLink:
    """HTTP to mavlink2rest; a `VehicleLink`.

    The server's last message of each kind is polled, and is new when its counter has changed. One
    that cannot be read is counted and left out, so that the others are still heard.

    Parameters
    ----------
    address
        Address of the server, such as ``http://192.168.2.2/mavlink2rest``.
    system, component
        MAVLink ids of the vehicle.

    Raises
    ------
    OSError
        When nothing answers.
    VehicleError
        When the server is not mavlink2rest.

    """

    expected: Sender | None = ()

    def __init__(self, address: str, system: int, component: int) -> None:
        place = urlsplit(address)
        is_secure = place.scheme == "https"
        kind = http.client.HTTPSConnection if is_secure else http.client.HTTPConnection
        if not place.hostname:
            raise ValueError("no host")
        self._connection = kind(place.hostname, place.port, timeout=ANSWER_SECONDS)
        self._path = f"{place.path.rstrip('/')}/mavlink"
        self._system = system
        self._messages = f"{self._path}/vehicles/{system}/components/{component}/messages"
        self._codec = mavlink.MAVLink(None, system, component)
        self.dropped = 0
        # Messages from before the connection answer no request of ours.
        self._counters: dict[str, int] = {}
        self._wanted: dict[str, None] = {}
        for name in WANTED:
            self._poll(name)

    def send(self, message: Message, to: Sender | None) -> None:
        """Send a message; `to` is the server."""
        is_command = message.get_type() == "COMMAND_LONG"
        if is_command and message.command == mavlink.MAV_CMD_SET_MESSAGE_INTERVAL:
            self._poll(mavlink.mavlink_map[int(message.param1)].msgname)
        header = {"system_id": self._system, "component_id": OUR_COMPONENT, "sequence": 0}
        body = json.dumps({"header": header, "message": to_json(message)}, allow_nan=False)
        self._request("POST", self._path, body)

    def receive(self, seconds: float) -> list[tuple[Message, Sender]]:
        """Return the new messages."""
        clock.sleep(min(seconds, POLL_SECONDS))
        news = (self._fetch(name) for name in self._wanted)
        return [(message, ()) for message in news if message is not None]

    def close(self) -> None:
        """Close the connection."""
        self._connection.close()

    def _poll(self, name: str) -> None:
        """Poll a message from now on."""
        if name not in self._wanted:
            self._wanted[name] = None
            self._fetch(name)

    def _fetch(self, name: str) -> Message | None:
        """Return the last message of a kind if it is new."""
        text = self._request("GET", f"{self._messages}/{name}")
        if text is None:
            return None
        try:
            content = json.loads(text)
            counter, found = int(content["status"]["time"]["counter"]), content["message"]
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            raise VehicleError(
                f"{self._messages} is not answered as mavlink2rest does; check the address"
            ) from error
        if counter == self._counters.get(name):
            return None
        self._counters[name] = counter
        try:
            message = from_json(found)
            # The ids of the sender are in the path.
            message.pack(self._codec)
        except (ValueError, KeyError, TypeError, AttributeError, struct.error):
            self.dropped += 1
            return None
        return message

    def _request(self, method: str, path: str, body: str | None = None) -> str | None:
        """Return the text of the answer; None if the server has nothing at that path."""
        heads = {"Content-Type": "application/json"} if body else {}
        try:
            self._connection.request(method, path, body, heads)
            answer = self._connection.getresponse()
            text = answer.read().decode("utf-8", "replace")
        except (http.client.HTTPException, OSError) as error:
            self._connection.close()  # the next request connects again
            raise ConnectionError(str(error) or type(error).__name__) from error
        if answer.status == http.client.NOT_FOUND and method == "GET":
            return None
        if answer.status != http.client.OK:
            raise ConnectionError(f"mavlink2rest answered {answer.status}: {text[:100]}")
        return text


def to_json(message: Message) -> dict[str, Any]:
    """Return a message as mavlink2rest writes it.

    Enumerations are written by name, bit masks as ``bits``, and NaN as null.
    """
    content: dict[str, Any] = {"type": message.get_type()}
    lengths = dict(zip(message.ordered_fieldnames, message.array_lengths, strict=True))
    for name in message.fieldnames:
        value = getattr(message, name)
        if isinstance(value, str):
            # mavlink2rest takes one character a byte; pymavlink gives other bytes as replacements.
            text = value.replace("\N{REPLACEMENT CHARACTER}", "?")
            value = [*text.ljust(lengths[name], "\0")]
        elif message.fielddisplays_by_name.get(name) == "bitmask":
            value = {"bits": value}
        elif isinstance(value, float) and math.isnan(value):
            value = None
        elif enum := message.fieldenums_by_name.get(name):
            value = {"type": mavlink.enums[enum][value].name}
        content[RENAMED.get(name, name)] = value
    return content


def from_json(content: Mapping[str, Any]) -> Message:
    """Return the message of a JSON object of mavlink2rest.

    Raises
    ------
    ValueError, KeyError, TypeError, AttributeError
        When the object is no message.

    """
    kind = getattr(mavlink, f"MAVLink_{content['type'].lower()}_message")
    values = {}
    for name in kind.fieldnames:
        value = content.get(RENAMED.get(name, name), 0)
        if value is None:  # how JSON of Rust writes NaN and infinity
            value = math.nan
        if isinstance(value, Mapping):
            value = value["bits"] if "bits" in value else getattr(mavlink, value["type"])
        elif isinstance(value, list) and all(isinstance(each, str) for each in value):
            value = "".join(value).rstrip("\0").encode()
        values[name] = value
    return kind(**values)
