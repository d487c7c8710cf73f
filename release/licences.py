"""Licences of the pinned packages: ``python -m release.licences`` lists them.

They are read from the installed packages; nothing is downloaded.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.metadata import Distribution, PackageNotFoundError, distribution

from packaging.requirements import Requirement

from tests.conftest import ROOT

LOCKS = ("requirements.txt", "requirements-robot.txt", "requirements-vehicle.txt")


@dataclass(frozen=True)
class Licensed:
    """A pinned package and the licence that it names."""

    name: str
    version: str
    licence: str


def list_licences() -> list[Licensed]:
    """Return the licences of the pinned packages that are installed, by name."""
    found = {}
    for name in sorted(set(_pinned())):
        try:
            package = distribution(name)
        except PackageNotFoundError:  # for another platform or Python
            continue
        found[name] = Licensed(name, package.version, _licence(package))
    return [*found.values()]


def _pinned() -> Iterator[str]:
    for lock in LOCKS:
        for line in (ROOT / lock).read_text(encoding="utf-8").splitlines():
            if re.match(r"[a-z0-9]", line):
                yield Requirement(line.removesuffix("\\")).name


def _licence(package: Distribution) -> str:
    """Return the licence in the metadata: the expression, the classifiers, or the free text."""
    metadata = package.metadata
    if "License-Expression" in metadata:
        return metadata["License-Expression"]
    named = [
        entry.rpartition(" :: ")[2]
        for entry in metadata.get_all("Classifier") or []
        if entry.startswith("License :: ") and entry != "License :: OSI Approved"
    ]
    if named or "License" not in metadata:
        return "; ".join(named)
    return metadata["License"].strip().partition("\n")[0]


if __name__ == "__main__":
    for each in list_licences():
        print(f"{each.name:<28} {each.version:<16} {each.licence}")
