"""Session reader: the keypoints in a file of `app.bags.export_writer`, as our ROS messages.

Pictures and recognitions of a session are not read: its landmarks are those of the clip.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import IO, Any, Final

import numpy as np

from app.bags.mcap_chunks import require_stated_sizes
from app.recognition.errors import BagError
from app.recognition.poses.frame import SIDES, Hand
from app.recognition.poses.landmarks import HAND_LANDMARKS
from app.recognition.recording.salute import best_salute

KEYPOINTS: Final = "/keypoints"
"""The session's topic of body and hands."""

TOPICS: Final[Mapping[str, str]] = {
    KEYPOINTS: "osg_interfaces/msg/BodyKeypoints",
    "/hands": "osg_interfaces/msg/Hands",
}
"""Types of the topics as which it is read."""

FIRST: Final = 1_000_000_000
"""Nanoseconds of the first frame's stamp: a stamp of 0 would be none."""

_MAGIC: Final = b"\x89MCAP0\r\n"
_HEADER: Final = 1
_LENGTHS: Final = 8 + 4
"""Bytes of the lengths of the header and of its profile, which is empty."""


def is_session(path: Path) -> bool:
    """Return whether a file is an MCAP file whose header names this program."""
    if not path.is_file():
        return False
    with path.open("rb") as file:
        head = file.read(64)
    begin = len(_MAGIC) + 1 + _LENGTHS
    named = head[: len(_MAGIC) + 1] == _MAGIC + bytes([_HEADER])
    return named and head[begin + 4 :].startswith(b"osg-studio ")


class SessionReader:
    """Reads a session's frames.

    Parameters
    ----------
    file
        The open file.

    Attributes
    ----------
    frames, seconds
        Their number, and the seconds from the first to the last.

    Raises
    ------
    BagError
        When it holds no keypoints.
    Exception
        Of the library, when the file is damaged.

    """

    def __init__(self, file: IO[bytes]) -> None:
        from mcap.reader import make_reader

        self._reader = make_reader(file)
        summary = self._reader.get_summary()
        if summary is None or summary.statistics is None:
            raise BagError("the session was not written to its end; export it again")
        require_stated_sizes(file, summary.chunk_indexes)
        counts = summary.statistics.channel_message_counts
        self.frames = sum(
            counts.get(channel.id, 0)
            for channel in summary.channels.values()
            if channel.topic == KEYPOINTS
        )
        times = summary.statistics.message_start_time, summary.statistics.message_end_time
        self.seconds = (times[1] - times[0]) / 1e9

    def messages(self, topic: str) -> Iterator[tuple[int, Any]]:
        """Yield nanoseconds and content of the messages of one of `TOPICS`, in order."""
        if topic == KEYPOINTS:
            for time, frame in self._read(KEYPOINTS):
                points = [SimpleNamespace(**point) for point in frame["body"]]
                yield _message(time, frame, keypoints=points)
            return
        # The score is of the language's trigger, and that of the salute where hands are missing.
        scores: dict[int, float] = {}
        if not any(frame["hands"] for _, frame in self._read(KEYPOINTS)):
            scores = {time: float(state["score"]) for time, state in self._read("/salute")}
        for time, frame in self._read(KEYPOINTS):
            seen = _hands(frame["hands"])
            found = [
                SimpleNamespace(side=hand.side, score=hand.score, keypoints=_name_points(hand))
                for hand in seen
            ]
            yield _message(time, frame, hands=found, salute=scores.get(time, best_salute(seen)))

    def _read(self, topic: str) -> Iterator[tuple[int, dict[str, Any]]]:
        for _, _, message in self._reader.iter_messages(topics=[topic]):
            yield message.log_time, json.loads(message.data)


def _message(time: int, frame: Mapping[str, Any], **fields: Any) -> tuple[int, Any]:
    """Return a message with the header and picture size of a frame, and these fields."""
    stamp = time + FIRST
    moment = SimpleNamespace(sec=stamp // FIRST, nanosec=stamp % FIRST)
    return stamp, SimpleNamespace(
        header=SimpleNamespace(stamp=moment),
        image_width=frame["image_width"],
        image_height=frame["image_height"],
        **fields,
    )


def _hands(hands: Sequence[Mapping[str, Any]]) -> list[Hand]:
    """Return the complete hands; a session leaves out points that were not seen."""
    return [
        Hand(
            xy=np.array([[point["x"], point["y"]] for point in hand["keypoints"]], dtype=float),
            side=SIDES[SIDES.index(hand["side"])],
            score=float(hand["score"]),
        )
        for hand in hands
        if len(hand["keypoints"]) == len(HAND_LANDMARKS)
    ]


def _name_points(hand: Hand) -> list[SimpleNamespace]:
    return [
        SimpleNamespace(name=name, x=x, y=y)
        for name, (x, y) in zip(HAND_LANDMARKS, hand.xy.tolist(), strict=True)
    ]
