"""DDS messages: ROS 2 message types in the form that Cyclone DDS serialises."""

from dataclasses import dataclass, field

from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import float32, float64, int32, sequence, uint8, uint32


@dataclass
class String(IdlStruct, typename="std_msgs::msg::dds_::String_"):
    """``std_msgs/String``."""

    data: str = ""


@dataclass
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    """``builtin_interfaces/Time``."""

    sec: int32 = 0
    nanosec: uint32 = 0


@dataclass
class Header(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
    """``std_msgs/Header``."""

    stamp: Time = field(default_factory=Time)
    frame_id: str = ""


@dataclass
class GestureRecognition(IdlStruct, typename="osg_interfaces::msg::dds_::GestureRecognition_"):
    """``osg_interfaces/GestureRecognition``; its ``.msg`` file describes the fields."""

    header: Header = field(default_factory=Header)
    body_id: str = ""
    language_id: str = ""
    language_name: str = ""
    language_revision: uint32 = 0
    profile: str = ""
    start: Time = field(default_factory=Time)
    end: Time = field(default_factory=Time)
    closed: bool = False
    label: str = ""
    nearest: str = ""
    confidence: float64 = 0.0
    margin: float64 = 0.0
    rejected: bool = False
    reason: str = ""
    report: str = ""
    pair: sequence[str] = field(default_factory=list)
    novelty: float64 = 0.0


@dataclass
class Answer(IdlStruct, typename="osg_interfaces::msg::dds_::Answer_"):
    """``osg_interfaces/Answer``; its ``.msg`` file describes the fields."""

    header: Header = field(default_factory=Header)
    answer: str = ""
    pulses: uint8 = 0
    pulse_seconds: float32 = 0.0
    text: str = ""


@dataclass
class Phrase(IdlStruct, typename="osg_interfaces::msg::dds_::Phrase_"):
    """``osg_interfaces/Phrase``; its ``.msg`` file describes the fields."""

    header: Header = field(default_factory=Header)
    body_id: str = ""
    language_id: str = ""
    language_revision: uint32 = 0
    kind: str = ""
    start: Time = field(default_factory=Time)
    end: Time = field(default_factory=Time)
    gestures: sequence[str] = field(default_factory=list)
    label: str = ""
    expected: sequence[str] = field(default_factory=list)
    confidence: float64 = 0.0
    mission: str = ""
    text: str = ""
    pair: sequence[str] = field(default_factory=list)
