"""DDS publisher: publishes to ROS 2 nodes without ROS 2, through Eclipse Cyclone DDS.

The topics are named as ROS 2 names its own, so any node of the same domain can subscribe. A
subscriber to a topic of type ``std_msgs/String`` needs no package of this project.
"""

import json
import os
from collections.abc import Mapping
from contextlib import suppress
from datetime import datetime
from typing import Final, TypeVar

from cyclonedds.core import DDSException
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from app.recognition.errors import PublishError
from app.robot import events
from app.robot.commands.replies import PULSE_SECONDS
from app.robot.event_messages import format_line
from app.robot.publishing.dds_messages import (
    Answer,
    GestureRecognition,
    Header,
    Phrase,
    String,
    Time,
)
from app.robot.take_result import list_message_fields

NAMESPACE: Final = "osg"
"""First part of the topic names, such as ``/osg/events``."""

LAST_DOMAIN: Final = 232
"""Highest domain number with valid ports (OMG DDSI-RTPS 2.5, 9.6.2.3)."""

KEPT: Final = 10
"""Messages kept for a slow subscriber, the default of ROS."""

NANOSECONDS: Final = 1_000_000_000

LOCALHOST_CONFIGURATION: Final = """
<CycloneDDS><Domain>
  <General>
    <Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces>
    <AllowMulticast>false</AllowMulticast>
  </General>
  <Discovery>
    <ParticipantIndex>auto</ParticipantIndex>
    <MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>
    <Peers><Peer address="127.0.0.1"/></Peers>
  </Discovery>
</Domain></CycloneDDS>
"""
"""Cyclone configuration that restricts it to this machine, as ROS 2 itself sets it."""

RELIABLE: Final = Qos(
    Policy.Reliability.Reliable(duration(milliseconds=100)),
    Policy.Durability.Volatile,
    Policy.History.KeepLast(KEPT),
)
"""Volatile: a late subscriber must not act on an old recognition."""

Sample = TypeVar("Sample", bound=IdlStruct)


class DdsPublisher:
    """Publisher of a robot's events in a DDS domain; a `Publisher`.

    ``/osg/events`` (``std_msgs/String``) carries the JSON line of every event,
    ``/osg/recognition`` (``osg_interfaces/GestureRecognition``) every take,
    ``/osg/recognized_gesture`` (``std_msgs/String``, the topic of the published ROS port) the label
    of every recognised take, ``/osg/phrase`` (``osg_interfaces/Phrase``) the phrase event of each
    take or pause in a language with phrases, and ``/osg/answer`` (``osg_interfaces/Answer``) every
    answer to the diver.

    Parameters
    ----------
    environment
        Variables of ROS 2: the domain (``ROS_DOMAIN_ID``), and whether to stay on this machine
        (``ROS_AUTOMATIC_DISCOVERY_RANGE``, ``ROS_LOCALHOST_ONLY``).

    Raises
    ------
    PublishError
        When the domain is not a valid number, or cannot be joined.

    """

    def __init__(self, environment: Mapping[str, str] = os.environ) -> None:
        number = _domain(environment)
        # The configuration holds only as long as the Domain object exists.
        try:
            configuration = LOCALHOST_CONFIGURATION
            self._domain = Domain(number, configuration) if is_local(environment) else None
            self._participant = DomainParticipant(number)
            self._events = self._writer("events", String)
            self._labels = self._writer("recognized_gesture", String)
            self._takes = self._writer("recognition", GestureRecognition)
            self._phrases = self._writer("phrase", Phrase)
            self._answers = self._writer("answer", Answer)
        except DDSException as error:
            raise PublishError(
                f"DDS domain {number} cannot be joined ({error}); is there a network? For this "
                "machine alone set ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST"
            ) from error
        self._origin = 0
        self._language = ""

    def publish(self, event: events.Event) -> None:
        """Send one event; a subscriber that is too slow loses it."""
        # A failed write must not stop the recognition.
        with suppress(DDSException):
            self._send(event)

    def _send(self, event: events.Event) -> None:
        if isinstance(event, events.SourceOpened):
            self._origin = _nanoseconds(event.began)
        if isinstance(event, events.LanguageChanged):
            self._language = event.name
        self._events.write(String(format_line(event)))
        if isinstance(event, events.TakeEvent):
            self._takes.write(self._recognition(event))
        if isinstance(event, events.TakeRecognized):
            self._labels.write(String(event.label))
        if isinstance(event, events.PhraseHeard):
            self._phrases.write(self._phrase(event))
        if isinstance(event, events.AnswerGiven):
            self._answers.write(
                Answer(
                    header=Header(self._stamp(event.time)),
                    answer=event.answer.value,
                    pulses=event.pulses,
                    pulse_seconds=PULSE_SECONDS,
                    text=event.text,
                )
            )

    def close(self) -> None:
        """Leave the domain."""
        del self._events, self._labels, self._takes, self._phrases, self._answers
        del self._participant, self._domain

    def _writer(self, name: str, kind: type[Sample]) -> DataWriter[Sample]:
        topic = Topic(self._participant, f"rt/{NAMESPACE}/{name}", kind, qos=RELIABLE)
        return DataWriter(self._participant, topic, qos=RELIABLE)

    def _recognition(self, event: events.TakeEvent) -> GestureRecognition:
        return GestureRecognition(
            header=Header(self._stamp(event.time)),
            start=self._stamp(event.start),
            end=self._stamp(event.end),
            **list_message_fields(event, self._language),
        )

    def _phrase(self, event: events.PhraseHeard) -> Phrase:
        phrase = event.phrase
        mission = None if phrase.mission is None else phrase.mission.to_list()
        return Phrase(
            header=Header(self._stamp(event.time)),
            language_id=event.sha256,
            language_revision=event.revision,
            kind=phrase.kind,
            start=self._stamp(phrase.start),
            end=self._stamp(phrase.end),
            gestures=list(phrase.gestures),
            label=phrase.label or "",
            expected=list(phrase.expected),
            confidence=event.confidence,
            mission="" if mission is None else json.dumps(mission, allow_nan=False),
            text=phrase.text,
            pair=list(phrase.pair or ()),
        )

    def _stamp(self, seconds: float) -> Time:
        whole, rest = divmod(self._origin + round(seconds * NANOSECONDS), NANOSECONDS)
        return Time(whole, rest)


def is_local(environment: Mapping[str, str]) -> bool:
    """Return whether ROS 2's variables restrict it to this machine."""
    discovery = environment.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "").upper()
    return discovery == "LOCALHOST" or environment.get("ROS_LOCALHOST_ONLY") == "1"


def _domain(environment: Mapping[str, str]) -> int:
    text = environment.get("ROS_DOMAIN_ID", "").strip() or "0"
    if not text.isdecimal() or int(text) > LAST_DOMAIN:
        raise PublishError(f"ROS_DOMAIN_ID is {text!r}; set it to a number from 0 to {LAST_DOMAIN}")
    return int(text)


def _nanoseconds(began: datetime | None) -> int:
    """Return the start of a source's clock in nanoseconds since 1970; 0 for a recording."""
    return 0 if began is None else round(began.timestamp() * 1e6) * 1000
