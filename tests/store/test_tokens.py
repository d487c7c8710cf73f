"""The list of named tokens: every way of losing it shuts everybody out, none opens anything."""

from __future__ import annotations

import json
import os
import shutil
import stat
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from app.store import NotFound, Role, TokenFile
from app.store.tokens import MOST_BYTES, TokensUnavailable, is_reserved


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "share" / "tokens.json"


@pytest.fixture
def seen(tmp_path: Path) -> Path:
    return tmp_path / "data" / "tokens.seen"


@pytest.fixture
def tokens(file: Path, seen: Path) -> TokenFile:
    """Return a list with one token, Ada's."""
    tokens = TokenFile(file, seen)
    tokens.add("Ada", Role.EDIT)
    return tokens


def reread(file: Path, seen: Path) -> TokenFile:
    """Return the list as a server that starts anew reads it."""
    return TokenFile(file, seen)


def test_without_a_list_none_is_in_use(file: Path, seen: Path) -> None:
    tokens = reread(file, seen)
    assert tokens.read() == ()
    assert not tokens.in_use


def remove(file: Path) -> None:
    file.unlink()


def unmount(file: Path) -> None:
    shutil.rmtree(file.parent)


def replace_folder_by_file(file: Path) -> None:
    shutil.rmtree(file.parent)
    file.parent.write_text("no folder")


def link_to_nothing(file: Path) -> None:
    file.unlink()
    file.symlink_to(file.with_name("gone"))


def empty_the_list(file: Path) -> None:
    document = json.loads(file.read_text())
    file.write_text(json.dumps(document | {"tokens": []}))


@pytest.mark.withstands(row="H29")
@pytest.mark.parametrize(
    "lose", [remove, unmount, replace_folder_by_file, link_to_nothing, empty_the_list]
)
def test_a_list_that_is_lost_stays_in_use_and_has_no_tokens(
    tokens: TokenFile, file: Path, seen: Path, lose: Callable[[Path], None]
) -> None:
    lose(file)
    for each in (tokens, reread(file, seen)):
        assert each.read() == ()
        assert each.in_use


def damage(file: Path) -> None:
    file.write_text('{"tokens": 1}')


def truncate(file: Path) -> None:
    os.truncate(file, file.stat().st_size // 2)


def truncate_to_nothing(file: Path) -> None:
    os.truncate(file, 0)


def replace_by_folder(file: Path) -> None:
    file.unlink()
    file.mkdir()


def replace_by_pipe(file: Path) -> None:
    file.unlink()
    os.mkfifo(file)


def link_to_endless_device(file: Path) -> None:
    file.unlink()
    file.symlink_to("/dev/zero")


def link_to_itself(file: Path) -> None:
    file.unlink()
    file.symlink_to(file)


def grow(file: Path) -> None:
    with file.open("ab") as grown:
        grown.truncate(MOST_BYTES + 1)


@pytest.mark.withstands(row="H29")
@pytest.mark.parametrize(
    "lose",
    [
        damage,
        truncate,
        truncate_to_nothing,
        replace_by_folder,
        replace_by_pipe,
        link_to_endless_device,
        link_to_itself,
        grow,
    ],
)
def test_a_list_that_cannot_be_read_is_an_error_and_not_an_empty_list(
    tokens: TokenFile, file: Path, seen: Path, lose: Callable[[Path], None]
) -> None:
    lose(file)
    for each in (tokens, reread(file, seen)):
        with pytest.raises(TokensUnavailable, match="nobody with one is let in"):
            each.read()
        with pytest.raises(TokensUnavailable):
            _ = each.in_use


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="root may read everything")
def test_a_list_without_permission_is_an_error(tokens: TokenFile, file: Path) -> None:
    file.chmod(0)
    with pytest.raises(TokensUnavailable):
        tokens.read()


@pytest.mark.withstands(row="H29")
def test_an_older_list_brings_no_withdrawn_token_back(
    tokens: TokenFile, file: Path, seen: Path
) -> None:
    older = file.with_name("older.json")
    shutil.copy2(file, older)
    tokens.remove("Ada")
    # In place or renamed over it, as two programs for backups do it.
    for put in (shutil.copy2, shutil.move):
        put(older, file)
        for each in (tokens, reread(file, seen)):
            with pytest.raises(TokensUnavailable, match="older than those"):
                each.read()
    with pytest.raises(TokensUnavailable, match="older than those"):
        tokens.add("Bo", Role.READ)
    file.unlink()
    tokens.add("Bo", Role.READ)
    assert [each.name for each in reread(file, seen).read()] == ["Bo"]


def test_a_list_of_an_earlier_version_is_read_until_a_newer_one_was_written(
    file: Path, seen: Path
) -> None:
    tokens = TokenFile(file, seen)
    tokens.add("Ada", Role.EDIT)
    former = json.loads(file.read_text())
    del former["written"]
    seen.unlink()
    file.write_text(json.dumps(former))
    later = reread(file, seen)
    assert [each.name for each in later.read()] == ["Ada"]
    later.add("Bo", Role.READ)
    file.write_text(json.dumps(former))
    with pytest.raises(TokensUnavailable, match="older"):
        reread(file, seen).read()


def test_what_the_data_folder_remembers_must_be_readable(
    tokens: TokenFile, file: Path, seen: Path
) -> None:
    assert stat.S_IMODE(seen.stat().st_mode) == 0o600
    seen.write_text("tomorrow")
    with pytest.raises(TokensUnavailable, match="remove it, look through the tokens"):
        reread(file, seen).read()
    seen.write_text("2026-11-26")
    assert reread(file, seen).read() == tokens.read()


def test_of_changes_at_the_same_time_none_undoes_another(file: Path, seen: Path) -> None:
    names = [f"diver {number}" for number in range(12)]
    with ThreadPoolExecutor(4) as administrators:
        list(administrators.map(lambda name: TokenFile(file, seen).add(name, Role.READ), names))
    assert sorted(each.name for each in reread(file, seen).read()) == sorted(names)


@pytest.mark.parametrize(
    "name",
    [
        "admin",
        "Admin",
        "ADMIN ",
        "ad-min",
        "adm1n",
        "adrnin",
        "\u0430dmin",
        "\uff41\uff44\uff4d\uff49\uff4e",
        "\u00e0dmin",
        "command line",
        "Command-Line",
        " ",
        "-",
    ],
)
def test_names_of_the_audit_log_itself_and_their_look_alikes_are_reserved(
    name: str, file: Path
) -> None:
    with pytest.raises(ValueError, match="reserved"):
        TokenFile(file).add(name, Role.EDIT)
    assert not file.exists()


@pytest.mark.parametrize("name", ["Ada", "administrator", "Boat screen", "Adam", "commander"])
def test_other_names_are_not_reserved(name: str) -> None:
    assert not is_reserved(name)


def test_withdrawing_tells_how_many_tokens_are_left(tokens: TokenFile) -> None:
    tokens.add("Bo", Role.READ)
    assert tokens.remove("Ada") == 1
    with pytest.raises(NotFound, match="no token named 'Ada'"):
        tokens.remove("Ada")
    assert tokens.remove("Bo") == 0
