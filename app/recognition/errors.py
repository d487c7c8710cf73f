"""Exceptions of OSG Studio: one tree with the base `OsgError`."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager


class OsgError(ValueError):
    """Base of all errors that OSG Studio raises on purpose.

    The message is one line for users: what is wrong with the value seen, why where that is not
    obvious, and what to do next.
    """


RecognitionError = OsgError
"""The name of the base up to version 0.1; kept for scripts that catch it."""


class PoseError(OsgError):
    """Raised when a pose sequence is malformed or lacks what an operation needs."""


class LandmarkError(PoseError):
    """Raised when a source of poses lacks a landmark that a language uses.

    Parameters
    ----------
    message
        What is wrong and what to do.
    landmark
        The missing landmark's name.

    """

    def __init__(self, message: str, landmark: str) -> None:
        super().__init__(message)
        self.landmark = landmark


class KeypointFileError(OsgError):
    """Raised when another program's keypoint file cannot be read, or lacks information."""


class FrameRateError(KeypointFileError):
    """Raised when a keypoint file numbers its frames and no frame rate is given."""


class RoundedTimesError(FrameRateError):
    """Raised when neighbouring frames have one time and no frame rate is given."""


class FrameSizeError(KeypointFileError):
    """Raised when a keypoint file has coordinates relative to a frame size that is not given."""


class VideoError(OsgError):
    """Raised when a clip cannot be read: no video in it, damaged, or beyond the limits."""


class BagError(OsgError):
    """Raised when a bag (rosbag2, MCAP) cannot be read, or has no usable topic."""


class TopicError(BagError):
    """Raised when a bag has several usable topics and none of them was chosen."""


class GestureError(OsgError):
    """Raised when a demonstration cannot become a gesture, for instance because nothing moves."""


class RangeError(OsgError):
    """Raised when a range of a clip is empty or reversed.

    Parameters
    ----------
    message
        What is wrong and what to do.
    pointer
        JSON pointer (RFC 6901) to the end of the range to mend first, in an object of ``start`` and
        ``end``; ``""`` for none.

    """

    def __init__(self, message: str, pointer: str = "") -> None:
        super().__init__(message)
        self.pointer = pointer


class AmbiguousRangeError(RangeError):
    """Raised when no range is given of a clip with several takes."""


class TriggerError(OsgError):
    """Raised when a pose of the arms cannot be a trigger, for instance because it is not held."""


class LanguageError(OsgError):
    """Raised when a language file or a language is invalid.

    Parameters
    ----------
    message
        What is wrong and what to do.
    pointer
        JSON pointer (RFC 6901) to the error, ``""`` for the whole document.

    """

    def __init__(self, message: str, pointer: str = "") -> None:
        super().__init__(f"{pointer}: {message}" if pointer else message)
        self.pointer = pointer


class ModelError(OsgError):
    """Raised when a pose or hand model file is missing, truncated or not the pinned one."""


class EstimatorError(OsgError):
    """Raised when a pose estimator is not available as configured, or its input is no image."""


class SourceError(OsgError):
    """Raised when a camera or stream cannot be opened, or stops sending frames."""


class PublishError(OsgError):
    """Raised when recognitions cannot be published as configured."""


class VehicleError(OsgError):
    """Raised when a vehicle table is invalid, or a vehicle's address cannot be used."""


@contextmanager
def point_to(pointer: str) -> Iterator[None]:
    """Raise an error of a part of a language as a `LanguageError` with the part's JSON pointer."""
    try:
        yield
    except OsgError as error:
        raise LanguageError(str(error), pointer) from error


@contextmanager
def explain_missing_package(
    what: str, extra: str, kind: type[OsgError] = OsgError, instead: str = ""
) -> Iterator[None]:
    """Explain an import that fails: `what` needs the package, which an `extra` installs."""
    try:
        yield
    except ModuleNotFoundError as error:
        raise kind(
            f"{what} needs {error.name}, which is not installed; install it with: "
            f'pip install "osg-studio[{extra}]"{instead}'
        ) from error
