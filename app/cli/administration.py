"""Commands on a studio's data folder and models: audit, backup, restore, tokens, models."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal

import typer

from app.cli.terminal import progress_bar, tell
from app.recognition.errors import OsgError, explain_missing_package

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
    with explain_missing_package("a studio's data folder", "studio"):
        from app.settings import Settings
    # These commands listen nowhere, so they need no token, which one of them adds.
    here = "127.0.0.1"
    return Settings(host=here) if given is None else Settings(host=here, data_dir=given)


@contextmanager
def _reporting() -> Iterator[None]:
    """Report an error of the store as one of the command."""
    from app.store import StoreError

    try:
        yield
    except StoreError as error:
        raise OsgError(str(error)) from error


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
    from app.store import AuditEntry, AuditStore, Database, Role
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

    with _reporting(), closing(Database(settings.database)) as database:
        yield note


def audit(
    limit: Annotated[int, typer.Option(min=1, max=1000, help="Most changes to list.")] = 100,
    name: Annotated[str | None, typer.Option(help="Only those of this name.")] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object a line instead.")
    ] = False,
    data_dir: DataDir = None,
) -> None:
    """List the changes in a studio by time, name, address and path, the newest first."""
    settings = settings_of(data_dir)
    from app.store import AuditStore, Database

    if settings.database_url is None and not (settings.data_dir / "studio.db").is_file():
        raise OsgError(f"{settings.data_dir} holds no studio; give its folder with --data-dir")
    with _reporting(), closing(Database(settings.database)) as database:
        entries = AuditStore(database, settings.data_dir).newest(limit, name=name)
    for entry in entries:
        content = entry.model_dump(mode="json")
        if as_json:
            typer.echo(json.dumps(content))
        else:
            keys = ("time", "name", "role", "address", "method", "path", "status")
            typer.echo("\t".join(str(content[key]) for key in keys))


def _places(settings: Settings) -> dict[str, Any]:
    """Return where the clips and the database are."""
    from app.store.objects import open_object_store

    objects = open_object_store(settings.objects)
    return {"clips": settings.clips, "objects": objects, "url": settings.database_url}


def backup(
    file: Annotated[Path, typer.Argument(metavar="FILE.zip", help="File to write.")],
    data_dir: DataDir = None,
) -> None:
    """Write database, clips and keypoints to one file, also while the studio runs."""
    settings = settings_of(data_dir)
    from app.store.backup import write_backup

    with _reporting():
        clips = write_backup(settings.data_dir, file.absolute(), **_places(settings))
        with audit_of(settings) as note:
            note("backup", str(file.absolute()))
    tell(f"{clips} clips and all languages are in {file}")


def restore(
    file: Annotated[Path, typer.Argument(metavar="FILE.zip", help="File that `backup` wrote.")],
    data_dir: DataDir = None,
) -> None:
    """Restore a backup into a data folder or database that is empty; every file is verified."""
    settings = settings_of(data_dir)
    from app.store.backup import restore_backup

    with _reporting():
        clips = restore_backup(file, settings.data_dir, **_places(settings))
        with audit_of(settings) as note:
            note("restore", str(file.absolute()))
    place = "the database of OSG_DATABASE_URL" if settings.database_url else settings.data_dir
    tell(f"{clips} clips and all languages are in {place}")


tokens_command = typer.Typer(help="Named tokens of a studio: add, list, remove.")

Name = Annotated[str, typer.Argument(help="Who uses it, as in the audit log.")]


RoleOption = Literal["read", "edit", "admin"]
"""What a token allows; each includes the ones before it."""


@tokens_command.command("add")
def add_token(
    name: Name,
    role: Annotated[RoleOption, typer.Option(help="What the token allows.")] = "edit",
    quota_bytes: Annotated[
        int | None, typer.Option(min=1, help="Bytes of clips that this name may keep.")
    ] = None,
    quota_clips: Annotated[
        int | None, typer.Option(min=1, help="Clips that this name may keep.")
    ] = None,
    data_dir: DataDir = None,
) -> None:
    """Add a token, or replace the one of that name, and print it once; it works at once."""
    settings = settings_of(data_dir)
    from app.store.tokens import Role, TokenFile, is_reserved

    if name.strip() and is_reserved(name):
        raise OsgError(
            f"{name[:80]!r} cannot be a token's name, because it is, or looks like, one that the "
            "audit log has for somebody else; take another name"
        )
    tokens = TokenFile(settings.tokens, settings.tokens_seen)
    given = [("--quota-bytes", quota_bytes), ("--quota-clips", quota_clips)]
    words = [name, "--role", role, *(f"{key} {value}" for key, value in given if value)]
    try:
        with audit_of(settings) as note:
            secret = tokens.add(name, Role(role), quota_bytes=quota_bytes, quota_clips=quota_clips)
            note("tokens add", " ".join(words))
    except OsgError:
        raise
    except ValueError as error:
        raise OsgError(
            f"{name[:80]!r} cannot be a token's name: use 1 to 80 letters, digits, spaces, "
            "points, @, _ or -"
        ) from error
    typer.echo(secret)
    tell(f"{name} may {role}; the token is not kept, only its digest in {settings.tokens}")


@tokens_command.command("list")
def list_tokens(data_dir: DataDir = None) -> None:
    """List the tokens by name, role, day and quotas, separated by tabs."""
    settings = settings_of(data_dir)
    from app.store.tokens import TokenFile

    with _reporting():
        tokens = TokenFile(settings.tokens, settings.tokens_seen).read()
    for token in tokens:
        quotas = (token.quota_bytes, token.quota_clips)
        shown = ["-" if each is None else str(each) for each in quotas]
        typer.echo("\t".join([token.name, token.role.value, f"{token.created:%Y-%m-%d}", *shown]))


@tokens_command.command("remove")
def remove_token(name: Name, data_dir: DataDir = None) -> None:
    """Withdraw a token; its sessions end at once."""
    settings = settings_of(data_dir)
    from app.store import NotFound
    from app.store.tokens import TokenFile

    with audit_of(settings) as note:
        try:
            left = TokenFile(settings.tokens, settings.tokens_seen).remove(name)
        except NotFound as error:
            raise OsgError(f"{error}; osg-studio tokens list shows them") from error
        note("tokens remove", name)
    tell(f"{name} is not let in any more")
    if not left and settings.token is None:
        tell("that was the last token, so nobody is let in now; add one: osg-studio tokens add")


models_command = typer.Typer(
    help="Pose and hand models: install, list, export.", invoke_without_command=True
)


@models_command.callback()
def models(context: typer.Context) -> None:
    """List the models when no subcommand follows."""
    if context.invoked_subcommand is None:
        list_models()


@models_command.command("list")
def list_models() -> None:
    """List the models with state, size and path."""
    from app.recognition.models.storage import installed_models

    for model in installed_models():
        typer.echo(f"{model.name}\t{model.state}\t{model.size}\t{model.path}")


@models_command.command("install")
def install_models_command(
    source: Annotated[
        Path | None, typer.Option(help="Folder to copy from: exported, or that of a release.")
    ] = None,
) -> None:
    """Copy model files that are missing or damaged to the models folder; a wheel has them."""
    from app.recognition.models.storage import install_models, models_dir

    with progress_bar("models") as advance:
        install_models(
            progress=lambda stage, done, total: advance(done, total, stage), source=source
        )
    tell(f"all models are in {models_dir()}")


@models_command.command("export")
def export_models_command(
    directory: Annotated[Path, typer.Argument(help="Folder to copy the models to.")],
) -> None:
    """Copy the models to a folder, for a robot without network."""
    from app.recognition.models.storage import export_models

    export_models(directory)
    tell(f"on the robot: osg-studio models install --source {directory}")
