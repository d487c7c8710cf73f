"""Hand messages: convert hands to this project's message and to the published port's."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from osg_interfaces.msg import Hand as HandMessage
from osg_interfaces.msg import Hands, Keypoint
from std_msgs.msg import Header

from app.recognition.poses.frame import Hand
from app.recognition.poses.landmarks import HAND_LANDMARKS
from app.recognition.recording.salute import best_salute
from osg_ros.topics.body_messages import FrameSize


def to_hands_message(header: Header, size: FrameSize, hands: Sequence[Hand]) -> Hands:
    """Convert the hands of one picture to a message, with the salute score of the best hand.

    Parameters
    ----------
    header, size
        Header and size of the picture.
    hands
        At most two, larger first.

    """
    return Hands(
        header=header,
        image_width=size[0],
        image_height=size[1],
        salute=best_salute(hands),
        hands=[_hand_message(hand) for hand in hands],
    )


def to_published_hand_keypoints(
    kind: Any, part: Any, size: FrameSize, hands: Sequence[Hand]
) -> Any:
    """Convert hands to the message of the published port's hand node, one hand after the other.

    That node sends pixels of its heat maps, which subscribers cannot interpret; here coordinates
    are fractions of the picture's sides, as its display expects.

    Parameters
    ----------
    kind, part
        The types ``keypoints_interfaces/HandKeypointsArray`` and ``HandKeypoints``.
    size
        Size of the picture.
    hands
        The hands found.

    """
    made = kind()
    for hand in hands:
        for index, (x, y) in enumerate((hand.xy / size).tolist()):
            made.keypoints.append(part(name=f"Point_{index}", x=x, y=y, z=0.0))
    return made


def _hand_message(hand: Hand) -> HandMessage:
    points = [
        Keypoint(name=name, x=x, y=y, confidence=math.nan)
        for name, (x, y) in zip(HAND_LANDMARKS, hand.xy.tolist(), strict=True)
    ]
    return HandMessage(side=hand.side, score=hand.score, keypoints=points)
