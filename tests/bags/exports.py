"""Reading a session back with MCAP's own reader, without code of ours."""

from __future__ import annotations

import json
from collections import defaultdict
from pathlib import Path
from typing import Any

import jsonschema
from mcap.reader import make_reader

Messages = dict[str, list[tuple[int, dict[str, Any]]]]


def checked(path: Path) -> Messages:
    """Read a session, validate every message by the file's own schema, and return them by topic."""
    found: Messages = defaultdict(list)
    validators: dict[int, jsonschema.Draft202012Validator] = {}
    with path.open("rb") as file:
        last = 0
        for schema, channel, message in make_reader(file).iter_messages():
            assert schema is not None
            assert (schema.encoding, channel.message_encoding) == ("jsonschema", "json")
            if schema.id not in validators:
                content = json.loads(schema.data)
                jsonschema.Draft202012Validator.check_schema(content)
                validators[schema.id] = jsonschema.Draft202012Validator(content)
                assert content["title"] == schema.name
            decoded = json.loads(message.data)
            validators[schema.id].validate(decoded)
            assert message.log_time >= last
            last = message.log_time
            found[channel.topic].append((message.log_time, decoded))
    return found
