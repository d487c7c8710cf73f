"""S3 object store: Amazon S3, or a compatible server such as MinIO or Ceph."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

import boto3
from boto3.exceptions import Boto3Error
from botocore.config import Config
from botocore.exceptions import BotoCoreError, ClientError

from app.store.database import StoreUnavailable

CONNECT_SECONDS: Final = 5
"""Longest time in seconds to reach the server; a user waits for the answer."""

READ_SECONDS: Final = 60
"""Longest pause in seconds within an answer."""

TRIES: Final = 2
"""Attempts at one request before an error; uploads and jobs are repeated by their callers."""

_NOTHING: Final = ("404", "NoSuchKey", "NotFound")


class S3Objects:
    """Keeps files in a bucket; see `ObjectStore`.

    Credentials, region and ``AWS_ENDPOINT_URL`` are read as the AWS tools do: from the environment,
    their files, or the machine's role.

    Parameters
    ----------
    bucket
        Name of the bucket, which must exist.
    prefix
        Beginning of all names in it, without slashes around it; may be empty.

    """

    def __init__(self, bucket: str, prefix: str = "") -> None:
        self._bucket = bucket
        self._prefix = f"{prefix}/" if prefix else ""
        with self._errors():
            self._client: Any = boto3.session.Session().client(
                "s3",
                config=Config(
                    connect_timeout=CONNECT_SECONDS,
                    read_timeout=READ_SECONDS,
                    retries={"total_max_attempts": TRIES, "mode": "standard"},
                ),
            )

    def upload(self, file: Path, name: str) -> None:
        """Store a file; a large one is sent in parts and appears when all have arrived."""
        with self._errors():
            self._client.upload_file(str(file), self._bucket, self._prefix + name)

    def download(self, name: str, target: Path) -> bool:
        """Write an object to a file; return False when there is none."""
        with self._errors():
            try:
                self._client.download_file(self._bucket, self._prefix + name, str(target))
            except ClientError as error:
                if _is_missing(error):
                    return False
                raise
        return True

    def size(self, name: str) -> int | None:
        """Return the bytes of an object; None when there is none."""
        with self._errors():
            try:
                found = self._client.head_object(Bucket=self._bucket, Key=self._prefix + name)
            except ClientError as error:
                if _is_missing(error):
                    return None
                raise
        return int(found["ContentLength"])

    def remove(self, clip_id: str) -> None:
        """Remove the objects of a clip."""
        with self._errors():
            found = self._client.list_objects_v2(
                Bucket=self._bucket, Prefix=f"{self._prefix}{clip_id}/"
            )
            for each in found.get("Contents", ()):
                self._client.delete_object(Bucket=self._bucket, Key=each["Key"])

    @contextmanager
    def _errors(self) -> Iterator[None]:
        """Turn the library's errors into `StoreUnavailable`."""
        try:
            yield
        except (BotoCoreError, Boto3Error, ClientError) as error:
            reason = " ".join(str(error).split())
            raise StoreUnavailable(
                f"the object store s3://{self._bucket} cannot be used now: {reason}; try again, or "
                "look at AWS_ENDPOINT_URL and the credentials"
            ) from error


def _is_missing(error: ClientError) -> bool:
    """Return whether S3 says that there is no such object."""
    return error.response.get("Error", {}).get("Code") in _NOTHING
