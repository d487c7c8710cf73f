"""Command ``osg-studio robot``: recognises a language live and prints events as JSON lines.

Packages that only some options need are imported when the option is given.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack, closing
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final, Literal

import typer

from app.cli.clip_argument import EstimatorOption, HandsOption, TurnOption, WaterOption
from app.cli.robots.channels import Channels, describe_event
from app.cli.robots.run import (
    Control,
    RobotOptions,
    handle_signals,
    profile_until_stopped,
    run_robot,
    run_with_uploads,
    try_answers,
)
from app.recognition.errors import PublishError, explain_missing_package
from app.recognition.estimation.factory import MEDIAPIPE_HANDS
from app.recognition.gestures.profile import PROFILES
from app.robot import Event, SourceEnded, SourceOpened
from app.robot.publishing.publisher import Network
from app.robot.sources.cameras import SCHEMES
from app.system.service_manager import ServiceManager

if TYPE_CHECKING:
    from app.robot.publishing.robot_files import RobotFiles
    from app.robot.publishing.status_page import StatusPage

NOTHING_RECOGNISED = 1
"""Exit code of a recording in which no gesture was recognised."""

LOG_LOST = 4
"""Exit code of a robot that went on though stdout or stderr could not be written."""


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
    turn: TurnOption = 0,
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
    upload: Annotated[
        bool,
        typer.Option(
            "--upload",
            help="The page also takes the language file and the vehicle table; the robot waits for "
            "the language if there is none. Everybody who reaches the page can replace them.",
        ),
    ] = False,
    answers: Annotated[
        Literal["try"] | None,
        typer.Option(
            help="Only show each answer to the diver once, on the vehicle of --mavlink, as the "
            "table of --vehicle says."
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
    lacking = {
        f"{BEGIN} needs --ros2: add that option": bool(context.obj) and not ros2,
        "--mavlink and --vehicle need each other: give both": (mavlink is None)
        != (vehicle is None),
        "--upload needs --page: give both": upload and not page,
        "--answers needs --mavlink and --vehicle: give all three": bool(answers) and not mavlink,
    }
    for fault in (words for words, lacks in lacking.items() if lacks):
        raise typer.BadParameter(fault, context)
    options = RobotOptions(
        language=language,
        source=source,
        turn=turn,
        profile=profile,
        without_salutes=without_salutes,
        water=water,
        estimator=estimator,
        hands=hands,
        ros2=context.obj if ros2 else None,
        publish=publish,
        mavlink=mavlink,
        vehicle=vehicle,
        upload=upload,
    )
    if profile_stages:
        profile_until_stopped(options)
        return
    if answers:
        try_answers(options)
        return
    channels = Channels(ends_with_reader=mavlink is None)
    channels.add(partial(report_event, ServiceManager()))
    control = Control()
    with ExitStack() as opened:
        # First in, last out: a signal ends the robot in order while all opens or closes too.
        opened.enter_context(handle_signals(control.stop, control.reload))
        if page:
            files = open_files(options, control) if upload else None
            shown = opened.enter_context(closing(open_page(page, files)))
            channels.add(shown.publish)
            if upload:
                recognised = run_with_uploads(options, channels, control, shown)
        if not upload:
            recognised = run_robot(options, channels, control)
    if channels.failed:
        raise typer.Exit(LOG_LOST)
    if not recognised:
        raise typer.Exit(NOTHING_RECOGNISED)


def open_files(options: RobotOptions, control: Control) -> RobotFiles:
    """Return the files that the page takes by upload."""
    with explain_missing_package("--upload", "mavlink", PublishError):
        from app.robot.publishing.robot_files import RobotFiles
    return RobotFiles(
        options.language,
        options.vehicle,
        options.profile,
        control.take_file,
        control.find_obstacle,
    )


def open_page(address: str, files: RobotFiles | None = None) -> StatusPage:
    """Serve the status page at ``[HOST:]PORT``; it takes `files` by upload.

    Raises
    ------
    PublishError
        When the text is no address, or the address cannot be listened on.

    """
    from app.robot.publishing.status_page import StatusPage

    host, _, port = address.rpartition(":")
    if not port.isdecimal():
        raise PublishError(f"{address!r} is no place for the page; give PORT or HOST:PORT")
    return StatusPage(host.strip("[]") or "127.0.0.1", int(port), describe_event, files)


BEGIN: Final = "--ros-args"
"""Starts the arguments of ROS 2."""

END: Final = "--"
"""Ends the arguments of ROS 2."""


def split_ros_arguments(arguments: Sequence[str]) -> tuple[list[str], list[str]]:
    """Split arguments into those of the program and those of ROS 2.

    Returns
    -------
    The program's arguments, and ROS 2's including each `BEGIN`; both in order.

    """
    own: list[str] = []
    ros: list[str] = []
    target = own
    for argument in arguments:
        if argument == BEGIN:
            target = ros
        if argument == END and target is ros:
            target = own
        else:
            target.append(argument)
    return own, ros


def report_event(manager: ServiceManager, event: Event) -> None:
    """Report that the robot is ready, works or ends, with a description of its activity.

    A live source gives a heartbeat at least every 5 seconds, so a watchdog of 30 seconds restarts a
    robot that hangs.
    """
    match event:
        case SourceOpened():
            manager.tell_ready()
        case SourceEnded():
            manager.tell_stopping()
    manager.tell_alive()
    if sentence := describe_event(event):
        manager.tell_status(sentence)
