"""The exceptions of the domain core: one tree, so that callers can catch as widely as they mean."""


class OsgError(ValueError):
    """Base of every error that OSG Studio raises on purpose.

    Its message is one line for a person: what is wrong (with the value seen), why that
    matters where it is not obvious, and what to do next.
    """


RecognitionError = OsgError
"""The name of the base up to version 0.1; kept for scripts that catch it."""


class PoseError(OsgError):
    """Raised when a pose sequence is malformed or cannot be used for what was asked."""


class LandmarkError(PoseError):
    """Raised when a source of poses lacks a landmark that a language follows.

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
    """Raised when another program's keypoint file cannot be read, or does not tell enough."""


class FrameRateError(KeypointFileError):
    """Raised when a keypoint file counts frames and nobody tells how many make a second."""


class FrameSizeError(KeypointFileError):
    """Raised when a keypoint file tells fractions of a picture whose size nobody tells."""


class VideoError(OsgError):
    """Raised when a clip cannot be read: no video in it, damaged, or beyond the limits."""


class BagError(OsgError):
    """Raised when a dive recording (rosbag2, MCAP) cannot be read, or holds nothing to use."""


class TopicError(BagError):
    """Raised when a dive recording holds several usable topics and none, or another, was named."""


class GestureError(OsgError):
    """Raised when a demonstration cannot become a gesture, for instance because nothing moves."""


class LanguageError(OsgError):
    """Raised when a language file or a language is invalid.

    Parameters
    ----------
    message
        What is wrong and what to do.
    pointer
        JSON pointer (RFC 6901) to the fault, ``""`` for the whole document.

    """

    def __init__(self, message: str, pointer: str = "") -> None:
        super().__init__(f"{pointer}: {message}" if pointer else message)
        self.pointer = pointer


class ModelError(OsgError):
    """Raised when a pose or hand model file is missing, truncated or not the pinned one."""


class EstimatorError(OsgError):
    """Raised when a pose estimator cannot be had as asked, or is given what is no image."""


class SourceError(OsgError):
    """Raised when a camera or stream cannot be opened, or stops giving frames."""


class PublishError(OsgError):
    """Raised when what was recognised cannot be published as asked."""
