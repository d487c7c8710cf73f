"""Command ``osg-studio phrase``: interprets a sequence of gestures by a language's grammar."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from app.cli.terminal import tell
from app.recognition import Language, LanguageError
from app.recognition.phrases.grammar import Grammar
from app.recognition.phrases.parser import PhraseEvent, PhraseParser

NOT_COMPLETE = 1
"""Exit code when the gestures are not a complete message."""


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
