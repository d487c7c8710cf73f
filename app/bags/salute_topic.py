"""Salute topic: reads salute scores and hands from the topics recorded beside keypoints."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from app.bags.bag import Bag, Message, Topic
from app.recognition.errors import BagError
from app.recognition.poses.frame import SIDES, Hand
from app.recognition.poses.landmarks import HAND_LANDMARKS
from app.recognition.poses.sequence import FloatArray

OURS = "osg_interfaces/msg/Hands"
PUBLISHED = "std_msgs/msg/Bool"

LONGEST_HOLD = 0.5
"""Seconds for which a salute message is valid without a newer one: the longest gap that a
trajectory bridges too. A node that died with a salute in view must not signal it for ever."""

Stamps: TypeAlias = npt.NDArray[np.int64]


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
