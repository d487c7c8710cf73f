"""Recording cache: the recordings of clips that requests read, limited together."""

from __future__ import annotations

from collections import OrderedDict
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from threading import Lock
from weakref import WeakKeyDictionary, WeakValueDictionary

from app.api.http.problems import RETRY_SECONDS, ProblemError
from app.recognition.recording.recording import MOST_BYTES, Recording, unpacked_bytes
from app.store import ClipStore, JobStatus
from app.store.clips import SO_FAR

CACHED_RECORDINGS = 4
"""Number of recordings cached: the clip on screen and those it is compared with."""

MOST_RECORDED_BYTES = 2 * MOST_BYTES
"""Most memory of the arrays of all recordings in use or cached: two of the largest allowed."""


@dataclass(frozen=True)
class RecordingFile:
    """File of a recording, as a key of caches.

    Attributes
    ----------
    path
        The file.
    written
        Nanoseconds of its last change: a clip may be read again.
    whole
        Whether it has all frames; else the others are being read.

    """

    path: Path
    written: int
    whole: bool = True


def whole_recording(path: Path) -> RecordingFile:
    """Return the file of a recording with all frames, which `load_recording` finds missing."""
    return RecordingFile(path, path.stat().st_mtime_ns if path.is_file() else 0)


class RecordingCache:
    """Recordings that are in use or used lately, whose arrays are limited together."""

    def __init__(self) -> None:
        self._lately: OrderedDict[RecordingFile, Recording] = OrderedDict()
        self._held: WeakValueDictionary[RecordingFile, Recording] = WeakValueDictionary()
        self._sizes: WeakKeyDictionary[Recording, int] = WeakKeyDictionary()
        self._changing, self._loading = Lock(), Lock()

    def get(self, file: RecordingFile) -> Recording:
        """Load a recording, or return it from the cache.

        Raises
        ------
        ProblemError
            503 while those that others use leave too little memory.

        """
        if (found := self._find(file)) is not None:
            return found
        with self._loading:  # One at a time, so that each counts before the next one is loaded.
            found = self._find(file) or self._load(file)
        self._find(file)
        return found

    def _find(self, file: RecordingFile) -> Recording | None:
        with self._changing:
            if (found := self._held.get(file)) is not None:
                self._lately[file] = found
                self._lately.move_to_end(file)
                if len(self._lately) > CACHED_RECORDINGS:
                    self._lately.popitem(last=False)
            return found

    def _load(self, file: RecordingFile) -> Recording:
        size = unpacked_bytes(file.path)
        with self._changing:
            most = MOST_RECORDED_BYTES - size
            while self._lately and sum(self._sizes.values()) > most:
                self._lately.popitem(last=False)
            if sum(self._sizes.values()) > most:
                detail = "recordings in use take all memory that they may; try again in a moment"
                headers = {"Retry-After": RETRY_SECONDS}
                raise ProblemError(503, "service_unavailable", detail, headers=headers)
        loaded = Recording.load(file.path)
        with self._changing:
            self._held[file], self._sizes[loaded] = loaded, size
        return loaded


_recordings = RecordingCache()
load_recording = _recordings.get


def recording_of(clips: ClipStore, clip_id: str, *, so_far: bool = False) -> Recording:
    """Return the recording of a clip; see `recording_file`."""
    return load_recording(recording_file(clips, clip_id, so_far=so_far))


def recording_file(clips: ClipStore, clip_id: str, *, so_far: bool = False) -> RecordingFile:
    """Return the file of a clip's recording.

    Parameters
    ----------
    clips
        The store of the clips.
    clip_id
        The clip's.
    so_far
        Whether the first frames suffice while the others are being read.

    Raises
    ------
    NotFound
        When there is no such clip.
    ProblemError
        409 while its poses are not extracted.

    """
    found = clips.get(clip_id)
    if so_far and found.job.status == JobStatus.RUNNING:
        with suppress(OSError):
            file = clips.place(clip_id, SO_FAR)
            return RecordingFile(file, file.stat().st_mtime_ns, whole=False)
    if found.job.status != JobStatus.DONE:
        reason = f"{found.job.status}: {found.job.error}" if found.job.error else None
        raise ProblemError(
            409,
            "clip_not_ready",
            f"the poses of this clip are not extracted ({reason or found.job.status}); "
            "wait for its job, or start it again",
            job_id=found.job.id,
        )
    return whole_recording(clips.recording(clip_id))
