"""Object stores: where clip files are kept beside the local folder."""

from app.store.objects.object_store import ObjectStore
from app.store.objects.opening import open_object_store
from app.store.objects.shared_folder import SharedFolder

__all__ = ["ObjectStore", "SharedFolder", "open_object_store"]
