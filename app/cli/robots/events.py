"""Descriptions of robot events: one sentence per event, printed in the terminal."""

from __future__ import annotations

from app.robot import (
    Event,
    FrameRateChanged,
    FramesDropped,
    LanguageChanged,
    LanguageRefused,
    OutputFailed,
    PhraseHeard,
    RecognitionReady,
    SourceLost,
    SourceOpened,
    SourceRestored,
    SourceWarned,
    TakeRecognized,
    TakeRejected,
    VehicleReported,
)


def describe_event(event: Event) -> str:
    """Describe an event in one sentence; empty for events that need none."""
    if isinstance(event, TakeRecognized | TakeRejected):
        return _describe_take(event)
    if isinstance(event, PhraseHeard):
        return event.phrase.text
    if isinstance(event, VehicleReported):
        return f"vehicle: {event.text}"
    if isinstance(event, OutputFailed):
        return f"{event.output} is not written any more: {event.reason}; recognition goes on"
    if isinstance(event, LanguageChanged | LanguageRefused):
        return _describe_language(event)
    return _describe_source(event)


def _describe_take(event: TakeRecognized | TakeRejected) -> str:
    span = f"{event.start:.2f} - {event.end:.2f} s"
    if isinstance(event, TakeRecognized):
        return f"{span}: {event.label} ({event.confidence:.2f})"
    if event.pair is not None:
        return f"{span}: {event.reason}"
    return f"{span}: rejected, {event.reason}"


def _describe_language(event: LanguageChanged | LanguageRefused) -> str:
    if isinstance(event, LanguageRefused):
        return (
            f"the new language file is not used, revision {event.revision} is kept: {event.reason}"
        )
    return (
        f"listening for {event.name!r}, revision {event.revision}, code {event.code}: "
        f"{', '.join(event.gestures)} (profile {event.profile}, {event.tuning})"
    )


def _describe_source(event: Event) -> str:
    match event:
        case SourceOpened(source=source, frame_size=(width, height)):
            return f"watching {source}, {width} x {height} pixels"
        case SourceWarned(reason=reason):
            return reason
        case SourceLost(reason=reason):
            return f"source lost: {reason}; it is opened again and again"
        case SourceRestored(missing=missing):
            return f"source restored after {missing:.1f} s"
        case RecognitionReady(time=time):
            return f"ready for gestures, {time:.1f} s after the source was opened"
        case FrameRateChanged():
            return event.words
        case FramesDropped(seconds=seconds, dropped=dropped, frames=frames):
            return f"{dropped} of {dropped + frames} frames dropped in {seconds:.0f} s"
        case _:
            return ""
