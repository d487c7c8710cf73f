"""Store of clips, languages, jobs and recognitions: a database, and files beside it."""

from app.store.audit import AuditStore
from app.store.clips import ClipQuery, ClipStore, ClipWithJob
from app.store.data_folder import FolderLock, identity_of
from app.store.database import (
    Conflict,
    Database,
    InvitationClosed,
    NotFound,
    StoreError,
    StoreUnavailable,
    TooManyInvitations,
)
from app.store.invitations import InvitationState, InvitationStore, require_open
from app.store.jobs import JobStore
from app.store.languages import Draft, LanguageState, LanguageStore, SourceStore
from app.store.models import (
    AuditEntry,
    Clip,
    DemonstrationSource,
    Invitation,
    InvitedTake,
    Job,
    JobStatus,
    LabelledResult,
    LabelledTake,
    LanguageRevision,
    PracticeTake,
    RecognitionRecord,
)
from app.store.quotas import NO_QUOTA, Quota, QuotaExceeded, QuotaStore, Usage
from app.store.takes import RecognitionStore, TakeStore, TestedTake, TestSetFull
from app.store.tokens import NamedToken, Role, SignInStore, TokenFile
from app.store.uploads import Upload, UploadStore
