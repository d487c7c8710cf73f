"""rosbag2 reader: topics, and their messages one at a time."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal

from app.bags.bag_kind import METADATA, split_parts
from app.bags.mcap_chunks import MOST_UNPACKED, limit_unpacking, require_little_overlap, too_large
from app.bags.session_reader import TOPICS as SESSION_TOPICS
from app.bags.session_reader import SessionReader, is_session
from app.bags.staging import stage
from app.recognition.errors import BagError, OsgError, TopicError, explain_missing_package

DEFINITIONS = {
    # The published implementation's port to ROS 2.
    "keypoints_interfaces/msg/PoseKeypoints": "string name\nfloat32 x\nfloat32 y\n",
    "keypoints_interfaces/msg/PoseKeypointsArray": "PoseKeypoints[] keypoints\n",
    # Our own, as in ros2/osg_interfaces/msg.
    "osg_interfaces/msg/Keypoint": "string name\nfloat64 x\nfloat64 y\nfloat64 confidence\n",
    "osg_interfaces/msg/Hand": "string side\nfloat64 score\nKeypoint[] keypoints\n",
    "osg_interfaces/msg/Hands": (
        "std_msgs/Header header\nuint32 image_width\nuint32 image_height\nfloat64 salute\n"
        "Hand[] hands\n"
    ),
    "osg_interfaces/msg/BodyKeypoints": (
        "std_msgs/Header header\nstring body_id\nuint32 image_width\nuint32 image_height\n"
        "float64 score\nKeypoint[] keypoints\n"
    ),
    # ROS4HRI (REP-155).
    "hri_msgs/msg/NormalizedPointOfInterest2D": "float32 x\nfloat32 y\nfloat32 c\n",
    "hri_msgs/msg/Skeleton2D": (
        "std_msgs/Header header\nNormalizedPointOfInterest2D[18] skeleton\n"
    ),
    # ffmpeg_image_transport and Foxglove's bridge.
    "ffmpeg_image_transport_msgs/msg/FFMPEGPacket": (
        "std_msgs/Header header\nint32 width\nint32 height\nstring encoding\nuint64 pts\n"
        "uint8 flags\nbool is_bigendian\nuint8[] data\n"
    ),
    "foxglove_msgs/msg/CompressedVideo": (
        "builtin_interfaces/Time timestamp\nstring frame_id\nuint8[] data\nstring format\n"
    ),
}
"""Definition by type name, without comments and constants, which do not affect decoding."""


if TYPE_CHECKING:
    from rosbags.interfaces import Connection, TopicInfo
    from rosbags.rosbag2 import Reader
    from rosbags.typesys.store import Typestore

Use = Literal["pictures", "keypoints"]

USES: dict[str, Use] = {
    "sensor_msgs/msg/Image": "pictures",
    "sensor_msgs/msg/CompressedImage": "pictures",
    "ffmpeg_image_transport_msgs/msg/FFMPEGPacket": "pictures",
    "foxglove_msgs/msg/CompressedVideo": "pictures",
    "keypoints_interfaces/msg/PoseKeypointsArray": "keypoints",
    "osg_interfaces/msg/BodyKeypoints": "keypoints",
    "hri_msgs/msg/Skeleton2D": "keypoints",
}
"""Use of a topic, by message type."""

DEPTH_ENCODINGS = ("16UC1", "32FC1", "compressedDepth")
"""Encodings in which ROS stores distances (REP-118), in which nobody can be recognised."""

MOST_TOPICS_NAMED = 8
"""Most topics named in a one-line message; a robot records fifty."""

NEEDED: Final = ("studio", BagError, " (on a robot: [robot])")
"""What `explain_missing_package` says where the packages that read recordings are missing."""


@dataclass(frozen=True)
class Topic:
    """One topic of a recording.

    Attributes
    ----------
    name
        As in ROS, with its leading slash.
    type
        Type of its messages, such as ``sensor_msgs/msg/Image``; empty if several types share the
        name.
    use
        ``pictures``, ``keypoints``, or None for a topic that this program cannot use.
    messages
        Count.

    """

    name: str
    type: str
    use: Use | None
    messages: int

    @property
    def usable(self) -> bool:
        """Whether a clip can be made of it."""
        return self.use is not None and self.messages > 0


@dataclass(frozen=True, eq=False)
class Message:
    """One message of a topic.

    Attributes
    ----------
    received
        Nanoseconds since 1970 by the recording machine's clock.
    content
        The message as rosbags gives it, an object with the fields of its definition.

    """

    received: int
    content: Any

    @property
    def stamp(self) -> int:
        """Time of acquisition in nanoseconds (the header's stamp), or 0 without a stamp."""
        header = getattr(self.content, "header", self.content)
        stamp = getattr(header, "stamp", getattr(self.content, "timestamp", None))
        return 0 if stamp is None else int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)


class Bag:
    """An open recording, created by `open_bag`.

    Parameters
    ----------
    reader
        Open reader of rosbags, or of the parts of a recording that was split.
    place
        Path that it reads.
    name
        Name of the recording in messages.

    """

    def __init__(self, reader: Reader | SplitReader, place: Path, name: str) -> None:
        self._reader = reader
        self._place = place
        self.name = name
        self.topics = tuple(_topic(name, info) for name, info in reader.topics.items())

    def usable_topics(self) -> list[Topic]:
        """Return the topics that a clip can be made of, those that seem to hold depth last."""
        usable = [topic for topic in self.topics if topic.usable]
        return sorted(usable, key=self._shows_depth) if len(usable) > 1 else usable

    def topic(self, name: str | None = None) -> Topic:
        """Return the topic to make a clip of.

        Parameters
        ----------
        name
            Name of the requested topic; None for the only usable one.

        Raises
        ------
        TopicError
            When no usable topic has that name, or no name is given and several topics are usable.
        BagError
            When there is no usable topic at all.

        """
        usable = self.usable_topics()
        if not usable:
            raise BagError(self._explain_unusable())
        if name is None:
            if len(usable) == 1:
                return usable[0]
            raise TopicError(
                f"{self.name} has {len(usable)} topics to choose from: {_list_topics(usable)}; "
                f"name one (--topic {usable[0].name})"
            )
        for topic in usable:
            if topic.name == name:
                return topic
        raise TopicError(f"{self.name}: {self._refusal(name)}; usable are {_list_topics(usable)}")

    def messages(self, topic: str) -> Iterator[Message]:
        """Yield a topic's messages in the order in which they were received.

        Raises
        ------
        BagError
            When the part read is damaged, or a message does not match its type.

        """
        connections = [each for each in self._reader.connections if each.topic == topic]
        if not connections:
            return
        kind = connections[0].msgtype
        with _convert_errors(self._place, self.name):
            store = _typestore(connections[0])
            for _, received, data in self._reader.messages(connections):
                yield Message(received, store.deserialize_cdr(data, kind))

    def durations(self) -> dict[str, float]:
        """Return the seconds from the first to the last message of every usable topic.

        The whole recording is read; in a damaged one, unreadable messages do not count.
        """
        usable = {topic.name for topic in self.topics if topic.usable}
        chosen = [each for each in self._reader.connections if each.topic in usable]
        spans: dict[str, tuple[int, int]] = {}
        with suppress(BagError), _convert_errors(self._place, self.name):
            for connection, received, _ in self._reader.messages(chosen):
                first, last = spans.get(connection.topic, (received, received))
                spans[connection.topic] = min(first, received), max(last, received)
        return {name: (last - first) / 1e9 for name, (first, last) in spans.items()}

    def _shows_depth(self, topic: Topic) -> bool:
        """Return whether a topic's name or first picture says that it holds distances."""
        if topic.use != "pictures" or "depth" in topic.name.lower():
            return topic.use == "pictures"
        with suppress(BagError):
            for message in self.messages(topic.name):
                stated = getattr(message.content, "encoding", None)
                stated = stated or getattr(message.content, "format", "")
                return any(each in str(stated) for each in DEPTH_ENCODINGS)
        return False

    def _explain_unusable(self) -> str:
        empty = [topic for topic in self.topics if topic.use]
        if empty:
            log = ", or does the .db3 lack its -wal?" if self._place.suffix == ".db3" else "?"
            return (
                f"{self.name}: its topics of pictures or keypoints have no messages "
                f"({_list_topics(empty)}); was the camera running{log} Record it again"
            )
        held = _list_topics(list(self.topics)) or "no topics at all"
        return (
            f"{self.name} holds nothing to recognise gestures in, only {held}; record a topic of "
            f"{', '.join(kind.replace('/msg/', '/') for kind in USES)}"
        )

    def _refusal(self, name: str) -> str:
        for topic in self.topics:
            if topic.name == name:
                state = "has no messages" if topic.use else f"is of type {topic.type}"
                return f"topic {name} {state} and cannot be used"
        return f"there is no topic {name!r}"


class SessionBag(Bag):
    """A session that this program has written, of which the keypoints are read.

    Parameters
    ----------
    session
        Its open reader.
    place, name
        See `Bag`.

    """

    def __init__(self, session: SessionReader, place: Path, name: str) -> None:
        self._session = session
        self._place = place
        self.name = name
        self.topics = tuple(
            Topic(topic, kind, USES.get(kind), session.frames)
            for topic, kind in SESSION_TOPICS.items()
        )

    def messages(self, topic: str) -> Iterator[Message]:
        """Yield a topic's messages in order; raises BagError when the file is damaged."""
        with _convert_errors(self._place, self.name):
            for received, content in self._session.messages(topic):
                yield Message(received, content)

    def durations(self) -> dict[str, float]:
        """Return the seconds from the first to the last frame."""
        return {topic.name: self._session.seconds for topic in self.topics if topic.usable}


@contextmanager
def open_bag(path: str | Path) -> Iterator[Bag]:
    """Open a recording: a rosbag2 folder, its one file, or a zip of either.

    Raises
    ------
    BagError
        When it is no recording, is damaged, or the packages that read it are not installed.

    """
    place = Path(path)
    with explain_missing_package(f"the dive recording {place.name}", *NEEDED):
        from rosbags.rosbag2 import Reader
    limit_unpacking()
    with ExitStack() as open_things:
        found = open_things.enter_context(stage(place))
        with _convert_errors(found, place.name):
            bag: Bag
            if is_session(found):
                file = open_things.enter_context(found.open("rb"))
                bag = SessionBag(SessionReader(file), found, place.name)
            else:
                is_split = found.is_dir() and not (found / METADATA).is_file()
                parts = split_parts(found) if is_split else []
                readers = [open_things.enter_context(Reader(part)) for part in parts or (found,)]
                for each in readers:
                    require_little_overlap(each)
                reader = SplitReader(readers, place.name) if parts else readers[0]
                bag = Bag(reader, found, place.name)
        yield bag


class SplitReader:
    """Reads the parts of a recording, whose metadata is lost, as one; see `split_parts`.

    Parameters
    ----------
    readers
        Open readers of rosbags, one a part, in order.
    name
        Name of the recording in messages.

    Raises
    ------
    BagError
        When the parts overlap in time, and so are no parts of one recording.

    """

    def __init__(self, readers: Sequence[Reader], name: str) -> None:
        self._readers = [reader for reader in readers if reader.message_count]
        for one, other in pairwise(self._readers):
            if one.end_time > other.start_time:
                raise BagError(
                    f"{name} holds files that are numbered as parts of one recording, but overlap "
                    "in time; give each recording by itself, with its metadata.yaml"
                )
        self.connections = [each for reader in self._readers for each in reader.connections]

    @property
    def topics(self) -> dict[str, TopicInfo]:
        """What the parts hold of each topic, together."""
        found: dict[str, TopicInfo] = {}
        for reader in self._readers:
            for topic, info in reader.topics.items():
                known = found.get(topic)
                if known is None:
                    found[topic] = info
                    continue
                kind = info.msgtype if info.msgtype == known.msgtype else None
                count = known.msgcount + info.msgcount
                connections = [*known.connections, *info.connections]
                found[topic] = info._replace(msgtype=kind, msgcount=count, connections=connections)
        return found

    def messages(
        self, connections: Collection[Connection]
    ) -> Iterator[tuple[Connection, int, bytes]]:
        """Yield the messages of these connections, part after part."""
        for reader in self._readers:
            own = [each for each in connections if any(each is one for one in reader.connections)]
            if own:
                yield from reader.messages(own)


def _topic(name: str, info: TopicInfo) -> Topic:
    kind = info.msgtype or ""
    return Topic(name, kind, USES.get(kind), info.msgcount)


def _typestore(connection: Connection) -> Typestore:
    """Return the type store of a connection's messages; the recording's definitions come first."""
    from rosbags.interfaces import MessageDefinitionFormat
    from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore

    kind, definition = connection.msgtype, connection.msgdef
    if definition.format == MessageDefinitionFormat.MSG:
        store = get_typestore(Stores.EMPTY)
        store.register(get_types_from_msg(definition.data, kind))
        return store
    if definition.format == MessageDefinitionFormat.IDL:
        store = get_typestore(Stores.EMPTY)
        for part in definition.data.split("=" * 80 + "\n"):
            text = part.partition("\n")[2] if part.startswith("IDL: ") else part
            if text.strip():
                store.register(get_types_from_idl(text))
        return store
    # The layout of these types is the same in every later distribution.
    store = get_typestore(Stores.ROS2_HUMBLE)
    for name, text in DEFINITIONS.items():
        store.register(get_types_from_msg(text, name))
    if kind not in store.fielddefs:
        raise BagError(
            f"messages of topic {connection.topic} are of type {kind}, whose definition the "
            "recording does not hold; record it with storage mcap, which keeps definitions"
        )
    return store


@contextmanager
def _convert_errors(place: Path, name: str) -> Iterator[None]:
    """Convert any error of a reader in a damaged recording to an error of one line.

    The message contains the `name` of the recording, not the `place` from which it is read.
    """
    try:
        yield
    except (OsgError, MemoryError, OSError):
        raise
    # rosbags validates little: struct.error, IndexError, KeyError, AssertionError and the errors of
    # three compression libraries and SQLite all mean the same here.
    except Exception as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        reason = reason.replace(str(place), name)
        if type(error).__name__ == "TooBigError":  # SQLite's, of the limit of a row
            raise too_large(MOST_UNPACKED) from error
        if "rofile is not ros2" in reason:
            raise BagError(
                f"{name} is an MCAP file of another program, not a ROS 2 recording (of ROS 1, or "
                "with Protobuf or JSON messages); give the video itself, or convert ROS 1 by "
                "`rosbags-convert`"
            ) from error
        raise BagError(
            f"{name} is damaged or cut short ({reason}); copy it again, or repair it with "
            "`ros2 bag reindex` or `mcap recover`"
        ) from error


def _list_topics(topics: list[Topic]) -> str:
    shown = [
        f"{topic.name} ({topic.type.replace('/msg/', '/')}, {topic.messages} messages)"
        for topic in topics[:MOST_TOPICS_NAMED]
    ]
    more = [f"{len(topics) - MOST_TOPICS_NAMED} more"] if len(topics) > MOST_TOPICS_NAMED else []
    return ", ".join(shown + more)
