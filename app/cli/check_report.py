"""The health report as text for a terminal: aligned columns, marks in words, no colour."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from app.recognition.health.finding import Finding
from app.recognition.health.report import (
    MOST_CONFUSION,
    MOST_MISSED,
    GestureHealth,
    HealthReport,
)
from app.recognition.simulation.rate_estimate import RateEstimate

MOST_PAIRS = 10
"""Pairs listed, the most confused first: the rest is in the JSON."""

WORTH_LISTING = 0.001
"""Predicted confusion from which a pair is listed."""


def health_text(report: HealthReport) -> str:
    """Lay the report out, a trailing line break included."""
    return "\n".join([*_head(report), *_gestures(report), *_pairs(report), *_warnings(report), ""])


def _head(report: HealthReport) -> Iterator[str]:
    below = sum(finding.below_bar for finding in report.findings)
    verdict = "ready" if report.ok else f"NOT READY, {below} below the bar"
    yield f"{report.language}, revision {report.revision}: {verdict}"
    who = "its demonstrator" if report.person == "same" else "somebody else"
    yield f"predicted from {report.takes} variants of each gesture, as shown by {who}"
    yield (
        f"bar: {MOST_CONFUSION:.0%} confusion of a pair, {MOST_MISSED:.0%} of a gesture's takes "
        "missed"
    )


def _gestures(report: HealthReport) -> Iterator[str]:
    if not report.gestures:
        return
    yield ""
    head = ("gesture", "missed", "of it refused", "false alarms", "seconds", "depends on (visible)")
    yield from _aligned([head, *(_gesture_row(gesture) for gesture in report.gestures)])


def _gesture_row(gesture: GestureHealth) -> tuple[str, ...]:
    seconds = "-" if gesture.seconds is None else f"{gesture.seconds:.1f}"
    needed = ", ".join(f"{each.landmark} ({each.visible:.0%})" for each in gesture.landmarks)
    return (
        gesture.label,
        percentage(gesture.missed),
        "-" if gesture.refused is None else f"{gesture.refused.rate:.1%}",
        percentage(gesture.false_alarms),
        seconds,
        needed,
    )


def _pairs(report: HealthReport) -> Iterator[str]:
    listed = [
        (*pair.gestures, percentage(pair.first_as_second), percentage(pair.second_as_first))
        for pair in report.pairs
        if pair.confusion is not None and pair.confusion.rate >= WORTH_LISTING
    ]
    if not report.pairs:
        return
    yield ""
    if not listed:
        yield f"no pair is predicted to be confused more often than {WORTH_LISTING:.1%}"
        return
    head = ("pair", "", "first read as second", "second as first")
    yield from _aligned([head, *listed[:MOST_PAIRS]])


def _warnings(report: HealthReport) -> Iterator[str]:
    for finding in report.findings:
        yield ""
        yield from _warning(finding)


def _warning(finding: Finding) -> Iterator[str]:
    mark = "BELOW THE BAR" if finding.below_bar else "note"
    yield f"{mark}: {finding.message}"
    for remedy in finding.remedies:
        yield f"  - {remedy.text}: {remedy.before.rate:.1%} becomes {percentage(remedy.after)}"


def percentage(forecast: RateEstimate | None) -> str:
    """Return a rate with its interval; a dash where nothing is known."""
    if forecast is None:
        return "-"
    return f"{forecast.rate:.1%} ({forecast.low:.1%}-{forecast.high:.1%})"


def _aligned(rows: Sequence[Sequence[str]]) -> Iterator[str]:
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    for row in rows:
        cells = (cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        yield "  ".join(cells).rstrip()
