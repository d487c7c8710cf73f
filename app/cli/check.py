"""Command ``osg-studio check``: runs the health check of a language."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from textwrap import wrap
from typing import Annotated, Final

import typer

from app.cli.terminal import progress_bar
from app.recognition import Language
from app.recognition.health.check import check_health
from app.recognition.health.choice import describe_people, measure_confusions
from app.recognition.health.finding import Verdict
from app.recognition.health.forecast import Outcome
from app.recognition.health.report import GestureHealth, HealthReport, LimitHealth
from app.resources import known_signs_file

HAS_ERRORS = 1
"""Exit code when the report has an error."""


def check(
    file: Annotated[Path, typer.Argument(metavar="FILE.json", help="Language file.")],
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
    keep: Annotated[
        int | None,
        typer.Option(min=1, metavar="K", help="Name the K gestures that are told apart best."),
    ] = None,
    vehicle: Annotated[
        Path | None, typer.Option(help="Also check a vehicle table of `osg-studio robot`.")
    ] = None,
) -> None:
    """Check a language before the dive: what others will reach, and what is wrong.

    The exit code is 1 when the report has an error, or the vehicle table does not fit.
    """
    language = Language.load(file)
    if keep is not None:
        _show_choice(language, keep, as_json=as_json)
        return
    faults = [] if vehicle is None else _list_table_faults(vehicle, language)
    with progress_bar("check") as advance:
        report = check_health(
            language,
            progress=lambda stage, done, total: advance(done, total or None, stage),
            known_signs=Language.load(known_signs_file()),
        )
    verdict = Verdict.of(report.errors, language.labels)
    if as_json:
        told = report.to_dict() | {"verdict": verdict.to_dict()}
        told |= {} if vehicle is None else {"vehicle": faults}
        typer.echo(json.dumps(told, allow_nan=False))
    else:
        typer.echo(format_report(report, verdict), nl=False)
        for fault in faults:
            typer.echo(f"error: vehicle table: {fault}")
    if faults or not report.ok:
        raise typer.Exit(HAS_ERRORS)


def _list_table_faults(file: Path, language: Language) -> list[str]:
    """List what is wrong with a vehicle table in a language."""
    from app.robot.mavlink.table import read_vehicle_table

    table = read_vehicle_table(file)
    return [fault for _, fault in table.list_faults(language)]


def _show_choice(language: Language, keep: int, *, as_json: bool) -> None:
    """Print the gestures that are told apart best, and how often the others are mixed up."""
    confusions = measure_confusions(language)
    kept = confusions.choose(keep)
    labels = [confusions.labels[index] for index in kept]
    left_out = [label for label in confusions.labels if label not in labels]
    pairs = [pair for pair in confusions.list_pairs() if pair.is_alike or pair.mixed]
    if as_json:
        listed = [vars(pair) | {"words": pair.words} for pair in pairs]
        typer.echo(json.dumps({"keep": labels, "leave_out": left_out, "pairs": listed}))
        return
    typer.echo(f"keep: {', '.join(labels)}")
    typer.echo(f"leave out: {', '.join(left_out) or 'none'}")
    for pair in pairs:
        typer.echo(f"{' and '.join(pair.gestures)}: {pair.words}")
    typer.echo(describe_people(confusions.people))


OTHERWISE: Final[Mapping[Outcome, str]] = {
    "asked": "asked back with the right one",
    "refused": "refused",
    "wrong": "read as another",
}
"""Outcomes that are not right, in words."""

WIDTH: Final = 100
"""Most characters of a line, where they can be chosen."""

COUNTING: Final = ("direction", "tempo", "hand_shape")
"""Properties that may count beside the figure, as in the answer's `counts`."""


def format_report(report: HealthReport, verdict: Verdict) -> str:
    """Format the report as text with a trailing line break."""
    lines = [
        *_format_head(report, verdict),
        *_format_trigger(report),
        *_format_limit(report.limit),
        *_format_gestures(report),
        *_format_findings(report),
    ]
    return "\n".join([*lines, ""])


def _format_head(report: HealthReport, verdict: Verdict) -> Iterator[str]:
    result = verdict.words if report.ok else f"NOT READY, {verdict.words}"
    yield f"{report.language}, revision {report.revision}: {result}"
    yield from wrap(report.forecast.words, WIDTH)
    counts = {words: report.forecast.count(outcome) for outcome, words in OTHERWISE.items()}
    if any(rate is not None for rate in counts.values()):
        yield ", ".join(f"{words} {rate}" for words, rate in counts.items())


def _format_trigger(report: HealthReport) -> Iterator[str]:
    if (trigger := report.trigger) is not None:
        yield f"takes lie {trigger.words}"
        yield (
            f"trigger: missed of {trigger.missed} simulated people, set off "
            f"{trigger.false_per_hour:.0f} times in an hour of moving arms"
        )


def _format_limit(limit: LimitHealth | None) -> Iterator[str]:
    if limit is None:
        return
    if limit.people == 1:
        yield "limit: a cautious constant, because one person has shown this language"
        return
    dial = f"dial {100 * limit.most_refused:.3g}%" if limit.measured else "a cautious constant"
    costs = ["-" if rate is None else str(rate) for rate in (limit.refused, limit.accepted)]
    yield (
        f"limit of {limit.people} people, {dial}: refuses {costs[0]} of right takes, "
        f"accepts {costs[1]} of missing gestures"
    )


def _format_gestures(report: HealthReport) -> Iterator[str]:
    if not report.gestures:
        return
    yield ""
    head = ("gesture", "read right", "nearest", "counts", "seconds", "depends on (visible)")
    rows = [_format_gesture(report, gesture) for gesture in report.gestures]
    yield from _align([head, *rows])


def _format_gesture(report: HealthReport, gesture: GestureHealth) -> tuple[str, ...]:
    right = report.forecast.count("right", gesture.label)
    near, counts = gesture.nearest, vars(gesture.counts) if gesture.counts else {}
    return (
        gesture.label,
        "-" if right is None else f"{right.happened} of {right.n}",
        "-" if near is None else f"{near[0]} {near[1]:.2f}",
        ", ".join(name.replace("_", " ") for name in COUNTING if counts.get(name)) or "-",
        "-" if gesture.seconds is None else f"{gesture.seconds:.1f}",
        ", ".join(f"{each.landmark} ({each.visible:.0%})" for each in gesture.landmarks),
    )


def _format_findings(report: HealthReport) -> Iterator[str]:
    for finding in report.findings:
        yield ""
        yield f"{'ERROR' if finding.error else 'note'}: {finding.message}"


def _align(rows: Sequence[Sequence[str]]) -> Iterator[str]:
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    for row in rows:
        cells = (cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        yield "  ".join(cells).rstrip()
