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


class TooManyInvitations(StoreError):
    """Raised when a language has as many open invitations as are listed."""


class InvitationClosed(StoreError):
    """Raised when an invitation is not valid any more, or takes nothing more.

    Parameters
    ----------
    message
        Why, and what to do, in one line.
    code
        Stable word: ``withdrawn``, ``expired`` or ``used_up``.

    """

    def __init__(self, message: str, code: str) -> None:
        super().__init__(message)
        self.code = code


class StoreUnavailable(StoreError):
    """Raised when the database is damaged, locked or cannot be opened."""
