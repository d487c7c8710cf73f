"""The types that the page is checked against are those of the API, and its limits the core's."""

import pytest

from app.recognition.gestures import demonstration
from tests.conftest import ROOT
from tests.page.api_schema import GENERATOR, TYPES, generate


@pytest.mark.skipif(not GENERATOR.exists(), reason="needs the page's tools: run make page")
def test_the_types_of_the_page_are_those_of_the_api() -> None:
    assert TYPES.read_text() == generate(), "run python -m tests.page.api_schema"


@pytest.mark.parametrize("limit", ["MAX_DEMONSTRATIONS", "MAX_DIVER_LENGTH"])
def test_the_limits_of_the_page_are_those_of_the_core(limit: str) -> None:
    written = (ROOT / "static/js/core/text-limit.js").read_text()
    assert f"const {limit} = {getattr(demonstration, limit)};" in written
