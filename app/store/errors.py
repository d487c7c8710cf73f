"""Exceptions of the store."""


class StoreError(Exception):
    """Base of every error the store raises on purpose; the message is one line for a person."""


class NotFound(StoreError):
    """Raised when an object does not exist or was deleted."""


class Conflict(StoreError):
    """Raised when somebody else changed the object meanwhile.

    Parameters
    ----------
    message
        What was expected and what was found.
    current
        The revision that is now the newest.

    """

    def __init__(self, message: str, current: int) -> None:
        super().__init__(message)
        self.current = current


class StoreUnavailable(StoreError):
    """Raised when the database is damaged, locked or cannot be opened."""
