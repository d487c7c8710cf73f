"""Command ``osg-studio robot``: recognises a language live and prints events as JSON lines.

Packages that only some options need are imported when the option is given.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack, closing
from functools import partial
from typing import TYPE_CHECKING, Final

import typer

from app.cli.clip_argument import takes_options
from app.cli.robots.channels import Channels, describe_event
from app.cli.robots.robot_options import RobotOptions
from app.cli.robots.run import (
    Control,
    handle_signals,
    run_robot,
    run_with_uploads,
    try_answers,
)
from app.recognition.errors import PublishError, explain_missing_package
from app.robot import Event, SourceEnded, SourceOpened
from app.system.service_manager import ServiceManager

if TYPE_CHECKING:
    from app.robot.publishing.robot_files import RobotFiles
    from app.robot.publishing.status_page import StatusPage

STAGES_BENCHMARK = "python -m benchmarks.cost.stages"

NOTHING_RECOGNISED = 1
"""Exit code of a recording in which no gesture was recognised."""

LOG_LOST = 4
"""Exit code of a robot that went on though stdout or stderr could not be written."""


@takes_options("options", RobotOptions)
def robot(context: typer.Context, *, options: RobotOptions) -> None:
    """Recognise a language live and print events, one JSON object a line.

    A clip ends by itself, with exit code 1 when nothing was recognised in it; a camera runs until
    Ctrl-C or SIGTERM. SIGHUP reads the language file again.
    """
    has_mavlink, has_vehicle = options.mavlink is not None, options.vehicle is not None
    lacking = {
        f"{BEGIN} needs --ros2: add that option": bool(context.obj) and not options.ros2,
        "--mavlink and --vehicle need each other: give both": has_mavlink != has_vehicle,
        f"--profile-stages is a benchmark since 0.4.0: run {STAGES_BENCHMARK} in a clone": (
            options.profile_stages
        ),
        "--upload needs --page: give both": options.upload and not options.page,
        "--answers needs --mavlink and --vehicle: give all three": bool(options.answers)
        and not has_mavlink,
    }
    for fault in (words for words, lacks in lacking.items() if lacks):
        raise typer.BadParameter(fault, context)
    if options.answers:
        try_answers(options)
        return
    channels = Channels(ends_with_reader=not has_mavlink)
    channels.add(partial(report_event, ServiceManager()))
    control = Control()
    run = partial(run_robot, options, channels, control, context.obj or ())
    with ExitStack() as opened:
        # First in, last out: a signal ends the robot in order while all opens or closes too.
        opened.enter_context(handle_signals(control.stop, control.reload))
        if options.page:
            files = open_files(options, control) if options.upload else None
            shown = opened.enter_context(closing(open_page(options.page, files)))
            channels.add(shown.publish)
            if options.upload:
                recognised = run_with_uploads(run, control, shown)
        if not options.upload:
            recognised = run()
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
