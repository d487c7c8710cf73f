"""The start of a server: what it says about tokens that are missing."""

from __future__ import annotations

from pathlib import Path

import pytest
from pydantic import SecretStr

from app.api.services.identities import Identities, check_tokens
from app.settings import Settings
from app.store import Role, StoreUnavailable, TokenFile


@pytest.fixture
def tokens(settings: Settings) -> TokenFile:
    return TokenFile(settings.tokens, settings.tokens_seen)


def test_a_server_on_this_machine_needs_no_tokens(settings: Settings) -> None:
    assert check_tokens(settings) is None
    assert not settings.tokens_seen.exists()


@pytest.mark.parametrize("own", [None, "correct-horse-battery"])
def test_a_named_file_that_is_absent_refuses_the_start(
    settings: Settings, tmp_path: Path, own: str | None
) -> None:
    named = settings.model_copy(
        update={
            "tokens_file": tmp_path / "mnt" / "tokens.json",
            "token": None if own is None else SecretStr(own),
        }
    )
    with pytest.raises(StoreUnavailable, match=r"mnt/tokens.json, which does not exist.*mount"):
        check_tokens(named)


def test_an_empty_or_lost_list_is_said_with_the_way_out(
    settings: Settings, tokens: TokenFile
) -> None:
    tokens.add("Ada", Role.EDIT)
    assert check_tokens(settings) is None
    tokens.remove("Ada")
    for lost in (False, True):
        if lost:
            settings.tokens.unlink()
        advice = check_tokens(settings) or ""
        assert "nobody is let in" in advice
        assert "osg-studio tokens add" in advice
        assert str(settings.tokens_seen) in advice
        assert "\n" not in advice
    own = settings.model_copy(update={"token": SecretStr("correct-horse-battery")})
    assert check_tokens(own) is None


def test_a_link_to_a_list_on_a_disk_that_is_not_mounted_opens_nothing(
    settings: Settings, tmp_path: Path
) -> None:
    settings.data_dir.mkdir()
    settings.tokens.symlink_to(tmp_path / "mnt" / "tokens.json")
    assert Identities(settings).required
    assert "nobody is let in" in (check_tokens(settings) or "")


def test_a_list_lost_with_all_memory_of_it_before_the_first_request_opens_nothing(
    settings: Settings, tokens: TokenFile
) -> None:
    tokens.add("Ada", Role.EDIT)
    started = Identities(settings)
    settings.tokens.unlink()
    settings.tokens_seen.unlink()
    assert started.required
    assert started.nobody


def test_a_damaged_list_is_said_too(settings: Settings, tokens: TokenFile) -> None:
    tokens.add("Ada", Role.EDIT)
    settings.tokens.write_text("{")
    assert "cannot be read" in (check_tokens(settings) or "")
