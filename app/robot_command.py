"""The command ``osg-studio robot``: listen for a language, and tell what was said as JSON lines."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from types import FrameType
from typing import Annotated

import typer

from app.recognition.estimation import create_estimator
from app.recognition.estimation.water import WaterCorrection
from app.recognition.recognizer import PROFILES
from app.robot import Event, Listener, Runtime, SpottingListener, TakeRecognized, open_source
from app.robot.messages import line_of
from app.robot.watched_language import WatchedLanguage
from app.robot_text import sentence_of
from app.terminal import people

NOTHING_RECOGNISED = 1
"""Exit code of a recording in which no gesture was recognised."""


def robot(
    language: Annotated[Path, typer.Option(help="Language file; read again when it changes.")],
    source: Annotated[
        str,
        typer.Option(help="Camera number or device, rtsp:// or http:// address, or a clip."),
    ] = "0",
    profile: Annotated[str, typer.Option(help=f"Set of voters: {', '.join(PROFILES)}.")] = "full",
    without_salutes: Annotated[
        bool, typer.Option("--without-salutes", help="Hear gestures that no salute announces.")
    ] = False,
    water: Annotated[
        WaterCorrection,
        typer.Option(help="Correct colour and contrast: of murky frames, of all, or of none."),
    ] = "auto",
) -> None:
    """Listen for a language and print what happens, one JSON object a line.

    A clip ends by itself, with exit code 1 when nothing was recognised in it; a camera is
    listened to until Ctrl-C or SIGTERM. SIGHUP reads the language file again.
    """
    hearing = SpottingListener if without_salutes else Listener
    with WatchedLanguage(language, profile) as spoken:
        listener = hearing(spoken.first)
        with closing(open_source(source)) as opened, closing(create_estimator()) as estimator:
            runtime = Runtime(opened, estimator, listener, water=water, changes=spoken.changes)
            with signals_heeded(runtime.stop, spoken.reload):
                recognised = told(runtime)
    if not recognised and not opened.live:
        raise typer.Exit(NOTHING_RECOGNISED)


def told(runtime: Runtime) -> int:
    """Write every event to stdout, and for people to stderr; return how many were recognitions.

    When nobody reads stdout any more the runtime ends, as pipelines do.
    """
    recognised = 0
    try:
        for event in runtime:
            recognised += isinstance(event, TakeRecognized)
            tell(event)
    except BrokenPipeError:
        # Python flushes stdout once more at its end, and would complain there.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return recognised


def tell(event: Event) -> None:
    """Write one event, at once."""
    typer.echo(line_of(event))
    if sentence := sentence_of(event):
        people.print(sentence, markup=False, highlight=False, soft_wrap=True)


@contextmanager
def signals_heeded(stop: Callable[[], None], reload: Callable[[], None]) -> Iterator[None]:
    """Stop after the frame at hand on SIGINT and SIGTERM, at once on a second; reload on SIGHUP."""
    wanted = {signal.SIGINT: stop, signal.SIGTERM: stop}
    if hasattr(signal, "SIGHUP"):  # Windows has none
        wanted[signal.SIGHUP] = reload

    before = {number: signal.getsignal(number) for number in wanted}

    def heed(number: int, frame: FrameType | None) -> None:
        kind = signal.Signals(number)
        if wanted[kind] is stop:
            signal.signal(kind, before[kind])
        wanted[kind]()

    for number in wanted:
        signal.signal(number, heed)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
