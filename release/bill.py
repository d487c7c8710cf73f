"""Bill of materials: what the package needs to run, by version and licence, as CycloneDX."""

from __future__ import annotations

import json
import uuid
from datetime import datetime, timezone
from typing import Final

from cyclonedx.contrib.license.factories import LicenseFactory
from cyclonedx.contrib.this.builders import this_component
from cyclonedx.model import HashAlgorithm, HashType
from cyclonedx.model.bom import Bom, BomMetaData
from cyclonedx.model.component import Component, ComponentType
from cyclonedx.model.tool import ToolRepository
from cyclonedx.output.json import JsonV1Dot6
from packageurl import PackageURL

from app.recognition.models.storage import PACKAGED_FILES, TAUGHT_FILES
from release.licences import Licensed

NAMESPACE: Final = uuid.UUID("6ba7b811-9dad-11d1-80b4-00c04fd430c8")
"""RFC 4122's namespace of addresses: the same content gets the same serial number."""

FILE_NAME: Final = "osg-studio.cdx.json"


def build_bill(version: str, seconds: int, packages: list[Licensed]) -> str:
    """Build the bill of materials, as JSON; the same input gives the same text.

    Parameters
    ----------
    version
        Version of this package.
    seconds
        Time of the release, in seconds since 1970.
    packages
        The pinned packages that it needs to run.

    """
    licences = LicenseFactory()
    root = Component(
        name="osg-studio",
        version=version,
        type=ComponentType.APPLICATION,
        bom_ref="osg-studio",
        purl=PackageURL("pypi", None, "osg-studio", version),
        licenses=[licences.make_from_string("Apache-2.0")],
    )
    needed = [
        Component(
            name=package.name,
            version=package.version,
            bom_ref=package.name,
            purl=PackageURL("pypi", None, package.name, package.version),
            licenses=[licences.make_from_string(package.licence)],
        )
        for package in packages
    ]
    models = [
        Component(
            name=file.filename,
            type=ComponentType.MACHINE_LEARNING_MODEL,
            bom_ref=file.filename,
            hashes=[HashType(alg=HashAlgorithm.SHA_256, content=file.sha256)],
            licenses=[licences.make_from_string("Apache-2.0")],
        )
        for file in (*PACKAGED_FILES, *TAUGHT_FILES)
    ]
    metadata = BomMetaData(
        component=root,
        tools=ToolRepository(components=[this_component()]),
        timestamp=datetime.fromtimestamp(seconds, timezone.utc),
    )
    named = json.dumps([version, seconds, [vars(package) for package in packages]])
    serial = uuid.uuid5(NAMESPACE, named)
    bill = Bom(components=[*needed, *models], metadata=metadata, serial_number=serial)
    bill.register_dependency(root, [*needed, *models])
    return JsonV1Dot6(bill).output_as_string(indent=2) + "\n"
