"""Bill of materials: valid by the standard's own schema, and the same for the same release."""

import json

import pytest

pytest.importorskip("cyclonedx", reason="needs cyclonedx-python-lib")

from cyclonedx.schema import SchemaVersion
from cyclonedx.validation.json import JsonStrictValidator

from app.recognition.models.storage import PACKAGED_FILES, TAUGHT_FILES
from release.bill import build_bill
from release.licences import list_licences

SECONDS = 1_790_000_000


def test_it_names_every_package_and_model_and_is_valid() -> None:
    packages = list_licences()
    text = build_bill("0.2.0", SECONDS, packages)
    assert JsonStrictValidator(SchemaVersion.V1_6).validate_str(text) is None
    bill = json.loads(text)
    files = (*PACKAGED_FILES, *TAUGHT_FILES)
    named = {each["name"] for each in bill["components"]}
    assert named == {each.name for each in packages} | {file.filename for file in files}
    models = [each for each in bill["components"] if each["type"] == "machine-learning-model"]
    assert {each["hashes"][0]["content"] for each in models} == {file.sha256 for file in files}
    assert all(each["licenses"] for each in bill["components"])


def test_the_same_release_has_the_same_bill() -> None:
    packages = list_licences()
    assert build_bill("0.2.0", SECONDS, packages) == build_bill("0.2.0", SECONDS, packages)
    assert build_bill("0.2.0", SECONDS, packages) != build_bill("0.2.1", SECONDS, packages)
