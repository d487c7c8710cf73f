"""Composed estimator: a pose estimator of separate models for body and hands."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol

from app.recognition.estimation.estimator import check_image
from app.recognition.estimation.landmark_models.hand_tracker import HandTracker
from app.recognition.poses.frame import Body, FrameLandmarks, Hand, Image


class BodyFinder(Protocol):
    """Finds bodies in the frames of one clip, in order, and follows one of them."""

    def track(self, image: Image, time: float) -> FrameLandmarks:
        """Return the bodies in `image`, taken at `time` seconds, without hands."""

    def examine(self, image: Image) -> FrameLandmarks:
        """Return the body in `image` alone, without effect on the tracking."""

    def reset(self) -> None:
        """Reset the tracking, before another clip."""


class HandFinder(Protocol):
    """Finds the hands in the same frames."""

    def find(self, image: Image, bodies: Sequence[Body]) -> tuple[Hand, ...]:
        """Return up to two hands a person in `image`, larger first, given the bodies in it."""

    def examine(self, image: Image, bodies: Sequence[Body]) -> tuple[Hand, ...]:
        """Return those in `image` alone, without effect on the tracking."""

    def reset(self) -> None:
        """Reset the tracking, before another clip."""


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

    def find(self, image: Image, bodies: Sequence[Body]) -> tuple[Hand, ...]:
        """Return up to two hands a person in `image`, larger first."""
        return self._tracker.complete(image, self._tracker.follow(image), bodies).hands

    def examine(self, image: Image, bodies: Sequence[Body]) -> tuple[Hand, ...]:
        """Return up to two hands a person in `image` alone; tracking is left as it is."""
        return TrackedHands(self._tracker.renew()).find(image, bodies)

    def reset(self) -> None:
        """Reset the tracking."""
        self._tracker.reset()


class ComposedEstimator:
    """Pose estimator of one model for the body and another for the hands.

    Parameters
    ----------
    body
        Finds the bodies.
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
        """Find bodies and hands in `image`, taken `time` seconds after any fixed moment.

        Raises
        ------
        EstimatorError
            When `image` is not an RGB image of 8 bits.

        """
        found = self._body.track(image, time)
        hands = self._hands.find(image, found.bodies) if self._hands else ()
        return replace(found, hands=hands)

    def examine(self, image: Image) -> FrameLandmarks:
        """Find body and hands in `image` alone, without effect on the tracking.

        Raises
        ------
        EstimatorError
            When `image` is not an RGB image of 8 bits.

        """
        check_image(image)
        found = self._body.examine(image)
        hands = self._hands.examine(image, found.bodies) if self._hands else ()
        return replace(found, hands=hands)

    def reset(self) -> None:
        """Reset the tracking; call it before another clip."""
        self._body.reset()
        if self._hands:
            self._hands.reset()

    def close(self) -> None:
        """Release the models; the estimator cannot be used afterwards."""
        del self._body, self._hands
