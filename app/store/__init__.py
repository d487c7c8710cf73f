"""Store of clips, languages, jobs and recognitions: a database, and files beside it."""

from app.store.clips import ClipStore, ClipWithJob
from app.store.database import Database
from app.store.demonstration_sources import SourceStore
from app.store.errors import Conflict, NotFound, StoreError, StoreUnavailable
from app.store.folder_lock import FolderLock
from app.store.jobs import JobStore
from app.store.languages import Draft, LanguageState, LanguageStore
from app.store.models import (
    Clip,
    DemonstrationSource,
    Job,
    JobStatus,
    LanguageRecord,
    LanguageRevision,
    RecognitionRecord,
)
from app.store.recognitions import RecognitionStore
from app.store.uploads import Upload, UploadStore

__all__ = [
    "Clip",
    "ClipStore",
    "ClipWithJob",
    "Conflict",
    "Database",
    "DemonstrationSource",
    "Draft",
    "FolderLock",
    "Job",
    "JobStatus",
    "JobStore",
    "LanguageRecord",
    "LanguageRevision",
    "LanguageState",
    "LanguageStore",
    "NotFound",
    "RecognitionRecord",
    "RecognitionStore",
    "SourceStore",
    "StoreError",
    "StoreUnavailable",
    "Upload",
    "UploadStore",
]
