"""Takes of a test set in a worker process: recognised one by one by one revision of a language."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from app.api.workers.worker_messages import Finished, Message, Progressed
from app.recognition import Language, OsgError, Recognizer, Recording
from app.recognition.language.requirements import require_seen_landmarks
from app.recognition.recording.clip_range import find_demonstration

Report = Callable[[Message], None]


class TakeToRecognize(BaseModel):
    """A range of a clip.

    Attributes
    ----------
    recording
        File with the clip's landmarks.
    start, end
        Seconds in the clip.
    keypoints_of
        Name of a clip of received keypoints, which may lack some; None if models found them.

    """

    recording: Path
    start: float
    end: float
    keypoints_of: str | None = None


class TestRunRequest(BaseModel):
    """What to recognise: the takes, by the language file of a revision."""

    __test__ = False

    document: str
    takes: list[TakeToRecognize]


class RecognizedTake(BaseModel):
    """The answer about one take: `Recognition.to_dict` in `answer`, or why there is none.

    Attributes
    ----------
    start, end
        Seconds of the recognised part, without transit.

    """

    start: float
    end: float
    answer: dict[str, Any] | None = None
    fault: str | None = None


def answer_file(folder: Path, index: int) -> Path:
    """Return the path of the answer about a take."""
    return folder / f"{index}.json"


def recognize_takes(request: Path, folder: Path, report: Report) -> None:
    """Recognise takes, and write each answer to a file of `folder` before it is reported."""
    wanted = TestRunRequest.model_validate_json(request.read_bytes())
    language = Language.from_json(wanted.document)
    # Made with the first take: that it cannot be made is the fault of every take.
    recognizer = cache(lambda: Recognizer(language))
    for index, take in enumerate(wanted.takes):
        try:
            found = _recognize(take, language, recognizer)
        except OsgError as error:
            found = RecognizedTake(start=take.start, end=take.end, fault=str(error))
        answer_file(folder, index).write_text(found.model_dump_json(), encoding="utf-8")
        report(Progressed(stage="recognising", done=index + 1, total=len(wanted.takes)))
    report(Finished(frames=0, warnings=()))


def _recognize(
    take: TakeToRecognize, language: Language, recognizer: Callable[[], Recognizer]
) -> RecognizedTake:
    recording = _load(take.recording)
    if take.keypoints_of is not None:
        require_seen_landmarks(language, recording.poses, take.keypoints_of)
    shown = find_demonstration(recording, take.start, take.end, trigger=language.trigger)
    answer = recognizer().recognize(shown.poses).to_dict()
    return RecognizedTake(start=shown.start, end=shown.end, answer=answer)


@lru_cache(1)
def _load(file: Path) -> Recording:
    """Load a recording; the takes of a clip come one after the other."""
    return Recording.load(file)
