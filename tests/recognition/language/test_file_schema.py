"""The published JSON Schema is that of the models, and language files obey it."""

import json

import jsonschema
import pytest

from app.recognition import Gesture, Language
from tests.published_schemas import LANGUAGE_FILE
from tests.recognition.language.test_language import GOLDEN, GOLDEN_OF_DIVERS
from tests.recognition.strategies import circle, recording

SCHEMA = LANGUAGE_FILE.content


def test_files_obey_the_schema() -> None:
    made = Language("pool", [Gesture.from_demonstration("circle", recording(circle))]).to_json()
    for text in (made, GOLDEN.read_text("utf-8"), GOLDEN_OF_DIVERS.read_text("utf-8")):
        jsonschema.Draft202012Validator(SCHEMA).validate(json.loads(text))


def test_the_schema_refuses_unknown_keys() -> None:
    content = json.loads(GOLDEN.read_text("utf-8")) | {"colour": "blue"}
    with pytest.raises(jsonschema.ValidationError, match="'colour' was unexpected"):
        jsonschema.Draft202012Validator(SCHEMA).validate(content)


def test_every_quantity_states_its_unit_or_axis() -> None:
    path = SCHEMA["$defs"]["PathEntry"]["properties"]
    assert "right" in path["x"]["description"]
    assert "Down" in path["y"]["description"]
    assert "Seconds" in SCHEMA["$defs"]["TrajectoryEntry"]["properties"]["time"]["description"]
