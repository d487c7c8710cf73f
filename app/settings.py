"""Settings of the server: from arguments, or from the environment as ``OSG_<NAME>``."""

from __future__ import annotations

import os
import re
from importlib.util import find_spec
from ipaddress import ip_address
from pathlib import Path
from typing import Annotated, Literal, Self

from platformdirs import user_data_path
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    SecretStr,
    field_validator,
    model_validator,
)
from pydantic_settings import BaseSettings, NoDecode, SettingsConfigDict

from app import resources
from app.recognition.estimation.water import WaterCorrection

MEBIBYTE = 1024 * 1024

S3 = "s3://"
"""Prefix of the address of an S3 bucket."""

DASK = "dask://"
"""Prefix of the address of a Dask scheduler."""

TOKENS_FILE = "tokens.json"
"""Name of the file of the named tokens in the data folder."""

TOKENS_SEEN = "tokens.seen"
"""Name of the file in the data folder that remembers that there were named tokens."""

SHORTEST_TOKEN = 16
"""Fewest characters of a token: 64 bits in hexadecimal, too many to guess at twenty attempts a
minute."""


def is_loopback(host: str) -> bool:
    """Return whether `host` is reachable from this machine only."""
    if host == "localhost":
        return True
    try:
        return ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False


def _absolute(path: Path) -> Path:
    return path.expanduser().absolute()


def _split(names: object) -> object:
    if not isinstance(names, str):
        return names
    return tuple(name.strip() for name in names.split(",") if name.strip())


S3_ADDRESS = r"^s3://[a-z0-9][a-z0-9.-]{1,61}[a-z0-9](/\S*)?$"

S3Address = Annotated[str, Field(pattern=S3_ADDRESS)]
"""A bucket, with the prefix of our objects' names in it."""

Place = Annotated[Path, AfterValidator(_absolute)]
"""A folder as an absolute path, because worker processes have another working directory."""


class Limits(BaseModel):
    """Limits of one server that few need to change, in the setting `Settings.limits`."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    storage_copy_bytes: Annotated[int, Field(ge=0)] = 0
    """Largest total size in bytes of a server's copies of clips in an ``s3://`` storage; the
    least recently used are removed first, and fetched again when needed. 0 is no limit."""

    max_body_bytes: Annotated[int, Field(gt=0)] = MEBIBYTE
    """Largest JSON body accepted; the largest one the page sends is below 10 kB."""

    max_language_bytes: Annotated[int, Field(gt=0)] = 64 * MEBIBYTE
    """Largest language file accepted. The published format takes 0.85 MB a gesture."""

    free_disk_bytes: Annotated[int, Field(ge=0)] = 256 * MEBIBYTE
    """Space that an upload must leave free, so that the database can still write."""

    upload_bytes_per_second: Annotated[int, Field(ge=0)] = 8 * 1024
    """Slowest request body tolerated after `upload_grace_seconds`; 0 tolerates any."""

    upload_grace_seconds: Annotated[float, Field(gt=0)] = 30.0
    """Seconds before the rate of a request body is checked, and the longest pause within one."""

    idle_seconds: Annotated[float, Field(gt=0)] = 15.0
    """Seconds for the header of a request; a connection without one is then closed."""

    max_connections: Annotated[int, Field(ge=0)] = 0
    """Most open connections, half of them from one address; 0 sets no limit beside the system's."""

    max_jobs_per_client: Annotated[int, Field(gt=0)] = 64
    """Waiting jobs allowed for one address: enough for the clips of a language."""

    worker_memory_bytes: Annotated[int, Field(ge=0)] = 6 * 1024 * MEBIBYTE
    """Address space of one worker in bytes, and memory of all together for each of `workers`; 0 for
    no limit, which GPU providers need."""

    worker_cpu_seconds: Annotated[int, Field(ge=0)] = 2 * 60 * 60
    """Processor time of one job; 0 is no limit. A slow machine takes 80 ms a frame, so that the
    longest clip (`app.recognition.recording.video.VideoLimits`) takes 72 minutes."""

    worker_file_bytes: Annotated[int, Field(ge=0)] = 4 * 512 * MEBIBYTE
    """Largest file in bytes that a job may write while it unpacks a dive recording or copies a
    video: the largest unpacked archive (`app.bags.staging.MOST_BYTES`). 0 is no limit."""

    worker_silence_seconds: Annotated[float, Field(gt=0)] = 120.0
    """Seconds without progress after which a worker counts as hanging and is stopped."""


class Settings(BaseSettings):
    """Settings of one server; every field can be given as ``OSG_<FIELD>`` in the environment."""

    model_config = SettingsConfigDict(env_prefix="OSG_", frozen=True, extra="forbid")

    data_dir: Place = Field(
        default_factory=lambda: user_data_path("osg-studio", appauthor=False) / "studio"
    )
    """Folder of the database and the clips; created when missing."""

    database_url: str | None = None
    """SQLAlchemy URL of the database: ``None`` is SQLite inside `data_dir`, for one server;
    ``postgresql+psycopg://USER@HOST/NAME`` is for several."""

    storage: Annotated[S3Address | Place | None, Field(union_mode="left_to_right")] = None
    """Place of the clips' files, for several servers on one database: a shared folder, or
    ``s3://BUCKET/PREFIX``, of which each server keeps copies in its `data_dir`. ``None`` is the
    folder ``clips`` in `data_dir`."""

    samples_dir: Place = Field(default_factory=resources.samples_dir)
    """Folder of ``*.json`` sample languages and ``clips/``; may be absent."""

    host: str = "127.0.0.1"
    """Address to listen on."""

    port: Annotated[int, Field(ge=0, le=65535)] = 8000
    """Port to listen on; 0 lets the system choose."""

    token: SecretStr | None = None
    """Secret of at least 16 characters that every request must contain; required when other
    machines can reach `host`."""

    tokens_file: Path | None = None
    """File of the named tokens (`osg-studio tokens`); ``tokens.json`` in `data_dir` by default. A
    server does not start without the file that is named here."""

    quota_bytes: Annotated[int, Field(ge=0)] = 0
    """Bytes of clips that each named token may keep, unless it has its own quota; 0 is no limit."""

    quota_clips: Annotated[int, Field(ge=0)] = 0
    """Clips that each named token may keep, unless it has its own quota; 0 is no limit."""

    forwarded_allow_ips: str = ""
    """Addresses of reverse proxies whose ``X-Forwarded-For``, ``-Proto``, ``-Prefix`` are trusted,
    comma separated; ``*`` trusts all, for a server that only a proxy can reach."""

    log_format: Literal["text", "json"] = "text"
    """Format of the log: lines for people, or one JSON object a line with request and job ids."""

    log_level: Literal["debug", "info", "warning", "error"] = "warning"
    """Least severe entries logged; ``info`` logs every request and job."""

    allowed_hosts: Annotated[tuple[str, ...], NoDecode, BeforeValidator(_split)] = ()
    """Further host names of the app, comma separated in the environment."""

    max_clip_bytes: Annotated[int, Field(gt=0)] = 512 * MEBIBYTE
    """Largest clip accepted. Ten minutes of a dive camera's 1080p at 6 Mbit/s are 450 MB."""

    water: WaterCorrection = "auto"
    """Correction of colour and contrast: ``auto`` if the models then find more, ``on`` always,
    ``off`` never."""

    workers: Annotated[int, Field(ge=1, le=64)] = 1
    """Clips extracted at the same time, each in its own process (the models use all cores), and one
    more if another person's would wait; with `executor`, this server's extractions on all
    machines."""

    executor: Annotated[str, Field(pattern=r"^dask://[^/\s]+:\d+$")] | None = None
    """Where extractions, checks, test runs and exports run: ``None`` is this machine;
    ``dask://HOST:PORT`` is the Dask cluster of that scheduler, whose machines see the clips' folder
    under the same path."""

    undo_hours: Annotated[float, Field(ge=0)] = 24.0
    """Hours for which deleted items can be restored; a running server then removes them within ten
    minutes."""

    limits: Limits = Limits()
    """Limits that few need to change, as a JSON object; those that are left out keep their default:
    ``OSG_LIMITS='{"max_connections": 500}'``."""

    @property
    def public(self) -> bool:
        """Whether other machines can reach the server."""
        return not is_loopback(self.host)

    @property
    def tokens(self) -> Path:
        """File of the named tokens, which need not exist."""
        return self.tokens_file or self.data_dir / TOKENS_FILE

    @property
    def tokens_seen(self) -> Path:
        """File that remembers the newest list of named tokens that this data folder has seen."""
        return self.data_dir / TOKENS_SEEN

    @property
    def clips(self) -> Path:
        """Folder of the clips' files on this machine."""
        return self.storage if isinstance(self.storage, Path) else self.data_dir / "clips"

    @property
    def objects(self) -> str | None:
        """Address of the object store of the clips' files; None if a folder has them all."""
        return self.storage if isinstance(self.storage, str) else None

    @property
    def database(self) -> str:
        """SQLAlchemy URL of the database in use."""
        return self.database_url or f"sqlite:///{self.data_dir / 'studio.db'}"

    @model_validator(mode="before")
    @classmethod
    def _refuse_single_limits(cls, values: object) -> object:
        """Refuse limits as version 0.2 had them: an ignored limit would be none."""
        for name in Limits.model_fields:
            if (variable := f"OSG_{name.upper()}") in os.environ:
                raise ValueError(
                    f"{variable} is read no more: set OSG_LIMITS='{{\"{name}\": ...}}'"
                )
        return values

    @field_validator("executor")
    @classmethod
    def _executor_is_installed(cls, value: str | None) -> str | None:
        if value is not None and find_spec("distributed") is None:
            raise ValueError(
                "OSG_EXECUTOR names a Dask cluster, and Dask is not installed here; "
                'install it with: pip install "osg-studio[dask]"'
            )
        return value

    @field_validator("storage", mode="before")
    @classmethod
    def _object_store_is_usable(cls, value: object) -> object:
        if not isinstance(value, str) or not value.startswith(S3):
            return value
        if not re.fullmatch(S3_ADDRESS, value):
            raise ValueError(f"OSG_STORAGE={value!r} names no bucket; give s3://BUCKET/PREFIX")
        if find_spec("boto3") is None:
            raise ValueError(
                "OSG_STORAGE names an object store, and its library is not installed here; "
                'install it with: pip install "osg-studio[s3]"'
            )
        return value

    @model_validator(mode="after")
    def _public_needs_token(self) -> Self:
        if self.token is not None:
            length = len(self.token.get_secret_value().strip())
            if not length:
                raise ValueError("the token is empty; give a long random one or none at all")
            if length < SHORTEST_TOKEN:
                raise ValueError(
                    f"the token has {length} characters and can be guessed; give a random one of "
                    f"at least {SHORTEST_TOKEN}"
                )
        if self.public and self.token is None and not self.tokens.is_file():
            raise ValueError(
                f"host {self.host!r} can be reached from other machines and no token is set, so "
                "anyone there could read and delete clips; set a token (--token or OSG_TOKEN), "
                "add a named one (osg-studio tokens add), or stay on 127.0.0.1"
            )
        return self
