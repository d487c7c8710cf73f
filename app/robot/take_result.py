"""What a robot makes of a take: a gesture that it may act on, or a rejection with its reason."""

from __future__ import annotations

from app.recognition import PoseError, Recognition, Take
from app.robot.active_language import SpokenLanguage
from app.robot.events import TakeRecognized, TakeRejected


def verdict_on_take(
    language: SpokenLanguage, take: Take, time: float, unclosed: str
) -> TakeRecognized | TakeRejected:
    """Recognise a take.

    Parameters
    ----------
    language
        The language to ask.
    take
        What was shown.
    time
        Seconds: now.
    unclosed
        Why a take that no stop salute ended has none. Such a take is rejected, whatever it looks
        like: who began a gesture and did not end it has not said anything yet.

    """
    try:
        recognition = language.recognizer.recognize(take.poses)
    except PoseError as error:
        return rejection(language, take, time, str(error))
    if not take.closed:
        return rejection(language, take, time, unclosed, recognition)
    return verdict(language, recognition, time, take.start, take.end)


def verdict(
    language: SpokenLanguage, recognition: Recognition, time: float, start: float, end: float
) -> TakeRecognized | TakeRejected:
    """Tell what a recognition between two moments means for the robot."""
    if recognition.label is None:
        return TakeRejected(
            time=time,
            start=start,
            end=end,
            closed=True,
            reason=reason_of(language, recognition),
            sha256=language.sha256,
            revision=language.revision,
            recognition=recognition,
        )
    return TakeRecognized(
        time=time,
        start=start,
        end=end,
        closed=True,
        label=recognition.label,
        confidence=recognition.confidence,
        margin=recognition.margin,
        command=language.recognizer.language.gesture(recognition.label).command,
        sha256=language.sha256,
        revision=language.revision,
        recognition=recognition,
    )


def rejection(
    language: SpokenLanguage,
    take: Take,
    time: float,
    reason: str,
    recognition: Recognition | None = None,
) -> TakeRejected:
    """Reject a take for a reason."""
    return TakeRejected(
        time=time,
        start=take.start,
        end=take.end,
        closed=take.closed,
        reason=reason,
        sha256=language.sha256,
        revision=language.revision,
        recognition=recognition,
    )


def reason_of(language: SpokenLanguage, recognition: Recognition) -> str:
    """Say why a recognition has no label."""
    if recognition.fault:
        return f"too poor to judge: {recognition.fault}"
    novelty = recognition.novelty[recognition.gestures.index(recognition.nearest)]
    return (
        f"no gesture of {language.name!r}: the nearest, {recognition.nearest!r}, is {novelty:.1f} "
        "times as far away as it may be"
    )
