"""Water sight: runs an estimator on corrected frames, of files and of live streams."""

from __future__ import annotations

from typing import Protocol, runtime_checkable

from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.factory import finds_hands
from app.recognition.estimation.water import (
    CORRECTIONS,
    WaterCorrection,
    apply_correction,
    check_water,
    correct_colours,
)
from app.recognition.estimation.water_choice import WaterChoice
from app.recognition.poses.frame import FrameLandmarks, Image


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
