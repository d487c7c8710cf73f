"""Commands on language files: code, phrase, slate, samples, convert."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Annotated

import typer

from app.cli.terminal import tell
from app.recognition import Language, LanguageError
from app.recognition.errors import OsgError, explain_missing_package
from app.recognition.language.export_format import FileFormat, from_reference, is_reference
from app.recognition.language.file import short_code
from app.recognition.phrases.grammar import Grammar
from app.recognition.phrases.parser import PhraseEvent, PhraseParser
from app.recognition.triggers.trigger import SALUTE
from app.resources import samples_dir
from app.robot.active_language import ActiveLanguage

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
