"""A server that speaks as mavlink2rest does, between HTTP and a vehicle's MAVLink."""

from __future__ import annotations

import json
import math
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from pymavlink import mavutil
from pymavlink.dialects.v20 import ardupilotmega as mavlink


def as_json(message: Any) -> dict[str, Any]:
    """Return a message as it is served: by name what is an enumeration or a mask."""
    content = message.to_dict()
    served: dict[str, Any] = {"type": content.pop("mavpackettype")}
    for name, value in content.items():
        if message.fielddisplays_by_name.get(name) == "bitmask":
            value = {"bits": value}
        elif name in message.fieldenums_by_name:
            value = {"type": mavlink.enums[message.fieldenums_by_name[name]][value].name}
        elif isinstance(value, str):  # one character a byte, filled with zeros
            value = [*value.ljust(16, "\0")]
        served["mavtype" if name == "type" else name] = value
    return served


def as_message(content: dict[str, Any]) -> Any:
    """Return the message that was posted; an error where a field is missing or no such name."""
    kind = getattr(mavlink, f"MAVLink_{content['type'].lower()}_message")
    values: dict[str, Any] = {}
    for name in kind.fieldnames:
        value = content["mavtype" if name == "type" else name]
        if kind.fielddisplays_by_name.get(name) == "bitmask":
            value = value["bits"]
        elif name in kind.fieldenums_by_name:
            enum = mavlink.enums[kind.fieldenums_by_name[name]]
            (value,) = [number for number, entry in enum.items() if entry.name == value["type"]]
        elif isinstance(value, list):
            value = "".join(value).encode()
        elif value is None:
            value = math.nan
        values[name] = value
    return kind(**values)


def listen(connection: Any, last: dict[str, dict[str, Any]], closing: threading.Event) -> None:
    """Store the last message of each kind, with a count, until the server ends."""
    while not closing.is_set():
        connection.mav.heartbeat_send(6, 8, 0, 0, 0)
        while message := connection.recv_match(timeout=0.005, blocking=True):
            sender = f"{message.get_srcSystem()}/components/{message.get_srcComponent()}"
            path = f"/mavlink/vehicles/{sender}/messages/{message.get_type()}"
            counter = last[path]["status"]["time"]["counter"] + 1 if path in last else 1
            time = {"counter": counter, "frequency": 1.0}
            last[path] = {"message": as_json(message), "status": {"time": time}}


@contextmanager
def serving(port: int) -> Iterator[str]:
    """Serve the vehicle at a UDP port; gives the server's address."""
    connection: Any = mavutil.mavlink_connection(f"udpout:127.0.0.1:{port}", source_system=255)
    last: dict[str, dict[str, Any]] = {}
    closing = threading.Event()

    class Handler(BaseHTTPRequestHandler):
        protocol_version = "HTTP/1.1"
        wbufsize = (
            65536  # heads and body in one packet: else each answer waits for an acknowledgement
        )

        def do_GET(self) -> None:
            if closing.is_set():  # the connection outlives the server
                self.close_connection = True
                return
            found = last.get(self.path)
            self._answer(404 if found is None else 200, json.dumps(found).encode())

        def do_POST(self) -> None:
            body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
            header = body["header"]
            connection.mav.srcSystem = header["system_id"]
            connection.mav.srcComponent = header["component_id"]
            connection.mav.send(as_message(body["message"]))
            self._answer(200, b"")

        def _answer(self, status: int, body: bytes) -> None:
            self.send_response(status)
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, format: str, *args: Any) -> None:
            """Suppress the log of requests."""

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    server.daemon_threads = True
    threads = [
        threading.Thread(target=listen, args=(connection, last, closing)),
        threading.Thread(target=server.serve_forever, args=(0.01,)),
    ]
    for thread in threads:
        thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_port}"
    finally:
        closing.set()
        server.shutdown()
        for thread in threads:
            thread.join()
        server.server_close()
        connection.close()
