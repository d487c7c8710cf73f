"""View requests: looks up the clip and recognition that a workspace must show."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, StrictBool

from app.api.http.schemas.values import Body
from app.api.services.running_studio import Studio
from app.api.services.stored_recognitions import load_language, load_recognition
from app.recognition import Language
from app.store import RecognitionRecord
from app.ui.workspace import WorkspaceView


class ViewRequest(Body):
    """What a workspace is to show."""

    clip_id: Annotated[str, Field(max_length=64)]
    recognition_id: Annotated[str | None, Field(max_length=64)] = None
    language_id: Annotated[str | None, Field(max_length=64)] = None
    start: Annotated[float | None, Field(ge=0, allow_inf_nan=False)] = None
    end: Annotated[float | None, Field(ge=0, allow_inf_nan=False)] = None
    keep_frame: StrictBool = False
    """Whether the clock goes on where it is, in the same clip."""


def view_of(studio: Studio, request: ViewRequest) -> WorkspaceView:
    """Return the clip and the recognition that a request names.

    Without a range, the range of the recognition is taken; without a language, the revision that
    recognised it.

    Raises
    ------
    NotFound
        When there is no such clip, recognition or language.
    ProblemError
        409 while the clip's poses are not extracted.

    """
    clip = studio.clips.get(request.clip_id).clip
    recording = studio.recording(clip.id, so_far=True)
    record = studio.recognitions.get(request.recognition_id) if request.recognition_id else None
    start, end = request.start, request.end
    if record is not None and start is None and end is None:
        start, end = record.start, record.end
    return WorkspaceView(
        title=clip.name,
        video=studio.clips.video(clip.id),
        recording=recording,
        start=start,
        end=end,
        recognition=load_recognition(record) if record else None,
        expected=record.expected if record else None,
        language=_language(studio, request, record),
    )


def _language(
    studio: Studio, request: ViewRequest, record: RecognitionRecord | None
) -> Language | None:
    if record is not None:
        return load_language(record, studio)
    if request.language_id:
        return studio.language(studio.languages.get(request.language_id))
    return None
