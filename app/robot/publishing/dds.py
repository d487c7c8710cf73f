"""Publishing to ROS 2 without ROS 2: Eclipse Cyclone DDS with the names that ROS gives its topics.

Any node of the same domain hears it. ``std_msgs/String`` needs no package of ours there.
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
from app.robot.events import (
    Event,
    LanguageChanged,
    PhraseHeard,
    SourceOpened,
    TakeRecognized,
    TakeRejected,
)
from app.robot.messages import line_of
from app.robot.publishing.dds_messages import GestureRecognition, Header, Phrase, String, Time

NAMESPACE: Final = "osg"
"""Of the topics: ``/osg/events`` and so on."""

LAST_DOMAIN: Final = 232
"""The highest number whose ports exist (OMG DDSI-RTPS 2.5, 9.6.2.3)."""

KEPT: Final = 10
"""Messages kept while a subscriber is slow, as ROS does by default."""

NANOSECONDS: Final = 1_000_000_000

HERE_ALONE: Final = """
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
"""Cyclone's configuration that ROS 2 itself gives it where only this machine is wanted."""

RELIABLE: Final = Qos(
    Policy.Reliability.Reliable(duration(milliseconds=100)),
    Policy.Durability.Volatile,
    Policy.History.KeepLast(KEPT),
)
"""Nothing is kept for who comes later: a recognition of the past must not steer a robot today."""

Sample = TypeVar("Sample", bound=IdlStruct)


class DdsPublisher:
    """Tells a DDS domain what a robot's runtime tells; a `Publisher`.

    ``/osg/events`` (``std_msgs/String``) carries the JSON line of every event,
    ``/osg/recognition`` (``osg_interfaces/GestureRecognition``) every take,
    ``/osg/recognized_gesture`` (``std_msgs/String``) the labels of recognised ones, which is the
    published port's topic, and ``/osg/phrase`` (``osg_interfaces/Phrase``) what came of each take
    or pause in a language with phrases.

    Parameters
    ----------
    environment
        Where ROS 2's own variables are looked up: ``ROS_DOMAIN_ID``, and whether only this machine
        is wanted (``ROS_AUTOMATIC_DISCOVERY_RANGE``, ``ROS_LOCALHOST_ONLY``).

    Raises
    ------
    PublishError
        When the domain is no number that there is, or cannot be joined.

    """

    def __init__(self, environment: Mapping[str, str] = os.environ) -> None:
        number = _domain(environment)
        # Kept: when it is forgotten, so is the configuration.
        try:
            self._domain = Domain(number, HERE_ALONE) if is_local(environment) else None
            self._participant = DomainParticipant(number)
            self._events = self._writer("events", String)
            self._labels = self._writer("recognized_gesture", String)
            self._takes = self._writer("recognition", GestureRecognition)
            self._phrases = self._writer("phrase", Phrase)
        except DDSException as error:
            raise PublishError(
                f"DDS domain {number} cannot be joined ({error}); is there a network? For this "
                "machine alone set ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST"
            ) from error
        self._origin = 0
        self._language = ""

    def publish(self, event: Event) -> None:
        """Send one event; what a subscriber is too slow for is lost to it."""
        # Better a line less than a robot that stops listening.
        with suppress(DDSException):
            self._send(event)

    def _send(self, event: Event) -> None:
        if isinstance(event, SourceOpened):
            self._origin = _nanoseconds(event.began)
        if isinstance(event, LanguageChanged):
            self._language = event.name
        self._events.write(String(line_of(event)))
        if isinstance(event, TakeRecognized | TakeRejected):
            self._takes.write(self._recognition(event))
        if isinstance(event, TakeRecognized):
            self._labels.write(String(event.label))
        if isinstance(event, PhraseHeard):
            self._phrases.write(self._phrase(event))

    def close(self) -> None:
        """Leave the domain."""
        del self._events, self._labels, self._takes, self._phrases
        del self._participant, self._domain

    def _writer(self, name: str, kind: type[Sample]) -> DataWriter[Sample]:
        topic = Topic(self._participant, f"rt/{NAMESPACE}/{name}", kind, qos=RELIABLE)
        return DataWriter(self._participant, topic, qos=RELIABLE)

    def _recognition(self, event: TakeRecognized | TakeRejected) -> GestureRecognition:
        answer = event.recognition
        return GestureRecognition(
            header=Header(self._stamp(event.time)),
            language_id=event.sha256,
            language_name=self._language,
            language_revision=event.revision,
            profile=answer.profile if answer else "",
            start=self._stamp(event.start),
            end=self._stamp(event.end),
            closed=event.closed,
            label=event.label if isinstance(event, TakeRecognized) else "",
            nearest=event.nearest or "",
            confidence=event.confidence or 0.0,
            margin=event.margin or 0.0,
            rejected=isinstance(event, TakeRejected),
            reason=event.reason if isinstance(event, TakeRejected) else "",
            report=json.dumps(answer.to_dict(), allow_nan=False) if answer else "",
        )

    def _phrase(self, event: PhraseHeard) -> Phrase:
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
        )

    def _stamp(self, seconds: float) -> Time:
        whole, rest = divmod(self._origin + round(seconds * NANOSECONDS), NANOSECONDS)
        return Time(whole, rest)


def is_local(environment: Mapping[str, str]) -> bool:
    """Tell whether ROS 2's variables want this machine alone."""
    discovery = environment.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "").upper()
    return discovery == "LOCALHOST" or environment.get("ROS_LOCALHOST_ONLY") == "1"


def _domain(environment: Mapping[str, str]) -> int:
    text = environment.get("ROS_DOMAIN_ID", "").strip() or "0"
    if not text.isdecimal() or int(text) > LAST_DOMAIN:
        raise PublishError(f"ROS_DOMAIN_ID is {text!r}; set it to a number from 0 to {LAST_DOMAIN}")
    return int(text)


def _nanoseconds(began: datetime | None) -> int:
    """Return when a source's clock was 0, since 1970; a recording counts from its beginning."""
    return 0 if began is None else round(began.timestamp() * 1e6) * 1000
