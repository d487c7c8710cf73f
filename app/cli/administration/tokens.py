"""Commands ``osg-studio tokens``: who may read, edit or administer a studio."""

from __future__ import annotations

from enum import Enum
from typing import Annotated

import typer

from app.cli.administration.data_folder import DataDir, audit_of, settings_of
from app.cli.terminal import people
from app.recognition.errors import OsgError

tokens_command = typer.Typer(help="Named tokens of a studio: add, list, remove.")

Name = Annotated[str, typer.Argument(help="Who uses it, as in the audit log.")]


class RoleOption(str, Enum):
    """What a token allows; each includes the ones before it."""

    read = "read"
    edit = "edit"
    admin = "admin"


@tokens_command.command("add")
def add_token(
    name: Name,
    role: Annotated[RoleOption, typer.Option(help="What the token allows.")] = RoleOption.edit,
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
    words = [name, "--role", role.value, *(f"{key} {value}" for key, value in given if value)]
    try:
        with audit_of(settings) as note:
            secret = tokens.add(
                name, Role(role.value), quota_bytes=quota_bytes, quota_clips=quota_clips
            )
            note("tokens add", " ".join(words))
    except OsgError:
        raise
    except ValueError as error:
        raise OsgError(
            f"{name[:80]!r} cannot be a token's name: use 1 to 80 letters, digits, spaces, "
            "points, @, _ or -"
        ) from error
    typer.echo(secret)
    people.print(
        f"{name} may {role.value}; the token is not kept, only its digest in {settings.tokens}",
        markup=False,
        highlight=False,
    )


@tokens_command.command("list")
def list_tokens(data_dir: DataDir = None) -> None:
    """List the tokens by name, role, day and quotas, separated by tabs."""
    settings = settings_of(data_dir)
    from app.store import StoreError
    from app.store.tokens import TokenFile

    try:
        tokens = TokenFile(settings.tokens, settings.tokens_seen).read()
    except StoreError as error:
        raise OsgError(str(error)) from error
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
    people.print(f"{name} is not let in any more", markup=False, highlight=False)
    if not left and settings.token is None:
        people.print(
            "that was the last token, so nobody is let in now; add one: osg-studio tokens add",
            markup=False,
            highlight=False,
        )
