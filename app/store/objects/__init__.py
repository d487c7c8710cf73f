"""Object stores: where clip files are kept beside the local folder."""

from app.store.objects.object_store import ObjectStore, SharedFolder, open_object_store
