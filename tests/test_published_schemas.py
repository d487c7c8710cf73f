"""The published JSON Schemas are valid ones, and those of the models."""

import jsonschema
import pytest

from tests.published_schemas import SCHEMAS, PublishedSchema


@pytest.mark.parametrize("schema", SCHEMAS, ids=lambda schema: schema.name)
def test_the_schema_checked_in_is_valid_and_the_one_generated_from_the_models(
    schema: PublishedSchema,
) -> None:
    assert schema.content["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    jsonschema.Draft202012Validator.check_schema(schema.content)
    assert schema.file.read_text("utf-8") == schema.generate(), (
        "run python -m tests.published_schemas; a change that refuses what was written before "
        "needs a new version"
    )
