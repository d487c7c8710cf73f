"""The definitions known here are those of the packages, field by field."""

from __future__ import annotations

from pathlib import Path

import pytest
from rosbags.typesys import get_types_from_msg

from app.bags.bag import USES
from app.bags.keypoint_topic import _READERS
from app.bags.message_definitions import DEFINITIONS
from tests.conftest import ROOT

PACKAGES = ROOT / "ros2"
OURS = [name for name in DEFINITIONS if (PACKAGES / name.split("/")[0]).is_dir()]


@pytest.mark.parametrize("name", OURS)
def test_a_definition_is_that_of_the_package_beside(name: str) -> None:
    package, _, message = name.split("/")
    text = Path(PACKAGES, package, "msg", f"{message}.msg").read_text()
    (_, theirs) = get_types_from_msg(text, name)[name]
    (_, known) = get_types_from_msg(DEFINITIONS[name], name)[name]
    assert known == theirs


def test_the_packages_beside_are_found() -> None:
    assert {name.split("/")[0] for name in OURS} == {"keypoints_interfaces", "osg_interfaces"}


def test_every_type_of_keypoints_can_be_read() -> None:
    assert {kind for kind, use in USES.items() if use == "keypoints"} == set(_READERS)
