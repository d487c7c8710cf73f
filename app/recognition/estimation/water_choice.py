"""Water choice: selects the water correction with the highest scores of the models.

Grey levels do not show which correction a model needs: a back-lit diver and one in green murk have
the same range of brightness and need opposite corrections. So the models' scores decide. A frame
with low scores is in doubt and is examined under every correction. The correction with the highest
scores for body and hands, over the latest examinations, is used until frames are in doubt again.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from typing import Final

import numpy as np

from app.recognition.estimation.landmark_models.body_search import SURE
from app.recognition.estimation.water import CORRECTIONS, Correction
from app.recognition.poses.frame import FrameLandmarks

WINDOW: Final = 4
"""Examinations over which scores (`measure_belief`) are averaged: one frame can be hidden by
bubbles."""

FIRST_PAUSE: Final = 8
"""Frames between the first examinations, a third of a second: neighbours show the same."""

LONGEST_PAUSE: Final = 256
"""Frames between examinations once decided. One costs as much as about 12 frames, so all of them
cost a twentieth."""

PATIENCE: Final = 8
"""Consecutive frames in doubt before an examination: a hand hidden for a moment does not cause one.
The first frame is examined at once."""

SEARCHING_PAUSE: Final = 64
"""The same while nobody is found: two and a half seconds until a diver in murk is seen."""

MARGIN: Final = 0.1
"""Score by which another correction must exceed the one in use at the first examination of a scene:
less is noise."""

CHANGE_MARGIN: Final = 0.25
"""The same at later examinations, since a change restarts the tracking: as much as one more certain
hand."""

HAND_WEIGHT: Final = 0.25
"""Weight of a hand's score against the body's; without a body there are no gestures."""


class WaterChoice:
    """Chooses a correction from what the models find; starts with none.

    The pause between examinations doubles from `FIRST_PAUSE` to `LONGEST_PAUSE`, and is short again
    after a body was lost, as when the scene changes; then the earlier scores are discarded too.

    Parameters
    ----------
    hands
        Whether the estimator finds hands, so that a frame without any is in doubt.

    """

    def __init__(self, *, hands: bool = True) -> None:
        self._sought = hands
        self.reset()

    def reset(self) -> None:
        """Forget everything; no correction is in use."""
        self.correction: Correction = CORRECTIONS[0]
        self._beliefs: deque[dict[Correction, float]] = deque(maxlen=WINDOW)
        self._doubts = PATIENCE
        self._pause, self._rest = FIRST_PAUSE, 0
        self._had_body = False

    def needs_examination(self, found: FrameLandmarks) -> bool:
        """Count a frame, and return whether it should be examined under every correction.

        Parameters
        ----------
        found
            What was found in it under the correction in use.

        """
        self._rest = max(0, self._rest - 1)
        self._doubts = self._doubts + 1 if self._is_doubtful(found) else 0
        if self._had_body and found.body is None:
            self._pause, self._rest = FIRST_PAUSE, min(self._rest, FIRST_PAUSE)
            self._beliefs.clear()
        self._had_body = found.body is not None
        if self._doubts < PATIENCE or self._rest:
            return False
        longest = LONGEST_PAUSE if found.body else SEARCHING_PAUSE
        self._rest, self._pause = min(self._pause, longest), min(2 * self._pause, longest)
        return True

    def choose(self, examined: Mapping[Correction, FrameLandmarks]) -> bool:
        """Process an examination, and return whether another correction is in use now.

        An examination in which nothing is found under any correction is not counted.
        """
        beliefs = {one: measure_belief(found) for one, found in examined.items()}
        if not any(beliefs.values()):
            return False
        self._beliefs.append(beliefs)
        margin = MARGIN if len(self._beliefs) == 1 else CHANGE_MARGIN
        means = {one: float(np.mean([each[one] for each in self._beliefs])) for one in CORRECTIONS}
        best = max(CORRECTIONS, key=lambda one: means[one])
        if means[best] <= means[self.correction] + margin:
            return False
        self.correction = best
        return True

    def _is_doubtful(self, found: FrameLandmarks) -> bool:
        if found.body is None or (self._sought and not found.hands):
            return True
        # A new body was examined once, off the centre of its region: its score means little.
        return self._had_body and found.body.score < SURE


def measure_belief(found: FrameLandmarks) -> float:
    """Return the combined score of what was found: the body's, and a share of the hands'."""
    body = found.body.score if found.body else 0.0
    return body + HAND_WEIGHT * sum(hand.score for hand in found.hands)
