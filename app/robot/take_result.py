"""Take result: recognises a take and builds the event, a gesture or a rejection with a reason."""

from __future__ import annotations

import json
from typing import Any

from app.recognition import PoseError, Recognition, Take
from app.recognition.text.wording import ask_which, join_words
from app.robot.active_language import ActiveLanguage
from app.robot.events import TakeEvent, TakeRecognized, TakeRejected


def judge_take(language: ActiveLanguage, take: Take, time: float, unclosed: str) -> TakeEvent:
    """Recognise a take and build its event.

    Parameters
    ----------
    language
        Language that recognises the take.
    take
        The take.
    time
        Current time of the source, in seconds.
    unclosed
        Reason to give for a take without a stop salute. This take is always rejected, because the
        gesture may be incomplete.

    """
    try:
        recognition = language.recognizer.recognize_take(take)
    except PoseError as error:
        return reject_take(language, take, time, str(error))
    if not take.closed:
        return reject_take(language, take, time, unclosed, recognition)
    return judge_recognition(language, recognition, time, take.start, take.end)


def judge_recognition(
    language: ActiveLanguage, recognition: Recognition, time: float, start: float, end: float
) -> TakeEvent:
    """Build the event of a recognition from `start` to `end`: recognised, a pair, or rejected."""
    recognition = language.recognizer.ask_undecided(recognition)
    about: dict[str, Any] = {"time": time, "start": start, "end": end, "recognition": recognition}
    if recognition.label is None:
        reason = explain_rejection(language, recognition)
        return _reject(language, reason, **about, closed=True, pair=recognition.pair)
    return TakeRecognized(
        **about,
        closed=True,
        label=recognition.label,
        confidence=recognition.confidence,
        margin=recognition.margin,
        command=language.recognizer.language.gesture(recognition.label).command,
        sha256=language.sha256,
        revision=language.revision,
    )


def reject_take(
    language: ActiveLanguage,
    take: Take,
    time: float,
    reason: str,
    recognition: Recognition | None = None,
) -> TakeRejected:
    """Build the event of a take that is rejected for `reason`."""
    about = {"start": take.start, "end": take.end, "closed": take.closed}
    return _reject(language, reason, **about, time=time, recognition=recognition)


def _reject(language: ActiveLanguage, reason: str, **about: Any) -> TakeRejected:
    return TakeRejected(reason=reason, sha256=language.sha256, revision=language.revision, **about)


def explain_rejection(language: ActiveLanguage, recognition: Recognition) -> str:
    """Return why a recognition has no label, in words."""
    if recognition.fault:
        poor = "insufficient recording quality: " if recognition.fault_kind else ""
        return f"{poor}{recognition.fault}"
    if recognition.pair:
        return f"{ask_which(recognition.pair)} show it again"
    if recognition.between:
        return f"it lies between {join_words(recognition.between)}"
    return (
        f"no gesture of {language.name!r}: the nearest, {recognition.nearest!r}, is "
        f"{recognition.nearest_novelty:.2f} times as far away as it may be"
    )


def list_message_fields(event: TakeEvent, language: str) -> dict[str, Any]:
    """Return the fields of a ``GestureRecognition`` message, in ROS 2 and over DDS.

    All but its header and its times, whose types differ; `language` is the language's name.
    """
    answer = event.recognition
    return {
        "language_id": event.sha256,
        "language_name": language,
        "language_revision": event.revision,
        "profile": answer.profile if answer else "",
        "closed": event.closed,
        "label": "" if isinstance(event, TakeRejected) else event.label,
        "nearest": event.nearest or "",
        "confidence": event.confidence or 0.0,
        "margin": event.margin or 0.0,
        "rejected": isinstance(event, TakeRejected),
        "reason": event.reason if isinstance(event, TakeRejected) else "",
        "report": json.dumps(answer.to_dict(), allow_nan=False) if answer else "",
        "pair": list((event.pair if isinstance(event, TakeRejected) else None) or ()),
        "novelty": answer.nearest_novelty if answer else 0.0,
    }
