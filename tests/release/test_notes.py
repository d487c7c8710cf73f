"""Release notes: what the changelog lists for the version, and what has come since."""

import pytest

from app import __version__
from release.checkout import ReleaseError
from release.notes import read_notes
from tests.conftest import ROOT

CHANGELOG = """# Changelog
about
## [Unreleased]
### Added
- new
## [0.2.0] - 2026-11-22
- released
## [0.1.0]
- old
"""


def test_they_go_down_to_the_section_of_the_version() -> None:
    assert read_notes(CHANGELOG, "0.2.0") == (
        "# OSG Studio 0.2.0\n\n### Added\n- new\n\n- released\n"
    )


def test_a_version_without_a_section_is_refused() -> None:
    with pytest.raises(ReleaseError, match=r'no section "## \[0\.3\.0\]"'):
        read_notes(CHANGELOG, "0.3.0")


def test_this_version_has_notes() -> None:
    assert len(read_notes((ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), __version__)) > 1000
