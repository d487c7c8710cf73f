"""Composed estimator: a pose estimator of separate models for body and hands."""

from __future__ import annotations

from typing import Protocol

from app.recognition.estimation.estimator import check_image
from app.recognition.estimation.landmark_models.hands import HandTracker
from app.recognition.poses.frame import Body, FrameLandmarks, Hand, Image


class BodyFinder(Protocol):
    """Finds one person's body in the frames of one clip, in order."""

    def track(self, image: Image, time: float) -> Body | None:
        """Return the body in `image`, taken at `time` seconds, or None where none is seen."""
        ...

    def examine(self, image: Image) -> Body | None:
        """Return the body in `image` alone, without effect on the tracking."""
        ...

    def reset(self) -> None:
        """Reset the tracking, before another clip."""
        ...


class HandFinder(Protocol):
    """Finds that person's hands in the same frames."""

    def find(self, image: Image, body: Body | None) -> tuple[Hand, ...]:
        """Return up to two hands in `image`, larger first, given the body in it."""
        ...

    def examine(self, image: Image, body: Body | None) -> tuple[Hand, ...]:
        """Return those in `image` alone, without effect on the tracking."""
        ...

    def reset(self) -> None:
        """Reset the tracking, before another clip."""
        ...


class TrackedHands:
    """MediaPipe's hand models for use with another body model; a `HandFinder`.

    Parameters
    ----------
    tracker
        Its ``search`` should be ``"palm"`` where the body has no finger landmarks, which
        ``"pose"`` needs.

    """

    def __init__(self, tracker: HandTracker) -> None:
        self._tracker = tracker

    def find(self, image: Image, body: Body | None) -> tuple[Hand, ...]:
        """Return up to two hands in `image`, larger first."""
        return self._tracker.complete(image, self._tracker.follow(image), body)

    def examine(self, image: Image, body: Body | None) -> tuple[Hand, ...]:
        """Return up to two hands in `image` alone; tracking is left as it is."""
        return TrackedHands(self._tracker.renew()).find(image, body)

    def reset(self) -> None:
        """Reset the tracking."""
        self._tracker.reset()


class ComposedEstimator:
    """Pose estimator of one model for the body and another for the hands.

    Parameters
    ----------
    body
        Finds the body.
    hands
        Finds the hands; None: no hands, hence no salutes.
    landmarks
        Names of the landmarks that the body can have.

    """

    def __init__(
        self, body: BodyFinder, hands: HandFinder | None, landmarks: tuple[str, ...]
    ) -> None:
        self._body, self._hands = body, hands
        self.landmarks = landmarks
        self.finds_hands = hands is not None

    def estimate(self, image: Image, time: float) -> FrameLandmarks:
        """Find the body and the hands in `image`, taken `time` seconds after any fixed moment.

        Raises
        ------
        EstimatorError
            When `image` is not an RGB image of 8 bits.

        """
        body = self._body.track(image, time)
        return FrameLandmarks(body, self._hands.find(image, body) if self._hands else ())

    def examine(self, image: Image) -> FrameLandmarks:
        """Find body and hands in `image` alone, without effect on the tracking.

        Raises
        ------
        EstimatorError
            When `image` is not an RGB image of 8 bits.

        """
        check_image(image)
        body = self._body.examine(image)
        return FrameLandmarks(body, self._hands.examine(image, body) if self._hands else ())

    def reset(self) -> None:
        """Reset the tracking; call it before another clip."""
        self._body.reset()
        if self._hands:
            self._hands.reset()

    def close(self) -> None:
        """Release the models; the estimator cannot be used afterwards."""
        del self._body, self._hands
