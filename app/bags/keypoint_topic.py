"""Keypoint topic: reads a landmark recording and its salute from topics, without a pose model."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from app.bags.bag import Bag, Message, Topic
from app.bags.message_clock import MessageClock
from app.recognition.errors import BagError
from app.recognition.poses.frame import SIDES, Hand
from app.recognition.poses.landmarks import HAND_LANDMARKS, POSE_LANDMARKS
from app.recognition.poses.sequence import FloatArray, PoseSequence
from app.recognition.poses.skeletons import SKELETON_2D, find_missing_landmarks, translate_landmark
from app.recognition.recording.recording import Recording
from app.recognition.recording.video_limits import VideoLimits

OURS = "osg_interfaces/msg/Hands"
PUBLISHED = "std_msgs/msg/Bool"

LONGEST_HOLD = 0.5
"""Seconds for which a salute message is valid without a newer one: the longest gap that a
trajectory bridges too. A node that died with a salute in view must not signal it for ever."""

Stamps: TypeAlias = npt.NDArray[np.int64]


ASSUMED_SIZE = (1280, 720)
"""Width and height in pixels assumed for keypoints in fractions of a picture of unknown size: the
published port's camera (a ZED) at its default resolution."""

LARGEST_FRACTION = 10.0
"""Largest distance of a landmark from the picture's corner, in picture sizes: models place
landmarks one or two pictures beyond the edge; a larger number is an error."""


@dataclass(frozen=True, eq=False)
class Posed:
    """One message's landmarks.

    Attributes
    ----------
    xy
        ``(33, 2)`` of `POSE_LANDMARKS`; NaN: not seen or not given.
    confidence
        ``(33,)`` in [0, 1]; 0 if not seen, 1 if the message gives none.
    size
        Width and height of the picture in pixels, or None if `xy` are fractions of it.
    given
        Names that the message has.

    """

    xy: FloatArray
    confidence: FloatArray
    size: tuple[int, int] | None
    given: frozenset[str]


def keypoint_recording(bag: Bag, topic: Topic) -> Recording:
    """Read a topic of keypoints, and the salute recorded beside it.

    Time is the headers' stamp, or the time of reception without one.

    Raises
    ------
    BagError
        When no message can be read, or none has a known landmark.
    VideoError
        When the topic is longer than `VideoLimits` allow.

    """
    limits = VideoLimits()
    limits.require_frames(topic.messages)
    reader = _READERS[topic.type]
    gathered = _Gathered()
    try:
        for message in bag.messages(topic.name):
            gathered.add(message, reader(message.content), limits)
    except BagError as error:
        if not gathered.posed:
            raise
        gathered.broken = str(error)
    if not any(posed.given for posed in gathered.posed):
        raise BagError(
            f"{bag.name}: no message of {topic.name} names a landmark that is known here, such as "
            "right_wrist; is it a topic of a body?"
        )
    return _recording(
        gathered, salute_track(bag, topic, bool(gathered.clock.by_header)), bag, topic
    )


def keypoint_frame_size(bag: Bag, topic: Topic) -> tuple[int, int]:
    """Return width and height in pixels of the picture of a topic's keypoints.

    Raises
    ------
    BagError
        When the first message cannot be read.

    """
    first = next(bag.messages(topic.name))
    return even_size(_READERS[topic.type](first.content).size or _picture_size(bag) or ASSUMED_SIZE)


def even_size(size: tuple[int, int]) -> tuple[int, int]:
    """Round a size down to even numbers, as the usual video codecs require, to at least 2."""
    width, height = (max(2, side // 2 * 2) for side in size)
    return width, height


@dataclass
class _Gathered:
    """Messages read so far, with their times."""

    posed: list[Posed] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    stamps: list[int] = field(default_factory=list)
    clock: MessageClock = field(default_factory=MessageClock)
    broken: str = ""

    def add(self, message: Message, posed: Posed, limits: VideoLimits) -> None:
        seconds = self.clock.seconds(self.clock.after_first(message))
        limits.require_seconds(seconds)
        self.posed.append(posed)
        self.seconds.append(seconds)
        self.stamps.append(self.clock.stamp(message))


def _recording(gathered: _Gathered, salute: SaluteTrack, bag: Bag, topic: Topic) -> Recording:
    size = next((posed.size for posed in gathered.posed if posed.size), None)
    warnings = []
    if size is None:
        size = salute.frame_size or _picture_size(bag)
    if size is None:
        size = ASSUMED_SIZE
        warnings.append(
            f"{topic.name} has fractions of a picture whose size the recording does not hold; "
            f"{size[0]} x {size[1]} is taken"
        )
    stamps = np.array(gathered.stamps, dtype=np.int64)
    poses = PoseSequence(
        landmarks=POSE_LANDMARKS,
        xy=np.stack([_pixels(posed, size) for posed in gathered.posed]),
        confidence=np.stack([posed.confidence for posed in gathered.posed]),
        time=np.array(gathered.seconds),
        frame_size=even_size(size),
    )
    hands: tuple[tuple[Hand, ...], ...] = salute.hands_at(stamps)
    return Recording(
        poses=poses,
        hands=hands,
        salute=salute.at(stamps),
        warnings=(*warnings, *_warnings(gathered, topic)),
        salute_warnings=tuple(_salute_warnings(salute)),
    )


def _warnings(gathered: _Gathered, topic: Topic) -> list[str]:
    frames = len(gathered.posed)
    found = [f"there is no picture: the skeleton is drawn from the keypoints of {topic.name}"]
    if gathered.broken:
        found.append(f"{frames} of {topic.messages} messages were read, then: {gathered.broken}")
    found += gathered.clock.list_warnings(topic.name, frames)
    if nobody := sum(not posed.given for posed in gathered.posed):
        found.append(f"no person in {nobody} of {frames} messages")
    given = frozenset[str]().union(*(posed.given for posed in gathered.posed))
    if missing := find_missing_landmarks(tuple(given)):
        found.append(f"{topic.name} has no {', '.join(missing)}")
    return found


def _salute_warnings(salute: SaluteTrack) -> Iterator[str]:
    if salute.topic is None:
        yield (
            "the recording holds no topic of the salute; choose the gesture's range by hand, or "
            "record the salute beside the keypoints"
        )
    elif not salute.any:
        yield f"no salute in {salute.topic}; choose the gesture's range by hand"


def _pixels(posed: Posed, size: tuple[int, int]) -> FloatArray:
    """Return landmarks in pixels of a picture of `size`."""
    if posed.size is None:
        return posed.xy * size
    return posed.xy * (size[0] / posed.size[0], size[1] / posed.size[1])


def _picture_size(bag: Bag) -> tuple[int, int] | None:
    """Return the size of raw pictures, or of the camera, in the same recording."""
    for kind in ("sensor_msgs/msg/CameraInfo", "sensor_msgs/msg/Image"):
        for topic in bag.topics:
            if topic.type == kind and topic.messages:
                content = next(bag.messages(topic.name)).content
                if content.width and content.height:
                    return int(content.width), int(content.height)
    return None


def _convert_points(
    points: list[tuple[str, float, float, float]], size: tuple[int, int] | None
) -> Posed:
    """Convert named points to the known landmarks; others are left out."""
    xy, confidence = np.full((len(POSE_LANDMARKS), 2), np.nan), np.zeros(len(POSE_LANDMARKS))
    given = set()
    farthest = LARGEST_FRACTION * (1 if size is None else max(size))
    for said, x, y, belief in points:
        if (name := translate_landmark(said)) is None:
            continue
        given.add(name)
        # NaN fails both comparisons, and -1, -1 is not found.
        if abs(x) <= farthest and abs(y) <= farthest and not x == y < 0:
            row = POSE_LANDMARKS.index(name)
            xy[row] = x, y
            confidence[row] = 1.0 if np.isnan(belief) else min(max(belief, 0.0), 1.0)
    return Posed(xy, confidence, size, frozenset(given))


def _convert_published(content: Any) -> Posed:
    """Read the published port's message: MediaPipe's names, fractions of the picture."""
    points = [(str(p.name), float(p.x), float(p.y), np.nan) for p in content.keypoints]
    return _convert_points(points, None)


def _ours(content: Any) -> Posed:
    """Read our own message: pixels, NaN where not seen."""
    points = [(str(p.name), float(p.x), float(p.y), float(p.confidence)) for p in content.keypoints]
    return _convert_points(points, picture_size_of(content))


def _ros4hri(content: Any) -> Posed:
    """Read ROS4HRI's skeleton: fractions of the picture, confidence 0 where not seen."""
    points = [
        (name or "", float(p.x) if p.c else np.nan, float(p.y), float(p.c))
        for name, p in zip(SKELETON_2D, content.skeleton, strict=True)
    ]
    return _convert_points(points, None)


_READERS: dict[str, Callable[[Any], Posed]] = {
    "keypoints_interfaces/msg/PoseKeypointsArray": _convert_published,
    "osg_interfaces/msg/BodyKeypoints": _ours,
    "hri_msgs/msg/Skeleton2D": _ros4hri,
}


@dataclass(frozen=True, eq=False)
class SaluteTrack:
    """Salute scores of a topic over time.

    Attributes
    ----------
    topic
        Name of the topic; None if the recording has none.
    stamps
        ``(M,)`` nanoseconds, not decreasing.
    scores
        ``(M,)`` in [0, 1].
    hands
        M tuples: the hands of each score's message.
    frame_size
        Width and height of the picture, if the messages state it.

    """

    topic: str | None
    stamps: Stamps
    scores: FloatArray
    hands: tuple[tuple[Hand, ...], ...]
    frame_size: tuple[int, int] | None = None

    @property
    def any(self) -> bool:
        """Whether a salute was ever seen."""
        return bool((self.scores > 0).any())

    def at(self, stamps: Stamps) -> FloatArray:
        """Return the score ``(T,)`` at each moment, in [0, 1]."""
        places = self._places(stamps)
        scores = np.append(self.scores, 0.0)
        return np.asarray(scores[places], dtype=np.float64)

    def hands_at(self, stamps: Stamps) -> tuple[tuple[Hand, ...], ...]:
        """Return the hands seen at each of T moments."""
        hands = (*self.hands, ())
        return tuple(hands[place] for place in self._places(stamps))

    def _places(self, stamps: Stamps) -> npt.NDArray[np.intp]:
        """Return the index ``(T,)`` of the nearest message, -1 if none is near."""
        if not len(self.stamps):
            return np.full(len(stamps), -1, dtype=np.intp)
        after = np.clip(np.searchsorted(self.stamps, stamps), 1, max(1, len(self.stamps) - 1))
        before = after - 1
        after = np.minimum(after, len(self.stamps) - 1)
        nearer = np.abs(self.stamps[after] - stamps) < np.abs(stamps - self.stamps[before])
        places = np.where(nearer, after, before)
        near = np.abs(self.stamps[places] - stamps) <= LONGEST_HOLD * 1e9
        return np.where(near, places, -1)


def salute_track(bag: Bag, keypoints: Topic, by_header: bool) -> SaluteTrack:
    """Read the salute that belongs to a topic of keypoints.

    Our own topic of hands is preferred, then a flag that is named after the salute; of several, the
    one in the keypoints' namespace.

    Parameters
    ----------
    bag, keypoints
        The recording, and the topic.
    by_header
        Whether the keypoints' time is their headers' stamp; the salute's time must be of the same
        clock.

    """
    topic = _choose_topic(bag, keypoints)
    if topic is None:
        return SaluteTrack(None, np.array([], dtype=np.int64), np.array([]), ())
    stamps: list[int] = []
    scores: list[float] = []
    hands: list[tuple[Hand, ...]] = []
    size: tuple[int, int] | None = None
    for message in _readable(bag, topic):
        # A flag has no header; it is received at about the same time as its keypoints.
        stamps.append(message.stamp if by_header and message.stamp else message.received)
        content = message.content
        if topic.type == PUBLISHED:
            scores.append(float(content.data))
            hands.append(())
        else:
            size = size or picture_size_of(content)
            scores.append(float(np.clip(np.nan_to_num(content.salute), 0, 1)))
            hands.append(_hands(content))
    order = np.argsort(stamps, kind="stable")
    return SaluteTrack(
        topic.name,
        np.array(stamps, dtype=np.int64)[order],
        np.array(scores, dtype=np.float64)[order],
        tuple(hands[place] for place in order),
        size,
    )


def _readable(bag: Bag, topic: Topic) -> Iterator[Message]:
    """Yield the messages before any damage in the recording."""
    try:
        yield from bag.messages(topic.name)
    except BagError:
        return


def _choose_topic(bag: Bag, keypoints: Topic) -> Topic | None:
    namespace = keypoints.name.rpartition("/")[0]
    candidates = [
        topic
        for topic in bag.topics
        if topic.messages
        and (topic.type == OURS or (topic.type == PUBLISHED and "salute" in topic.name))
    ]
    return min(
        candidates,
        key=lambda topic: (topic.type != OURS, topic.name.rpartition("/")[0] != namespace),
        default=None,
    )


def picture_size_of(content: Any) -> tuple[int, int] | None:
    """Return width and height of the picture of one of our messages, if it states them."""
    width, height = int(content.image_width), int(content.image_height)
    return (width, height) if width and height else None


def _hands(content: Any) -> tuple[Hand, ...]:
    """Return the complete hands of a message, the larger first."""
    found = []
    for hand in content.hands:
        points = {str(p.name).lower(): (float(p.x), float(p.y)) for p in hand.keypoints}
        side = next((side for side in SIDES if side == hand.side), None)
        if side is None or not set(HAND_LANDMARKS) <= set(points):
            continue
        xy = np.array([points[name] for name in HAND_LANDMARKS])
        if np.isfinite(xy).all():
            score = float(np.clip(np.nan_to_num(hand.score), 0, 1))
            found.append(Hand(xy=xy, side=side, score=score))
    return tuple(sorted(found, key=lambda hand: hand.size, reverse=True))
