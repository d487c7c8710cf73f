"""Health report as text for a terminal: aligned columns, kinds of findings in words, no colour."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from app.recognition.health.finding import Finding
from app.recognition.health.report import (
    MOST_CONFUSION,
    MOST_MISSED,
    GestureHealth,
    HealthReport,
    LimitHealth,
)
from app.recognition.simulation.rate_estimate import RateEstimate

MOST_PAIRS = 10
"""Number of pairs listed, the most confused first; the JSON has all of them."""

WORTH_LISTING = 0.001
"""Lowest predicted confusion rate of a pair that is listed."""


def format_report(report: HealthReport) -> str:
    """Format the report as text with a trailing line break."""
    lines = [
        *_format_head(report),
        *_format_trigger(report),
        *_format_limit(report.limit),
        *_format_gestures(report),
        *_format_pairs(report),
        *_format_findings(report),
    ]
    return "\n".join([*lines, ""])


def _format_head(report: HealthReport) -> Iterator[str]:
    errors = sum(finding.below_bar for finding in report.findings)
    counted = "1 error" if errors == 1 else f"{errors} errors"
    result = "ready" if report.ok else f"NOT READY, {counted}"
    yield f"{report.language}, revision {report.revision}: {result}"
    who = "its demonstrator" if report.person == "same" else "another person"
    yield f"predicted from {report.takes} variants of each gesture, as shown by {who}"
    yield (
        f"thresholds: {MOST_CONFUSION:.0%} confusion of a pair, {MOST_MISSED:.0%} of a gesture's "
        "takes missed"
    )


def _format_trigger(report: HealthReport) -> Iterator[str]:
    if (trigger := report.trigger) is not None:
        yield f"takes lie {trigger.words}"
        yield (
            f"trigger: missed of {format_rate(trigger.missed)} of other people, set off "
            f"{trigger.false_per_hour:.0f} times in an hour of moving arms"
        )


def _format_limit(limit: LimitHealth | None) -> Iterator[str]:
    if limit is None:
        return
    if limit.people == 1:
        yield "limit: a cautious constant, because one person has shown this language"
        return
    dial = f"dial {100 * limit.most_refused:.3g}%" if limit.measured else "a cautious constant"
    costs = [
        "-" if rate is None else f"{rate.rate:.0%} ({rate.low:.0%}-{rate.high:.0%}, n {count})"
        for rate, count in zip((limit.refused, limit.accepted), limit.takes, strict=True)
    ]
    yield (
        f"limit of {limit.people} people, {dial}: refuses {costs[0]} of right takes, "
        f"accepts {costs[1]} of missing gestures"
    )


def _format_gestures(report: HealthReport) -> Iterator[str]:
    if not report.gestures:
        return
    yield ""
    head = (
        "gesture",
        "missed",
        "of it rejected",
        "false alarms",
        "seconds",
        "depends on (visible)",
    )
    yield from _align([head, *(_format_gesture(gesture) for gesture in report.gestures)])


def _format_gesture(gesture: GestureHealth) -> tuple[str, ...]:
    seconds = "-" if gesture.seconds is None else f"{gesture.seconds:.1f}"
    needed = ", ".join(f"{each.landmark} ({each.visible:.0%})" for each in gesture.landmarks)
    return (
        gesture.label,
        format_rate(gesture.missed),
        "-" if gesture.refused is None else f"{gesture.refused.rate:.1%}",
        format_rate(gesture.false_alarms),
        seconds,
        needed,
    )


def _format_pairs(report: HealthReport) -> Iterator[str]:
    listed = [
        (*pair.gestures, format_rate(pair.first_as_second), format_rate(pair.second_as_first))
        for pair in report.pairs
        if pair.confusion is not None and pair.confusion.rate >= WORTH_LISTING
    ]
    if not report.pairs:
        return
    yield ""
    if not listed:
        yield f"no pair is predicted to be confused more often than {WORTH_LISTING:.1%}"
        return
    head = ("pair", "", "first recognised as second", "second as first")
    yield from _align([head, *listed[:MOST_PAIRS]])


def _format_findings(report: HealthReport) -> Iterator[str]:
    for finding in report.findings:
        yield ""
        yield from _format_finding(finding)


def _format_finding(finding: Finding) -> Iterator[str]:
    kind = "ERROR" if finding.below_bar else "note"
    yield f"{kind}: {finding.message}"
    for remedy in finding.remedies:
        yield f"  - {remedy.text}: {remedy.before.rate:.1%} becomes {format_rate(remedy.after)}"


def format_rate(estimate: RateEstimate | None) -> str:
    """Format an estimated rate with its interval; a dash where there is none."""
    if estimate is None:
        return "-"
    return f"{estimate.rate:.1%} ({estimate.low:.1%}-{estimate.high:.1%})"


def _align(rows: Sequence[Sequence[str]]) -> Iterator[str]:
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    for row in rows:
        cells = (cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        yield "  ".join(cells).rstrip()
