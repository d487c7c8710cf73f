"""Clip source: a dive recording (rosbag2 as MCAP, SQLite or zip), of which one topic is read."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path

import numpy as np
from typing_extensions import Unpack

from app.bags import holds_keypoints, is_bag, record_bag
from app.bags.bag import open_bag
from app.bags.bag_kind import bag_kind, kind_of
from app.bags.extraction import Reading, write_video
from app.bags.image_topic import BagFrames
from app.bags.session_reader import is_session
from app.bags.staging import is_bag_archive
from app.bags.topic_summary import usable_topics
from app.clip_sources.source import (
    ClipFacts,
    ClipSource,
    OpenFrames,
    ReadOptions,
    RecordedClip,
    Refusal,
    UnsupportedFile,
)
from app.recognition.errors import BagError, OsgError, TopicError
from app.recognition.estimation.factory import finds_hands


class BagSource(ClipSource):
    """A rosbag2 folder, its one file, or a zip of either."""

    name = "bag"
    noun = "a dive recording"
    formats = "a rosbag2 (MCAP, sqlite3, zip)"
    endings = (".mcap", ".db3", ".zip")
    folder = "a dive recording (metadata.yaml)"
    has_topics = True
    probe_seconds = 120.0
    """Longest time to probe, which reads the whole unpacked recording: the largest allowed
    (`app.bags.staging.MOST_BYTES`) at 20 MB/s, the slowest disk still sold."""
    broken_off = Refusal(
        code="bag_unreadable",
        detail="the process that read this dive recording broke off: the recording is damaged, or "
        "it needs more memory or time than a job may use; cut out the part with the gestures",
    )

    def accepts(self, path: Path, topic: str | None = None) -> bool:
        """Return whether a topic is named, or the content is that of a rosbag2."""
        return topic is not None or is_bag(path)

    def accepts_upload(self, head: bytes, name: str) -> bool:
        """Return whether `head` is the beginning of a rosbag2; a zip may hold anything else."""
        return bag_kind(head) is not None

    def is_take(self, path: Path) -> bool:
        """Return whether it is a session that this program wrote of a clip.

        Another dive recording shows many gestures, and its name labels none of them.
        """
        return is_session(path)

    def probe(self, path: Path, options: ReadOptions) -> ClipFacts:
        """List the topics that a clip can be made of."""
        if kind_of(path) == "zip" and not is_bag_archive(path):
            raise UnsupportedFile("the archive holds no dive recording (no .mcap and no .db3 file)")
        topics = usable_topics(path)
        first = topics[0]
        return ClipFacts(first.width, first.height, first.duration, first.messages, topics)

    def shows_pictures(self, path: Path, options: ReadOptions) -> bool:
        """Return whether the topic holds pictures."""
        return not holds_keypoints(path, options.topic)

    def record(
        self, path: Path, options: ReadOptions, *, video: Path | None = None, **how: Unpack[Reading]
    ) -> RecordedClip:
        """Find body and hands in the pictures of a topic, or read its keypoints."""
        water, turn, estimator = options.water, options.turn, how.get("estimator")
        found = record_bag(path, options.topic, video=video, water=water, turn=turn, **how)
        poses = found.poses
        seen = tuple(poses.landmarks[row] for row in np.flatnonzero(poses.seen.any(axis=0)))
        return RecordedClip(found, estimator is None or finds_hands(estimator), seen)

    def refuse(self, error: OsgError, path: Path) -> Refusal:
        """Return a refusal that names the clip, not the stored file."""
        codes: dict[type, str] = {TopicError: "topic_needed", BagError: "bag_unreadable"}
        detail = str(error).replace(path.name, "the clip")
        return Refusal(codes.get(type(error), "video_unreadable"), detail)

    def playable_video(self, path: Path, options: ReadOptions, copy: Path) -> Path | None:
        """Write a copy of the topic as a video."""
        write_video(path, options.topic, copy, options.turn)
        return copy

    def open_frames(self, path: Path, options: ReadOptions) -> OpenFrames:
        """Open a topic of pictures, each with its own stamp."""
        with ExitStack() as opening:
            bag = opening.enter_context(open_bag(path))
            chosen = bag.topic(options.topic)
            if chosen.use != "pictures":
                raise BagError(
                    f"{chosen.name} holds keypoints, and a robot looks at pictures; use "
                    f"`osg-studio recognize {path} --topic {chosen.name}`"
                )
            frames = BagFrames(bag, chosen, turn=options.turn)
            return OpenFrames(frames, opening.pop_all().close)
