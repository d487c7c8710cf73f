"""The published JSON Schema is that of the models, and language files obey it."""

import json

import jsonschema
import pytest

from app.recognition import Gesture, Language
from app.recognition.language.file_schema import SCHEMA_FILE, generate_schema, load_schema
from tests.recognition.language.test_language import GOLDEN, GOLDEN_OF_DIVERS
from tests.recognition.strategies import circle, recording

SCHEMA = json.loads(load_schema())


def test_the_schema_checked_in_is_the_one_generated_from_the_models() -> None:
    assert load_schema() == generate_schema(), (
        f"write generated_schema() to app/recognition/schema/{SCHEMA_FILE}; a change that refuses "
        "files that were accepted before needs a new version of the format"
    )


def test_the_schema_is_a_valid_one_of_2020_12() -> None:
    assert SCHEMA["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    jsonschema.Draft202012Validator.check_schema(SCHEMA)


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
