"""Option ``--data-dir`` of the commands on a studio's data folder, and their audit entries."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from app.recognition.errors import OsgError

if TYPE_CHECKING:
    from app.settings import Settings

LONGEST_ABOUT: Final = 300
"""Most characters of what a command was given, in the audit log."""

DataDir = Annotated[Path | None, typer.Option(help="Folder for clips, languages and the database.")]


def settings_of(given: Path | None) -> Settings:
    """Return the settings, with the folder named.

    Raises
    ------
    OsgError
        When only a robot's packages are installed.

    """
    try:
        from app.settings import Settings
    except ModuleNotFoundError as error:
        raise OsgError(
            f"the studio's packages are not installed ({error.name} is missing), and only the "
            "studio has a data folder"
        ) from error
    # These commands listen nowhere, so they need no token, which one of them adds.
    here = "127.0.0.1"
    return Settings(host=here) if given is None else Settings(host=here, data_dir=given)


@contextmanager
def audit_of(settings: Settings) -> Iterator[Callable[[str, str], None]]:
    """Yield a function that notes the use of a command in the studio's audit log.

    It is called with the command and what it was given, before the command reports success. Where
    the database does not exist yet or does not answer, the server takes the entry over later.

    Raises
    ------
    OsgError
        Before anything is done, when the database cannot be used; and when the entry cannot be
        written anywhere.

    """
    from app.store import AuditEntry, AuditStore, Database, Role, StoreError
    from app.store.tokens import COMMAND_LINE

    def note(command: str, about: str) -> None:
        entry = AuditEntry(
            name=COMMAND_LINE,
            role=str(Role.ADMIN),
            address="local",
            method=command,
            path=about[:LONGEST_ABOUT],
            status=0,
            request_id="",
        )
        AuditStore(database, settings.data_dir).add(entry)

    try:
        with closing(Database(settings.database)) as database:
            yield note
    except StoreError as error:
        raise OsgError(str(error)) from error
