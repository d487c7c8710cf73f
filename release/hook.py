"""Build hook: puts the bill of materials into the wheel if a release has made one."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

BILL = "release/osg-studio.cdx.json"


class BillHook(BuildHookInterface):  # type: ignore[type-arg]
    """Adds the bill of materials to ``.dist-info/sboms`` (PEP 770)."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Add the file; a build in a checkout has none."""
        if (Path(self.root) / BILL).is_file():
            build_data["sbom_files"].append(BILL)
