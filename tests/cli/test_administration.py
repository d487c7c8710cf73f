"""Tokens and the audit log on the command line."""

from __future__ import annotations

import json
import stat
from pathlib import Path

import pytest

from app.store import AuditEntry, AuditStore, Database, Role, TokenFile
from app.store.tokens import digest
from tests.command_line import OsgStudio


def test_a_token_is_printed_once_and_only_its_digest_is_kept(
    osg_studio: OsgStudio, tmp_path: Path
) -> None:
    added = osg_studio(
        "tokens", "add", "Ada", "--role", "read", "--quota-clips", 5, "--data-dir", tmp_path
    )
    assert added.code == 0, added.error
    secret = added.out.strip()
    assert len(secret) == 32
    file = tmp_path / "tokens.json"
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    assert secret not in file.read_text()
    (token,) = TokenFile(file).read()
    assert (token.name, token.role, token.sha256) == ("Ada", Role.READ, digest(secret))
    listed = osg_studio("tokens", "list", "--data-dir", tmp_path)
    assert listed.out.split("\t") == ["Ada", "read", f"{token.created:%Y-%m-%d}", "-", "5\n"]


def test_a_token_of_a_known_name_replaces_the_former_one(
    osg_studio: OsgStudio, tmp_path: Path
) -> None:
    former, later = (
        osg_studio("tokens", "add", "Ada", "--data-dir", tmp_path).out.strip() for _ in range(2)
    )
    (token,) = TokenFile(tmp_path / "tokens.json").read()
    assert former != later
    assert token.sha256 == digest(later)
    assert token.role is Role.EDIT
    assert osg_studio("tokens", "remove", "Ada", "--data-dir", tmp_path).code == 0
    assert osg_studio("tokens", "list", "--data-dir", tmp_path).out == ""


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["tokens", "remove", "Nobody"], "no token named 'Nobody'"),
        (["tokens", "add", "a\tb"], "cannot be a token's name"),
        (["tokens", "add", ""], "cannot be a token's name"),
        (["tokens", "add", " "], "cannot be a token's name"),
        (["tokens", "add", "admin"], "looks like, one that the audit log has"),
        (["tokens", "add", "Command-Line"], "looks like, one that the audit log has"),
        (["audit"], "holds no studio"),
    ],
)
def test_wrong_use_is_one_line(
    osg_studio: OsgStudio, tmp_path: Path, arguments: list[str], says: str
) -> None:
    ended = osg_studio(*arguments, "--data-dir", tmp_path)
    assert ended.code == 2
    assert says in ended.error
    assert ended.error.count("\n") == 1


def test_changes_are_listed_the_newest_first(osg_studio: OsgStudio, tmp_path: Path) -> None:
    database = Database(f"sqlite:///{tmp_path / 'studio.db'}")
    database.migrate()
    for number, name in enumerate(("Ada", "Bo")):
        AuditStore(database, tmp_path).add(
            AuditEntry(
                name=name,
                role="edit",
                address="127.0.0.1",
                method="DELETE",
                path=f"/api/v1/clips/{number}",
                status=204,
                request_id="r",
            )
        )
    database.close()
    lines = osg_studio("audit", "--data-dir", tmp_path).out.splitlines()
    assert [line.split("\t")[1] for line in lines] == ["Bo", "Ada"]
    assert lines[0].split("\t")[4:] == ["DELETE", "/api/v1/clips/1", "204"]
    (entry,) = osg_studio(
        "audit", "--name", "Ada", "--json", "--data-dir", tmp_path
    ).out.splitlines()
    assert json.loads(entry)["path"] == "/api/v1/clips/0"


def test_who_withdraws_the_last_token_is_told_that_nobody_is_let_in(
    osg_studio: OsgStudio, tmp_path: Path
) -> None:
    for name in ("Ada", "Bo"):
        osg_studio("tokens", "add", name, "--data-dir", tmp_path)
    assert "nobody" not in osg_studio("tokens", "remove", "Ada", "--data-dir", tmp_path).error
    last = osg_studio("tokens", "remove", "Bo", "--data-dir", tmp_path)
    assert last.code == 0
    assert "nobody is let in now" in last.error


def test_a_list_that_is_older_than_the_newest_is_one_line(
    osg_studio: OsgStudio, tmp_path: Path
) -> None:
    osg_studio("tokens", "add", "Ada", "--data-dir", tmp_path)
    older = (tmp_path / "tokens.json").read_bytes()
    osg_studio("tokens", "remove", "Ada", "--data-dir", tmp_path)
    (tmp_path / "tokens.json").write_bytes(older)
    for arguments in (["list"], ["add", "Bo"], ["remove", "Ada"]):
        ended = osg_studio("tokens", *arguments, "--data-dir", tmp_path)
        assert ended.code == 2
        assert "older than those" in ended.error
        assert ended.error.count("\n") == 1


def test_a_file_of_tokens_that_the_environment_names_is_made_by_the_command(
    osg_studio: OsgStudio, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("OSG_TOKENS_FILE", str(tmp_path / "named.json"))
    monkeypatch.setenv("OSG_HOST", "0.0.0.0")
    refused = osg_studio("serve", "--no-browser", "--data-dir", tmp_path, "--host", "127.0.0.1")
    assert refused.code == 2
    assert "OSG_TOKENS_FILE names" in refused.error
    assert refused.error.count("\n") == 1
    added = osg_studio("tokens", "add", "Ada", "--data-dir", tmp_path)
    assert added.code == 0, added.error
    assert [each.name for each in TokenFile(tmp_path / "named.json").read()] == ["Ada"]


def test_commands_of_the_administrator_are_in_the_audit_log(
    osg_studio: OsgStudio, tmp_path: Path
) -> None:
    data, restored = tmp_path / "data", tmp_path / "restored"
    # The first one, before there is a database, is taken over with the next.
    osg_studio("tokens", "add", "Ada", "--role", "read", "--quota-clips", 5, "--data-dir", data)
    assert not (data / "studio.db").exists()
    database = Database(f"sqlite:///{data / 'studio.db'}")
    database.migrate()
    database.close()
    osg_studio("tokens", "remove", "Ada", "--data-dir", data)
    osg_studio("tokens", "remove", "Nobody", "--data-dir", data)
    saved = tmp_path / "library.zip"
    assert osg_studio("backup", saved, "--data-dir", data).code == 0
    assert osg_studio("restore", saved, "--data-dir", restored).code == 0
    before = [
        ["tokens remove", "Ada", "0"],
        ["tokens add", "Ada --role read --quota-clips 5", "0"],
    ]
    for folder, last in ((data, "backup"), (restored, "restore")):
        lines = osg_studio("audit", "--data-dir", folder).out.splitlines()
        fields = [line.split("\t") for line in lines]
        assert {each[1] for each in fields} == {"command line"}
        assert [each[4:] for each in fields] == [[last, str(saved), "0"], *before]
