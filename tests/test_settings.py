"""What can be set, and what must not be."""

from pathlib import Path

import pytest
from pydantic import SecretStr, ValidationError

from app.settings import Limits, Settings, is_loopback


@pytest.fixture(autouse=True)
def _bare_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("HOST", "PORT", "TOKEN", "DATA_DIR", "DATABASE_URL", "ALLOWED_HOSTS"):
        monkeypatch.delenv(f"OSG_{name}", raising=False)


def test_by_default_only_this_machine_is_served() -> None:
    settings = Settings()
    assert (settings.host, settings.port, settings.public) == ("127.0.0.1", 8000, False)


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.168.1.20", "dive-box.local", "10.0.0.1"])
@pytest.mark.withstands(row="H26")
def test_a_public_address_without_a_token_is_refused_with_the_way_out(host: str) -> None:
    with pytest.raises(ValidationError, match=r"can be reached.*no token.*--token.*127\.0\.0\.1"):
        Settings(host=host)
    assert Settings(host=host, token=SecretStr("long and very random")).public


def test_a_token_that_can_be_guessed_is_refused() -> None:
    with pytest.raises(ValidationError, match="15 characters"):
        Settings(token=SecretStr("x" * 15))
    Settings(token=SecretStr("x" * 16))


@pytest.mark.parametrize("token", ["", "   "])
def test_an_empty_token_is_no_token(token: str) -> None:
    with pytest.raises(ValidationError, match="token is empty"):
        Settings(host="0.0.0.0", token=SecretStr(token))


@pytest.mark.parametrize(
    ("host", "loopback"),
    [
        ("localhost", True),
        ("127.0.0.1", True),
        ("127.8.9.1", True),
        ("::1", True),
        ("[::1]", True),
        ("0.0.0.0", False),
        ("::", False),
        ("localhost.example", False),
        ("", False),
    ],
)
def test_loopback_is_known_by_address(host: str, loopback: bool) -> None:
    assert is_loopback(host) is loopback


def test_the_environment_sets_what_arguments_do_not(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("OSG_DATA_DIR", str(tmp_path))
    monkeypatch.setenv("OSG_PORT", "9000")
    monkeypatch.setenv("OSG_ALLOWED_HOSTS", "dive-box.local, studio.example")
    settings = Settings(port=9001)
    assert settings.port == 9001
    assert settings.data_dir == tmp_path
    assert settings.allowed_hosts == ("dive-box.local", "studio.example")
    assert settings.database == f"sqlite:///{tmp_path / 'studio.db'}"


def test_a_folder_given_relatively_is_where_the_server_was_started(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    assert Settings(data_dir=Path("data")).data_dir == tmp_path / "data"
    assert Settings(data_dir=Path("~/dives")).data_dir == tmp_path / "home" / "dives"


def test_another_database_can_be_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OSG_DATABASE_URL", "postgresql://studio@db/studio")
    assert Settings().database == "postgresql://studio@db/studio"


def test_the_token_is_never_printed() -> None:
    assert "hunter2" not in repr(Settings(token=SecretStr("hunter2 hunter2 hunter2")))


def test_an_executor_needs_its_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.settings.find_spec", lambda name: None)
    with pytest.raises(ValidationError, match=r'pip install "osg-studio\[dask\]"'):
        Settings(executor="dask://scheduler:8786")
    with pytest.raises(ValidationError, match="executor"):
        Settings(executor="tcp://scheduler")


def test_an_object_store_needs_its_extra_and_a_bucket(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    for wrong in ("s3://", "s3://UPPER", "s3:///prefix", "s3://dives/a b"):
        with pytest.raises(ValidationError, match="names no bucket"):
            Settings.model_validate({"storage": wrong})
    monkeypatch.setattr("app.settings.find_spec", lambda name: object())
    settings = Settings(storage="s3://dives/pool", data_dir=tmp_path)
    assert (settings.objects, settings.clips) == ("s3://dives/pool", tmp_path / "clips")
    monkeypatch.setattr("app.settings.find_spec", lambda name: None)
    with pytest.raises(ValidationError, match=r'pip install "osg-studio\[s3\]"'):
        Settings(storage="s3://dives")
    shared = Settings(storage=tmp_path)
    assert (shared.objects, shared.clips) == (None, tmp_path)


def test_limits_are_one_object_and_single_ones_are_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("OSG_LIMITS", '{"max_connections": 500}')
    assert Settings().limits.max_connections == 500
    assert Settings().limits.idle_seconds == Limits().idle_seconds
    monkeypatch.setenv("OSG_MAX_CONNECTIONS", "7")
    with pytest.raises(ValidationError, match="OSG_LIMITS"):
        Settings()


def test_an_unknown_limit_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OSG_LIMITS", '{"max_connection": 500}')
    with pytest.raises(ValidationError, match="max_connection"):
        Settings()
