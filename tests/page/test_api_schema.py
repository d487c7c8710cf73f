"""The types that the page is checked against are those of the API."""

import pytest

from tests.page.api_schema import GENERATOR, TYPES, generate


@pytest.mark.skipif(not GENERATOR.exists(), reason="needs the page's tools: run make page")
def test_the_types_of_the_page_are_those_of_the_api() -> None:
    assert TYPES.read_text() == generate(), "run python -m tests.page.api_schema"
