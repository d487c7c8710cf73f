"""The docstring below an attribute describes its key."""

from dataclasses import dataclass, make_dataclass

from pydantic import BaseModel

from app.recognition.text.described import DESCRIBED, read_descriptions


@dataclass
class Dive:
    """A dive."""

    metres: float
    """Depth, at the deepest
    place."""
    name: str = ""


class DiveEntry(BaseModel):
    """A dive in a file."""

    model_config = DESCRIBED

    metres: float
    """Depth, at the deepest
    place."""


def test_a_docstring_over_several_lines_is_one_line_of_the_schema() -> None:
    key = DiveEntry.model_json_schema()["properties"]["metres"]
    assert key["description"] == "Depth, at the deepest place."


def test_the_descriptions_of_a_dataclass_are_read_as_those_of_a_model() -> None:
    assert read_descriptions(Dive) == {"metres": "Depth, at the deepest place."}


def test_a_class_without_a_source_file_has_no_descriptions() -> None:
    assert read_descriptions(make_dataclass("Made", ["metres"])) == {}
