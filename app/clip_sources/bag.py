"""A topic of a dive recording as a source: every picture, at its own stamp."""

from __future__ import annotations

from contextlib import ExitStack

from app.bags import bag_and_topic
from app.bags.bag import opened_bag
from app.bags.picture_frames import BagFrames
from app.recognition.errors import BagError
from app.recognition.recording.video_limits import VideoLimits
from app.robot.sources.recorded import RecordedSource


def open_bag(text: str, limits: VideoLimits | None = None) -> RecordedSource:
    """Open a dive recording.

    Parameters
    ----------
    text
        ``BAG``, or ``BAG@/TOPIC`` where it has several topics of pictures.
    limits
        What the recording may cost.

    Raises
    ------
    BagError
        When it is none, is damaged, or the topic holds no pictures.
    VideoError
        When it breaks a limit.

    """
    path, topic = bag_and_topic(text)
    with ExitStack() as opening:
        bag = opening.enter_context(opened_bag(path))
        chosen = bag.topic(topic)
        if chosen.use != "pictures":
            raise BagError(
                f"{chosen.name} holds keypoints, and a robot looks at pictures; use "
                f"`osg-studio recognize {path} --topic {chosen.name}`"
            )
        frames = BagFrames(bag, chosen, limits)
        return RecordedSource(text, frames, opening.pop_all().close)
