"""Command ``osg-studio robot``: recognises a language live and prints events as JSON lines.

Packages that only some options need are imported when the option is given.
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager
from functools import partial
from pathlib import Path
from types import FrameType
from typing import Annotated

import typer

from app.cli.estimator_options import EstimatorOption, HandsOption, WaterOption
from app.cli.robots.events import describe_event
from app.cli.robots.ros_arguments import BEGIN
from app.cli.robots.supervision import report_event
from app.cli.terminal import people
from app.recognition.errors import EstimatorError, PublishError
from app.recognition.estimation import create_estimator
from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.factory import MEDIAPIPE_HANDS, NO_HANDS
from app.recognition.estimation.water import WaterCorrection
from app.recognition.gestures.profile import PROFILES
from app.robot import (
    Event,
    LandmarkListener,
    Runtime,
    Source,
    TakeRecognized,
    create_listener,
    open_source,
)
from app.robot.event_messages import format_line
from app.robot.language_watcher import LanguageWatcher
from app.robot.publishing.publisher import Network, Publisher, open_publisher
from app.robot.runtime import Observer
from app.robot.sources.cameras import SCHEMES
from app.system.service_manager import ServiceManager

NOTHING_RECOGNISED = 1
"""Exit code of a recording in which no gesture was recognised."""


def robot(
    context: typer.Context,
    language: Annotated[Path, typer.Option(help="Language file; read again when it changes.")],
    source: Annotated[
        str,
        typer.Option(
            help="Camera number or device; address of a stream "
            f"({', '.join(f'{scheme}://' for scheme in SCHEMES)}); .sdp file; clip, BAG or "
            "BAG@/TOPIC."
        ),
    ] = "0",
    profile: Annotated[
        str | None,
        typer.Option(help=f"Set of voters, {' or '.join(PROFILES)}; by default the language's."),
    ] = None,
    without_salutes: Annotated[
        bool, typer.Option("--without-salutes", help="Recognise gestures without triggers.")
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
        typer.Option(help="Also publish to ROS 2 in the network, without ROS 2 on this machine."),
    ] = None,
    mavlink: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            help="Also give confirmed commands to a vehicle, at udpout:HOST:PORT, "
            "udpin:HOST:PORT, tcp:HOST:PORT or mavlink2rest's http://HOST/PATH; needs --vehicle.",
        ),
    ] = None,
    vehicle: Annotated[
        Path | None,
        typer.Option(help="Vehicle table for --mavlink: what gestures mean, in TOML or JSON."),
    ] = None,
    page: Annotated[
        str | None,
        typer.Option(
            metavar="[HOST:]PORT",
            help="Also serve a page with the robot's state; on this machine alone without HOST.",
        ),
    ] = None,
    profile_stages: Annotated[
        bool,
        typer.Option("--profile-stages", help="Print only the time and energy of each stage."),
    ] = False,
) -> None:
    """Recognise a language live and print events, one JSON object a line.

    A clip ends by itself, with exit code 1 when nothing was recognised in it; a camera runs until
    Ctrl-C or SIGTERM. SIGHUP reads the language file again.
    """
    if context.obj and not ros2:
        raise typer.BadParameter(f"{BEGIN} needs --ros2: add that option", context)
    if (mavlink is None) != (vehicle is None):
        raise typer.BadParameter("--mavlink and --vehicle need each other: give both", context)
    with ExitStack() as opened:
        watcher = opened.enter_context(LanguageWatcher(language, profile))
        sees_hands = hands != NO_HANDS
        if watcher.first.trigger.kind == "salute" and not (without_salutes or sees_hands):
            raise EstimatorError(
                f"--hands {hands} finds no hand and so no salute: choose other hands, give the "
                "language another trigger, or add --without-salutes"
            )
        listener = create_listener(watcher.first, without_salutes=without_salutes, hands=sees_hands)
        frames = opened.enter_context(closing(open_source(source)))
        finder = opened.enter_context(closing(create_estimator(estimator, hands=hands)))
        if profile_stages:
            body = opened.enter_context(closing(create_estimator(estimator, hands=NO_HANDS)))
            profile_until_stopped(frames, body, finder, listener, water)
            return
        report = partial(report_event, ServiceManager())
        handlers: list[Callable[[Event], None]] = [print_event, report]
        observer: Observer | None = None
        if ros2:
            from app.cli.robots.ros2_topics import open_ros2_topics

            topics = opened.enter_context(open_ros2_topics(context.obj))
            handlers.append(lambda event: topics.publish_event(event, listener.language))
            observer = topics.publish_frame
        if publish:
            handlers.append(opened.enter_context(closing(open_publisher(publish))).publish)
        if page:
            handlers.append(opened.enter_context(closing(open_page(page))).publish)
        if mavlink and vehicle:
            from app.cli.robots.vehicle import open_bridge

            bridge = open_bridge(mavlink, vehicle, listener, frames)
            handlers.append(opened.enter_context(closing(bridge)).publish)
        runtime = Runtime(
            frames, finder, listener, water=water, changes=watcher.next_change, observer=observer
        )
        with handle_signals(runtime.stop, watcher.reload):
            recognised = emit_all(runtime, handlers)
    if not recognised and not frames.live:
        raise typer.Exit(NOTHING_RECOGNISED)


def open_page(address: str) -> Publisher:
    """Serve the status page at ``[HOST:]PORT``.

    Raises
    ------
    PublishError
        When the text is no address, or the address cannot be listened on.

    """
    from app.robot.publishing.status_page import StatusPage

    host, _, port = address.rpartition(":")
    if not port.isdecimal():
        raise PublishError(f"{address!r} is no place for the page; give PORT or HOST:PORT")
    return StatusPage(host.strip("[]") or "127.0.0.1", int(port), describe_event)


def emit_all(events: Iterable[Event], handlers: Sequence[Callable[[Event], None]]) -> int:
    """Pass every event to all handlers; return the number of recognised takes.

    It ends early when the reader of stdout has closed the pipe.
    """
    recognised = 0
    try:
        for event in events:
            recognised += isinstance(event, TakeRecognized)
            for handler in handlers:
                handler(event)
    except BrokenPipeError:
        # Python flushes stdout at exit, which would raise the error again.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return recognised


def profile_until_stopped(
    source: Source,
    body: PoseEstimator,
    whole: PoseEstimator,
    listener: LandmarkListener,
    water: WaterCorrection,
) -> None:
    """Print the costs of the stages when the source ends or a signal stops it."""
    from app.cli.robots.stages import show_stages

    stops: list[bool] = []
    with handle_signals(lambda: stops.append(True), lambda: None):
        show_stages(source, body, whole, listener, water=water, is_over=lambda: bool(stops))


def print_event(event: Event) -> None:
    """Print one event as JSON on stdout and in words on stderr."""
    typer.echo(format_line(event))
    if sentence := describe_event(event):
        people.print(sentence, markup=False, highlight=False, soft_wrap=True)


@contextmanager
def handle_signals(stop: Callable[[], None], reload: Callable[[], None]) -> Iterator[None]:
    """Stop after the current frame on SIGINT and SIGTERM, at once on a second; reload on SIGHUP."""
    actions = {signal.SIGINT: stop, signal.SIGTERM: stop}
    if hasattr(signal, "SIGHUP"):  # not on Windows
        actions[signal.SIGHUP] = reload

    before = {number: signal.getsignal(number) for number in actions}

    def handle(number: int, frame: FrameType | None) -> None:
        kind = signal.Signals(number)
        if actions[kind] is stop:
            signal.signal(kind, before[kind])
        actions[kind]()

    for number in actions:
        signal.signal(number, handle)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
