"""Commands on language files: check, code, phrase, slate, samples, convert."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from textwrap import wrap
from typing import Annotated, Final

import typer

from app.cli.terminal import progress_bar, tell
from app.recognition import Language, LanguageError
from app.recognition.errors import OsgError, explain_missing_package
from app.recognition.health.check import check_health
from app.recognition.health.choice import describe_people, measure_confusions
from app.recognition.health.finding import Verdict
from app.recognition.health.forecast import Outcome
from app.recognition.health.report import GestureHealth, HealthReport, LimitHealth
from app.recognition.language.export_format import FileFormat, from_reference, is_reference
from app.recognition.language.file import short_code
from app.recognition.phrases.grammar import Grammar
from app.recognition.phrases.parser import PhraseEvent, PhraseParser
from app.recognition.triggers.trigger import SALUTE
from app.resources import known_signs_file, samples_dir
from app.robot.active_language import ActiveLanguage

HAS_ERRORS = 1
"""Exit code when the report has an error."""


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


NOT_COMPLETE = 1
"""Exit code when the gestures are not a complete message."""


def code(
    language: Annotated[Path, typer.Argument(help="Language file (.json)")],
) -> None:
    """Print the code of a language file: the studio and the robot that has it show the same."""
    active = ActiveLanguage.load(language)
    tell(f"{active.name}, revision {active.revision}")
    typer.echo(short_code(active.sha256))


def slate(
    language: Annotated[Path, typer.Argument(help="Language file (.json)")],
    output: Annotated[Path, typer.Option(help="File to write, .pdf or .svg")],
    vehicle: Annotated[
        Path | None,
        typer.Option(help="Vehicle table whose answers to the diver are printed as well."),
    ] = None,
) -> None:
    """Write a language as one printable page for divers: strokes, meanings, and the salute."""
    # Imported here, because a robot's installation has the other commands, but cannot draw pages.
    from app.ui.slate.layout import lay_out
    from app.ui.slate.pdf import to_pdf
    from app.ui.slate.svg import to_svg

    kind = output.suffix.lower()
    if kind not in (".pdf", ".svg"):
        raise OsgError(f"a slate is written as .pdf or .svg, not as {output.name!r}")
    page = lay_out(Language.load(language), () if vehicle is None else list_answers(vehicle))
    content = to_pdf(page) if kind == ".pdf" else to_svg(page).encode("utf-8")
    output.write_bytes(content)
    tell(f"wrote {output}")


def list_answers(vehicle: Path) -> list[tuple[int, str]]:
    """Return the answers of a vehicle table, each as its number of pulses and its words.

    Raises
    ------
    OsgError
        When the table has none, is not valid, or its library is missing.

    """
    with explain_missing_package("--vehicle", "mavlink"):  # reads TOML before Python 3.11
        from app.robot.commands.replies import Reply
        from app.robot.mavlink.table import read_vehicle_table
    answers = read_vehicle_table(vehicle).answers
    if answers is None:
        raise OsgError(f"{vehicle} has no [answers]; leave --vehicle out, or add them")
    return sorted((answers.count_pulses(reply), reply.words) for reply in Reply)


def samples(
    folder: Annotated[Path, typer.Argument(help="Folder to write; must not exist.")] = Path(
        "languages"
    ),
) -> None:
    """Copy the sample languages and their clips to a folder, to try the commands with."""
    if folder.exists():
        raise OsgError(f"{folder} is there already; give the name of a folder that is not")
    source = samples_dir()
    (folder / "clips").mkdir(parents=True)
    for file in (*sorted(source.glob("*.json")), *sorted((source / "clips").glob("*.mp4"))):
        shutil.copyfile(file, folder / file.relative_to(source))
    tell(f"{folder}: sample languages, and their clips in {folder / 'clips'}")


def convert(
    source: Annotated[
        Path, typer.Argument(metavar="IN", help="Language file of osg-studio or osg-reference.")
    ],
    target: Annotated[Path, typer.Argument(metavar="OUT", help="File to write.")],
    file_format: Annotated[
        FileFormat | None,
        typer.Option(
            "--format",
            help="Format to write: proteus for OUT.ldf, otherwise osg-studio if left out.",
        ),
    ] = None,
) -> None:
    """Convert a language file: osg-studio, osg-reference (published implementation), proteus."""
    language = read_language(source)
    if file_format is None:
        proteus = target.suffix == FileFormat.PROTEUS.suffix
        file_format = FileFormat.PROTEUS if proteus else FileFormat.OSG_STUDIO
    if any(gesture.trajectory is None for gesture in language.gestures):
        tell(f"{source}: no trajectories, only images: osg-reference files have none")
    several = [gesture.label for gesture in language.gestures if gesture.further]
    if several and file_format is FileFormat.OSG_REFERENCE:
        tell(
            f"{target}: {file_format.value} keeps only the first demonstration of "
            f"{', '.join(several)}"
        )
    if language.trigger != SALUTE and file_format is not FileFormat.OSG_STUDIO:
        tell(f"{target}: {file_format.value} knows no trigger; tell it on the slate")
    if file_format is FileFormat.OSG_STUDIO:
        language.save(target)
    else:
        target.write_text(file_format.write(language), encoding="utf-8")
    tell(f"{target}: {len(language.gestures)} gestures as {file_format.value}")


def read_language(source: Path) -> Language:
    """Read a language file of OSG Studio or of the published implementation.

    Raises
    ------
    LanguageError
        When the file is neither; contains the JSON pointer to the fault.

    """
    content = source.read_bytes()
    if is_reference(content):
        return from_reference(content, source.stem)
    return Language.from_json(content)


def phrase(
    file: Annotated[Path, typer.Argument(metavar="FILE.json", help="Language file with phrases.")],
    gestures: Annotated[
        list[str] | None,
        typer.Argument(metavar="[LABEL]...", help="Labels of the gestures, in order."),
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object for each event.")
    ] = False,
) -> None:
    """Interpret a sequence of gestures; without gestures, list an example of each phrase.

    The exit code is 1 when the gestures are not a complete message.
    """
    language = Language.load(file)
    if language.grammar is None or not language.grammar.phrases:
        raise LanguageError(
            f"{file} has no phrases: add some in the studio under Phrases", "/grammar"
        )
    if not gestures:
        _list_phrases(language.grammar, as_json=as_json)
        return
    for label in gestures:
        language.gesture(label)  # raises an error for an unknown label
    events = simulate_phrase(language.grammar, gestures)
    for event in events:
        if as_json:
            typer.echo(json.dumps(event.to_dict(), allow_nan=False))
        elif event.mission is None:
            tell(event.text)
        else:
            typer.echo(event.mission.spoken)
    if not any(event.mission for event in events):
        raise typer.Exit(NOT_COMPLETE)


def simulate_phrase(grammar: Grammar, gestures: list[str]) -> list[PhraseEvent]:
    """Parse gestures without pauses between them, followed by a pause that ends the message.

    All gestures have the time 0.
    """
    parser = PhraseParser(grammar)
    events = [event for label in gestures for event in parser.feed(label, 0.0, 0.0)]
    return [*events, *parser.expire(2 * grammar.timeout)]


def _list_phrases(grammar: Grammar, *, as_json: bool) -> None:
    for each in grammar.phrases:
        shown = grammar.example(each)
        if as_json:
            typer.echo(json.dumps({"phrase": each.name, "example": list(shown)}))
        else:
            typer.echo(f"{each.name}: {' '.join(shown)}")


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
