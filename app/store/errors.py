"""Exceptions of the store."""


class StoreError(Exception):
    """Base of the store's errors; the message is one line for a person."""


class NotFound(StoreError):
    """Raised when an object does not exist or was deleted."""


class Conflict(StoreError):
    """Raised when somebody else has changed the object meanwhile.

    Parameters
    ----------
    message
        The expected and the actual revision, in words.
    current
        Number of the newest revision.

    """

    def __init__(self, message: str, current: int) -> None:
        super().__init__(message)
        self.current = current


class StoreUnavailable(StoreError):
    """Raised when the database is damaged, locked or cannot be opened."""
