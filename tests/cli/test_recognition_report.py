"""The report of ``recognize --json``: what is printed fits the schema that is published."""

import json
from pathlib import Path

import jsonschema
import pytest

from app.cli.recognize import RecognitionReport
from tests.bags.bag_files import recorded
from tests.command_line import OsgStudio
from tests.conftest import ROOT
from tests.published_schemas import RECOGNITION_REPORT

LANGUAGE = ROOT / "languages" / "osg-table-2.json"


@pytest.mark.parametrize(
    ("clip", "options"),
    [
        ("line-test-1", []),
        ("line-test-1", ["--profile", "paper", "--expected", "circle"]),
        ("ordinary-movement", ["--without-salutes"]),
    ],
)
def test_real_reports_fit_the_schema_and_have_no_key_beside_it(
    osg_studio: OsgStudio,
    tmp_path: Path,
    clip: str,
    options: list[str],
) -> None:
    file = recorded(clip, tmp_path)
    ended = osg_studio("recognize", file, "--language", LANGUAGE, "--json", *options)
    report = json.loads(ended.out)
    jsonschema.validate(report, RECOGNITION_REPORT.content)
    assert report["takes"] or options == ["--without-salutes"]
    read = RecognitionReport.model_validate(report)
    assert read.model_extra == {}
    assert all(take.model_extra == {} for take in read.takes)
    assert all((take.explanation is not None) is ("--expected" in options) for take in read.takes)
