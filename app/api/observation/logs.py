"""Logs: lines for people, or JSON objects; both contain the id of the request or job."""

from __future__ import annotations

import json
import logging
import sys
from contextvars import ContextVar
from datetime import UTC, datetime
from typing import Any, Literal

request_id: ContextVar[str] = ContextVar("request_id", default="")
"""Id of the request that is being answered."""

job_id: ContextVar[str] = ContextVar("job_id", default="")
"""Id of the job that is being run."""

FIELDS = "fields"
"""Attribute of a log record with further keys of its JSON object: ``extra={FIELDS: {...}}``."""


class JsonFormatter(logging.Formatter):
    """Formats a record as one line of JSON, so that a client's text cannot begin another line."""

    def format(self, record: logging.LogRecord) -> str:
        """Return the line."""
        content: dict[str, Any] = {
            "time": datetime.fromtimestamp(record.created, UTC).isoformat(timespec="milliseconds"),
            "level": record.levelname.lower(),
            "logger": record.name,
            "message": record.getMessage(),
        }
        content |= _ids() | getattr(record, FIELDS, {})
        if record.exc_info:
            content["exception"] = self.formatException(record.exc_info)
        return json.dumps(content, default=str)


class TextFormatter(logging.Formatter):
    """Formats a record for a person, with the ids and further fields at its end."""

    def format(self, record: logging.LogRecord) -> str:
        """Return the line, and a traceback after it."""
        details = _ids() | getattr(record, FIELDS, {})
        words = "".join(
            f" {key}={json.dumps(value, default=str)}" for key, value in details.items()
        )
        time = self.formatTime(record, "%Y-%m-%d %H:%M:%S")
        line = f"{time} {record.levelname} {record.name}: {record.getMessage()}{words}"
        if record.exc_info:
            line += "\n" + self.formatException(record.exc_info)
        return line


def set_up(form: Literal["text", "json"], level: str) -> None:
    """Send the logs of this process to stderr in a form, from a level on."""
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(JsonFormatter() if form == "json" else TextFormatter())
    logging.basicConfig(level=logging.WARNING, handlers=[handler], force=True)
    logging.getLogger("app").setLevel(level.upper())


def _ids() -> dict[str, Any]:
    found = {"request_id": request_id.get(), "job_id": job_id.get()}
    return {key: value for key, value in found.items() if value}
