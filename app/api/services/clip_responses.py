"""Response body of a stored clip."""

from __future__ import annotations

from app.api.http.schemas.clips import ClipView
from app.clip_sources import source_named
from app.recognition.recording.chapters import tell_chapters
from app.store import Clip, ClipWithJob, JobStatus


def shows_pictures(clip: Clip) -> bool:
    """Return whether the clip's video shows the diver and not only the received keypoints."""
    used = {topic["name"]: topic["use"] for topic in clip.topics}
    return source_named(clip.source).has_pictures and used.get(clip.topic) != "keypoints"


def view_clip(found: ClipWithJob) -> ClipView:
    """Return a clip and the state of its newest job."""
    clip, job = found.clip, found.job
    missing = job.salute_warnings
    hidden = {"idempotency_key", "deleted", "source", "options"}
    return ClipView(
        **clip.model_dump(exclude=hidden),
        turn=clip.turn,
        shows_pictures=shows_pictures(clip),
        status=JobStatus(job.status),
        error=job.error,
        error_code=job.error_code,
        warnings=job.warnings,
        salute_warnings=[*missing, *(tell_chapters(clip.name) if missing else ())],
    )
