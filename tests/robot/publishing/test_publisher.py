"""Publishing: the fields are those of ROS 2's definitions, and bad settings are one-line errors."""

from __future__ import annotations

import re
import sys

import pytest

from app.recognition.errors import PublishError
from app.robot.publishing.publisher import open_publisher
from tests.conftest import ROOT

DEFINITIONS = ROOT / "ros2" / "osg_interfaces" / "msg"


def test_without_its_library_publishing_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.delitem(sys.modules, "app.robot.publishing.dds", raising=False)
    for name in [each for each in sys.modules if each.split(".")[0] == "cyclonedds"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "cyclonedds", None)
    with pytest.raises(PublishError, match=r'pip install "osg-studio\[dds\]"'):
        open_publisher("dds")


@pytest.mark.parametrize("domain", ["reef", "-1", "233", "1.5"])
def test_a_domain_that_there_is_not_is_refused(
    monkeypatch: pytest.MonkeyPatch, domain: str
) -> None:
    pytest.importorskip("cyclonedds", reason="needs the extra dds")
    monkeypatch.setenv("ROS_DOMAIN_ID", domain)
    with pytest.raises(PublishError, match="set it to a number from 0 to 232"):
        open_publisher("dds")


@pytest.mark.parametrize("name", ["Answer", "GestureRecognition", "Phrase"])
def test_a_message_has_the_fields_of_its_definition_in_order(name: str) -> None:
    pytest.importorskip("cyclonedds", reason="needs the extra dds")
    from cyclonedds.idl import types

    from app.robot.publishing import dds_messages

    kinds = {
        "std_msgs/Header": dds_messages.Header,
        "builtin_interfaces/Time": dds_messages.Time,
        "string": str,
        "string[]": types.sequence[str],
        "bool": bool,
        "uint8": types.uint8,
        "uint32": types.uint32,
        "float32": types.float32,
        "float64": types.float64,
    }
    definition = (DEFINITIONS / f"{name}.msg").read_text("utf-8")
    defined = re.findall(r"^([\w/[\]]+) (\w+)(?:\s|$)", definition, re.MULTILINE)
    ours = getattr(dds_messages, name).__annotations__
    assert list(ours.items()) == [(name, kinds[kind]) for kind, name in defined]
