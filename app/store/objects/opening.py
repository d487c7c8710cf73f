"""Object store of an address: a shared folder, or S3."""

from __future__ import annotations

from app.store.objects.object_store import ObjectStore
from app.store.objects.shared_folder import SharedFolder


def open_object_store(address: str | None) -> ObjectStore:
    """Return the object store at ``s3://BUCKET/PREFIX``; without an address, the folder itself.

    Raises
    ------
    StoreUnavailable
        When the object store's settings in the environment cannot be used.

    """
    if address is None:
        return SharedFolder()
    # The S3 library is an extra, and takes a third of a second to load.
    from app.store.objects.s3 import S3Objects

    bucket, _, prefix = address.removeprefix("s3://").partition("/")
    return S3Objects(bucket, prefix.strip("/"))
