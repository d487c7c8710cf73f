"""Hands as messages: our own and the published port's; and ours read back."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, get_args

import numpy as np
from osg_interfaces.msg import Hand as HandMessage
from osg_interfaces.msg import Hands, Keypoint
from std_msgs.msg import Header

from app.recognition.estimation.base import Hand, Side
from app.recognition.landmarks import HAND_LANDMARKS
from app.recognition.salute import best_salute
from osg_ros.bodies import FrameSize


def hands_message(header: Header, size: FrameSize, hands: Sequence[Hand]) -> Hands:
    """Return the hands that were seen in one picture, and how much they salute.

    Parameters
    ----------
    header, size
        Of the picture.
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


def hands_in(message: Hands) -> tuple[Hand, ...]:
    """Return the hands of a message, the inverse of `hands_message`.

    Raises
    ------
    ValueError
        When a hand's side or its landmarks are none that are known.

    """
    return tuple(_hand_in(hand) for hand in message.hands)


def published_hand_keypoints(kind: Any, part: Any, size: FrameSize, hands: Sequence[Hand]) -> Any:
    """Return hands as the published port's hand node sends them, one after the other.

    It sent pixels of its heat maps, which meant nothing to whoever read them; here, as its display
    expects, coordinates are fractions of the picture's sides.

    Parameters
    ----------
    kind, part
        The types ``keypoints_interfaces/HandKeypointsArray`` and ``HandKeypoints``.
    size
        Of the picture.
    hands
        What was seen.

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


def _hand_in(message: HandMessage) -> Hand:
    names = tuple(keypoint.name for keypoint in message.keypoints)
    if message.side not in get_args(Side) or names != HAND_LANDMARKS:
        raise ValueError(
            f"a hand of side {message.side!r} with {len(names)} keypoints; send side left or right "
            f"and MediaPipe's {len(HAND_LANDMARKS)} landmarks by name and in order"
        )
    xy = np.array([(keypoint.x, keypoint.y) for keypoint in message.keypoints])
    return Hand(xy, message.side, message.score)
