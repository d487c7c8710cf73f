"""The command ``osg-studio robot``: listen for a language, and tell what was said as JSON lines.

What only some options need is imported where they are given: a robot starts without it.
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager
from pathlib import Path
from types import FrameType
from typing import Annotated

import typer

from app.cli.estimator_options import EstimatorOption, HandsOption, WaterOption
from app.cli.robot_events import sentence_of
from app.cli.ros_arguments import BEGIN
from app.cli.terminal import people
from app.recognition.errors import EstimatorError
from app.recognition.estimation import create_estimator, finds_hands
from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.factory import MEDIAPIPE_HANDS, NO_HANDS
from app.recognition.estimation.water import WaterCorrection
from app.recognition.gestures.profile import PROFILES
from app.robot import (
    Event,
    Hearing,
    Runtime,
    Source,
    TakeRecognized,
    hearing_of,
    open_source,
)
from app.robot.messages import line_of
from app.robot.publishing.publisher import Network, open_publisher
from app.robot.runtime import Observer
from app.robot.watched_language import WatchedLanguage

NOTHING_RECOGNISED = 1
"""Exit code of a recording in which no gesture was recognised."""


def robot(
    context: typer.Context,
    language: Annotated[Path, typer.Option(help="Language file; read again when it changes.")],
    source: Annotated[
        str,
        typer.Option(
            help="Camera number or device, rtsp:// or http:// address, clip, BAG or BAG@/TOPIC."
        ),
    ] = "0",
    profile: Annotated[
        str | None,
        typer.Option(help=f"Set of voters, {' or '.join(PROFILES)}; by default the language's."),
    ] = None,
    without_salutes: Annotated[
        bool, typer.Option("--without-salutes", help="Hear gestures that no salute announces.")
    ] = False,
    water: WaterOption = "auto",
    estimator: EstimatorOption = "onnx",
    hands: HandsOption = MEDIAPIPE_HANDS,
    ros2: Annotated[
        bool,
        typer.Option(
            "--ros2",
            help="Also publish to ROS 2, which takes --ros-args; needs the packages in ros2/.",
        ),
    ] = False,
    publish: Annotated[
        Network | None,
        typer.Option(help="Also tell ROS 2 in the network, without ROS 2 on this machine."),
    ] = None,
    profile_stages: Annotated[
        bool,
        typer.Option("--profile-stages", help="Measure what each stage costs, and tell that only."),
    ] = False,
) -> None:
    """Listen for a language and print what happens, one JSON object a line.

    A clip ends by itself, with exit code 1 when nothing was recognised in it; a camera is
    listened to until Ctrl-C or SIGTERM. SIGHUP reads the language file again.
    """
    if context.obj and not ros2:
        raise typer.BadParameter(f"{BEGIN} is for ROS 2: give --ros2 as well", context)
    with ExitStack() as opened:
        spoken = opened.enter_context(WatchedLanguage(language, profile))
        listener = hearing_of(spoken.first, without_salutes=without_salutes)
        frames = opened.enter_context(closing(open_source(source)))
        finder = opened.enter_context(closing(create_estimator(estimator, hands=hands)))
        if not without_salutes and not finds_hands(finder):
            raise EstimatorError(
                f"--hands {hands} finds no hand and so no salute: choose others, or hear gestures "
                "with --without-salutes"
            )
        if profile_stages:
            body = opened.enter_context(closing(create_estimator(estimator, hands=NO_HANDS)))
            profile_until_stopped(frames, body, finder, listener, water)
            return
        heard = [tell]
        observer: Observer | None = None
        if ros2:
            from app.cli.ros2_topics import ros2_topics

            topics = opened.enter_context(ros2_topics(context.obj))
            heard.append(lambda event: topics.hear(event, listener.language))
            observer = topics.look
        if publish:
            heard.append(opened.enter_context(closing(open_publisher(publish))).publish)
        runtime = Runtime(
            frames, finder, listener, water=water, changes=spoken.changes, observer=observer
        )
        with handle_signals(runtime.stop, spoken.reload):
            recognised = told(runtime, heard)
    if not recognised and not frames.live:
        raise typer.Exit(NOTHING_RECOGNISED)


def told(events: Iterable[Event], listeners: Sequence[Callable[[Event], None]]) -> int:
    """Tell every event to all who listen; return how many were recognitions.

    When nobody reads stdout any more the runtime ends, as pipelines do.
    """
    recognised = 0
    try:
        for event in events:
            recognised += isinstance(event, TakeRecognized)
            for listener in listeners:
                listener(event)
    except BrokenPipeError:
        # Python flushes stdout once more at its end, and would complain there.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return recognised


def profile_until_stopped(
    source: Source,
    body: PoseEstimator,
    whole: PoseEstimator,
    listener: Hearing,
    water: WaterCorrection,
) -> None:
    """Tell what the stages cost when the source ends, or somebody stops it."""
    from app.cli.robot_stages import show_stages

    asked: list[bool] = []
    with handle_signals(lambda: asked.append(True), lambda: None):
        show_stages(source, body, whole, listener, water=water, is_over=lambda: bool(asked))


def tell(event: Event) -> None:
    """Write one event to stdout, and for people to stderr, at once."""
    typer.echo(line_of(event))
    if sentence := sentence_of(event):
        people.print(sentence, markup=False, highlight=False, soft_wrap=True)


@contextmanager
def handle_signals(stop: Callable[[], None], reload: Callable[[], None]) -> Iterator[None]:
    """Stop after the frame at hand on SIGINT and SIGTERM, at once on a second; reload on SIGHUP."""
    wanted = {signal.SIGINT: stop, signal.SIGTERM: stop}
    if hasattr(signal, "SIGHUP"):  # Windows has none
        wanted[signal.SIGHUP] = reload

    before = {number: signal.getsignal(number) for number in wanted}

    def handle(number: int, frame: FrameType | None) -> None:
        kind = signal.Signals(number)
        if wanted[kind] is stop:
            signal.signal(kind, before[kind])
        wanted[kind]()

    for number in wanted:
        signal.signal(number, handle)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
