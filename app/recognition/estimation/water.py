"""Water correction: restores colour and contrast of under-water frames before estimation.

Water absorbs red first and, where it is turbid, blue; particles add a uniform colour; light from
above leaves divers dark. The models were trained in air. `correct_colours` decides by grey levels,
for estimators that cannot examine a single image. Grey levels do not show which correction a model
needs: a back-lit diver and one in green murk have the same range of brightness and need opposite
corrections.

So `WaterSight`, which runs an estimator on corrected frames of files and of live streams, decides
by the models' scores. A frame with low scores is in doubt and is examined under every correction.
The correction with the highest scores for body and hands, over the latest examinations, is used
until frames are in doubt again (`WaterChoice`).
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from typing import Final, Literal, Protocol, get_args, runtime_checkable

import cv2
import numpy as np

from app.recognition.errors import EstimatorError
from app.recognition.estimation.estimator import PoseEstimator, check_image
from app.recognition.estimation.factory import finds_hands
from app.recognition.estimation.landmark_models.body_model import SURE
from app.recognition.estimation.landmark_models.hand_model import LEAST_PRESENCE
from app.recognition.poses.frame import FrameLandmarks, Image
from app.recognition.poses.sequence import FloatArray

WaterCorrection = Literal["auto", "on", "off"]
"""Which frames are corrected: those for which it raises the models' scores (`WaterSight`), all, or
none."""

Correction = Literal["none", "balanced", "lightened", "contrasted"]
"""Correction of a frame: none; colours balanced and stretched; in addition, dark parts lightened,
for divers against the light; in addition to both, local contrast equalised, for divers in haze."""

CORRECTIONS: Final[tuple[Correction, ...]] = get_args(Correction)

RED, GREEN, BLUE = 0, 1, 2

LIGHTENING: Final = 0.5
"""Exponent of brightness in [0, 1], a square root: a quarter becomes a half."""

CONTRAST_LIMIT: Final = 2.0
CONTRAST_TILES: Final = (8, 8)
"""Limit and tiles of the equalisation of local contrast (CLAHE, Zuiderveld 1994)."""

SAMPLING: Final = 4
"""Step in pixels, each way, with which a frame's colours are sampled."""

TAIL: Final = 1.0
"""Percentage of the pixels at either end of the range that the stretch may clip: a lamp, a hole."""

LEAST_RANGE: Final = 8.0
"""Least range in grey levels; an image with a smaller one would be stretched to noise."""

MURKY_RANGE: Final = 64.0
"""Grey levels between the `TAIL` darkest and lightest pixels below which ``"auto"`` corrects. Clear
frames have 75 to 190, those with 50 % murk 40 to 85, with 75 % 30 to 50; above the limit the models
work nearly as well without correction."""

LUMA: Final = np.array([0.299, 0.587, 0.114])
"""Weights of red, green and blue in brightness (ITU-R BT.601)."""


def correct_colours(image: Image, water: WaterCorrection = "auto") -> Image:
    """Return a frame as it would look in clear water, or the frame itself.

    Three steps. The mean difference of green and red is added to red where the pixel is green, and
    likewise to blue where the water is turbid (Ancuti et al. 2018, Sec. III, with a weight of 1).
    All channels are brought to the same mean (grey world, Buchsbaum 1980). All are stretched about
    it alike, until the widest fills its range. The sharpening and fusion of several images in that
    paper are left out, because they do not help the models.

    Parameters
    ----------
    image
        ``(height, width, 3)`` RGB of 8 bits; it is not written to.
    water
        ``"on"``, ``"off"``, or ``"auto"``: on where the brightness has less than `MURKY_RANGE`.

    Returns
    -------
    A new image, or `image` itself where nothing is corrected.

    Raises
    ------
    EstimatorError
        When `water` is none of the three, or `image` is no RGB image of 8 bits.

    """
    check_water(water)
    check_image(image)
    needed = water == "on" or (water == "auto" and is_murky(image))
    return apply_correction(image, "balanced" if needed else "none")


def check_water(water: str) -> None:
    """Check that a setting of the correction exists.

    Raises
    ------
    EstimatorError
        When it does not; the message names those that exist.

    """
    if water not in get_args(WaterCorrection):
        known = ", ".join(get_args(WaterCorrection))
        raise EstimatorError(f"unknown water correction {water!r}; there are: {known}")


def apply_correction(image: Image, correction: Correction) -> Image:
    """Return a corrected frame, a new image; with ``"none"`` the frame itself.

    Raises
    ------
    EstimatorError
        When `image` is no RGB image of 8 bits.

    """
    check_image(image)
    if correction == "none":
        return image
    compensated = _compensate(image)
    table = _balance_and_stretch(_sample(compensated))
    if correction in ("lightened", "contrasted"):
        table = np.round(255 * (table / 255) ** LIGHTENING).astype(np.uint8)
    corrected = np.asarray(cv2.LUT(compensated, table), np.uint8)
    return _equalise(corrected) if correction == "contrasted" else corrected


def is_murky(image: Image) -> bool:
    """Return whether the range of brightness is so small that correction helps."""
    darkest, lightest = np.percentile(_sample(image) @ LUMA, [TAIL, 100 - TAIL])
    return bool(lightest - darkest < MURKY_RANGE)


def _sample(image: Image) -> FloatArray:
    """Return ``(N, 3)``: a sample of the image's pixels."""
    return image[::SAMPLING, ::SAMPLING].reshape(-1, 3).astype(np.float64)


def _compensate(image: Image) -> Image:
    """Add to red and to blue their mean difference from green, most where the pixel is green."""
    means = _sample(image).mean(axis=0)
    channels = [np.ascontiguousarray(image[..., channel]) for channel in range(3)]
    for weak in (RED, BLUE):
        lack = (means[GREEN] - means[weak]) / 255
        if lack > 0:
            room = 255 - channels[weak]
            gain = cv2.multiply(room, channels[GREEN], scale=lack / 255)
            channels[weak] = np.asarray(cv2.add(channels[weak], gain), np.uint8)
    return np.asarray(cv2.merge(channels), np.uint8)


def _equalise(image: Image) -> Image:
    """Equalise local contrast of the brightness, and leave the colours."""
    space = cv2.cvtColor(image, cv2.COLOR_RGB2LAB)
    equaliser = cv2.createCLAHE(CONTRAST_LIMIT, CONTRAST_TILES)
    space[..., 0] = equaliser.apply(np.ascontiguousarray(space[..., 0]))
    return np.asarray(cv2.cvtColor(space, cv2.COLOR_LAB2RGB), np.uint8)


def _balance_and_stretch(pixels: FloatArray) -> Image:
    """Return the ``(1, 256, 3)`` table by which each value of each channel is replaced."""
    means = pixels.mean(axis=0)
    gains = means.mean() / np.maximum(means, 1.0)
    low, high = np.percentile(pixels * gains, [TAIL, 100 - TAIL], axis=0)
    darkest, lightest = low.min(), high.max()
    stretch = 255 / max(lightest - darkest, LEAST_RANGE)
    values = np.arange(256.0)[:, None] * gains
    stretched = np.clip((values - darkest) * stretch, 0, 255).round()
    return np.asarray(stretched[None], np.uint8)


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
        Whether the estimator finds hands, so that a frame without a certain one is in doubt.

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
        seen = any(hand.score >= LEAST_PRESENCE for hand in found.hands)
        if found.body is None or (self._sought and not seen):
            return True
        # A new body was examined once, off the centre of its region: its score means little.
        return self._had_body and found.body.score < SURE


def measure_belief(found: FrameLandmarks) -> float:
    """Return the combined score of what was found: the body's, and a share of the hands'."""
    body = found.body.score if found.body else 0.0
    return body + HAND_WEIGHT * sum(hand.score for hand in found.hands)


@runtime_checkable
class Examiner(Protocol):
    """Interface of estimators that can examine a single image."""

    def examine(self, image: Image) -> FrameLandmarks:
        """Find body and hands in `image` alone, without effect on the tracking."""


@runtime_checkable
class Sparing(Protocol):
    """Interface of estimators that can do less for each frame."""

    def spare(self, *, spares: bool) -> None:
        """Look at hands less often, or as often as usual."""


@runtime_checkable
class Adopter(Protocol):
    """Interface of estimators that can search the last frame for further hands."""

    def adopt(self, image: Image) -> FrameLandmarks:
        """Return the last frame with what examinations of it, and a search in it, have found."""


class WaterSight:
    """Corrects the water in frames, in order, and lets an estimator find the landmarks in them.

    With ``"auto"`` a `WaterChoice` selects the correction with the highest scores of the
    estimator's models. With an estimator that is no `Examiner`, murky frames are corrected
    (`correct_colours`).

    Parameters
    ----------
    estimator
        Finds the landmarks; the caller closes it.
    water
        ``"auto"``, ``"on"`` or ``"off"``.

    Raises
    ------
    EstimatorError
        When `water` is none of the three.

    """

    def __init__(self, estimator: PoseEstimator, water: WaterCorrection = "auto") -> None:
        check_water(water)
        self._estimator = estimator
        self._water = water
        self._choice = WaterChoice(hands=finds_hands(estimator))

    def reset(self) -> None:
        """Reset tracking, smoothing and the choice; call it before another clip."""
        self._estimator.reset()
        self._choice.reset()

    def estimate(self, image: Image, time: float) -> FrameLandmarks:
        """Find the body and the hands in `image`, taken `time` seconds after any fixed moment.

        Raises
        ------
        EstimatorError
            When `image` is not an RGB image of 8 bits.

        """
        estimator, choice = self._estimator, self._choice
        if self._water != "auto" or not isinstance(estimator, Examiner):
            return estimator.estimate(correct_colours(image, self._water), time)
        found = estimator.estimate(apply_correction(image, choice.correction), time)
        if not choice.needs_examination(found):
            return found
        examined = {one: estimator.examine(apply_correction(image, one)) for one in CORRECTIONS}
        if choice.choose(examined):
            estimator.reset()
            found = estimator.estimate(apply_correction(image, choice.correction), time)
        if isinstance(estimator, Adopter):
            return estimator.adopt(apply_correction(image, choice.correction))
        return found
