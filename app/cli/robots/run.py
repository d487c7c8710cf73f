"""Run of ``osg-studio robot``: opens everything that the options name, and ends it in order.

Packages that only some options need are imported when the option is given.
"""

from __future__ import annotations

import signal
import time as clock
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager, suppress
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Final

from app.cli.robots.channels import Channels, Handler, open_ros2_topics
from app.cli.robots.robot_options import RobotOptions
from app.cli.terminal import describe_error, tell
from app.recognition.errors import OsgError, VehicleError, explain_missing_package
from app.recognition.estimation.factory import create_estimator
from app.robot import (
    Event,
    LandmarkListener,
    Runtime,
    Source,
    TakeRecognized,
    open_source,
)
from app.robot.active_language import LanguageWatcher
from app.robot.commands.replies import Reply
from app.robot.publishing.publisher import open_publisher
from app.robot.runtime import Observer
from app.robot.sources.live import LiveSource

if TYPE_CHECKING:
    from app.robot.mavlink.bridge import MavlinkBridge
    from app.robot.publishing.status_page import StatusPage

RETRY_SECONDS: Final = 10.0
"""Seconds between two attempts to begin while the page waits for files, or for a source."""

WAIT_STEP: Final = 0.1
"""Seconds after which a waiting robot looks for a signal or an upload."""


class Control:
    """What signals and uploads want of a run.

    Only plain attributes are set, because a signal handler must not wait for a lock.

    Attributes
    ----------
    stopped
        Whether a signal has ended the robot.
    changed
        Whether a file was replaced that a run reads at its start.

    """

    def __init__(self) -> None:
        self.stopped = self.changed = False
        self._runtime: Runtime | None = None
        self._watcher: LanguageWatcher | None = None
        self._bridge: MavlinkBridge | None = None

    def begin(
        self, runtime: Runtime, watcher: LanguageWatcher, bridge: MavlinkBridge | None
    ) -> None:
        """Control a run from now on."""
        self._runtime, self._watcher, self._bridge = runtime, watcher, bridge
        if self.stopped or self.changed:
            runtime.stop()

    def stop(self) -> None:
        """End the robot."""
        self.stopped = True
        if self._runtime is not None:
            self._runtime.stop()

    def reload(self) -> None:
        """Read the language file again."""
        if self._watcher is not None:
            self._watcher.reload()

    def find_obstacle(self, kind: str) -> str:
        """Return why a file must not be replaced now; empty if it may.

        A new vehicle table begins the recognition anew, which would end an emergency.
        """
        if kind == "vehicle" and self._bridge is not None and self._bridge.in_emergency:
            return "an emergency is in progress: send the vehicle table again when it is over"
        return ""

    def take_file(self, kind: str) -> None:
        """Note a replaced file: a running robot reads a new language, and begins a table anew."""
        if self._runtime is None or kind == "vehicle":
            self.changed = True
            if self._runtime is not None:
                self._runtime.stop()

    def wait(self, seconds: float) -> None:
        """Wait until a file is replaced or the robot ends, at most so long."""
        self._runtime = self._watcher = self._bridge = None
        by = clock.monotonic() + seconds
        while not (self.stopped or self.changed) and clock.monotonic() < by:
            clock.sleep(WAIT_STEP)


def run_with_uploads(
    run: Callable[[Callable[[], None]], bool], control: Control, page: StatusPage
) -> bool:
    """Run until the source ends or a signal comes; begin again where an upload asks for it.

    What keeps a run from starting is shown on the page, and tried again.

    Parameters
    ----------
    run
        `run_robot` of some options; its argument is to be called when all is open.
    control, page
        Who stops the run, and where its waiting is shown.

    Returns
    -------
    As `run_robot`.

    """
    told = ""
    while not control.stopped:
        control.changed = False
        try:
            recognised = run(lambda: page.wait_for(""))
        except (OsgError, OSError) as error:
            reason = describe_error(error)
            page.wait_for(reason)
            if reason != told:
                tell(f"waiting: {reason}")
            told = reason
            control.wait(RETRY_SECONDS)
            continue
        # Else an upload ended the run: a file that is read only at its start, as a vehicle table.
        if not control.changed:
            return recognised
        told = ""
    return True  # A signal ended it.


def run_robot(
    options: RobotOptions,
    channels: Channels,
    control: Control,
    ros_arguments: Sequence[str],
    begin: Callable[[], None] = lambda: None,
) -> bool:
    """Open everything, and pass the events to the channels until the source ends.

    Parameters
    ----------
    options, channels, control
        What to run, where to report, and who stops it.
    ros_arguments
        Arguments of ROS 2.
    begin
        Called when all is open.

    Returns
    -------
    False for a recording in which nothing was recognised.

    """
    with ExitStack() as opened:
        watcher = opened.enter_context(LanguageWatcher(options.language, options.profile))
        listener = options.open_listener(watcher.first)
        frames = opened.enter_context(closing(open_source(options.source, options.turn)))
        finder = create_estimator(options.estimator, hands=options.hands)
        opened.enter_context(closing(finder))
        handlers: list[Handler] = []
        observer: Observer | None = None
        if options.ros2:
            topics = opened.enter_context(open_ros2_topics(ros_arguments))
            handlers.append(lambda event: topics.publish_event(event, listener.language))
            observer = topics.publish_frame
        if options.publish:
            publisher = opened.enter_context(closing(open_publisher(options.publish)))
            handlers.append(publisher.publish)
        # The bridge still reports while it closes, so it is closed before the handlers are left.
        opened.enter_context(channels.joined_by(handlers))
        bridge: MavlinkBridge | None = None
        if options.mavlink and (table := options.find_vehicle_table()):
            bridge = open_bridge(
                options, table, listener, frames, channels.report_vehicle, channels.report_reply
            )
            channels.vehicle = opened.enter_context(closing(bridge)).publish
            bridge.start()
        runtime = Runtime(
            frames,
            finder,
            listener,
            water=options.water,
            changes=watcher.next_change,
            observer=observer,
        )
        control.begin(runtime, watcher, bridge)
        begin()
        recognised = emit_all(runtime, channels)
    return bool(recognised) or frames.live


def emit_all(events: Iterable[Event], channels: Channels) -> int:
    """Pass every event to the channels; return the number of recognised takes.

    It ends early when the reader of stdout has closed the pipe.
    """
    recognised = 0
    with suppress(BrokenPipeError):
        for event in events:
            recognised += isinstance(event, TakeRecognized)
            channels.emit(event)
    return recognised


def try_answers(options: RobotOptions) -> None:
    """Show every reply to the diver once, and say which.

    Raises
    ------
    VehicleError
        When the table has no answers, or one could not be shown.

    """
    assert options.vehicle is not None
    from app.robot.mavlink.patterns import NOT_SHOWN
    from app.robot.mavlink.table import read_vehicle_table

    if read_vehicle_table(options.vehicle).answers is None:
        raise VehicleError(f"{options.vehicle} has no [answers]; see docs/robots/mavlink.md")
    missing: list[str] = []

    def note(text: str) -> None:
        tell(text)
        missing.extend([text] if text.startswith(NOT_SHOWN) else [])

    def note_reply(reply: Reply, pulses: int, text: str) -> None:
        note(f"{pulses} {text}")

    stops: list[bool] = []
    with ExitStack() as opened:
        # First in, last out: a signal ends it in order while the bridge opens or closes too.
        opened.enter_context(handle_signals(lambda: stops.append(True), lambda: None))
        watcher = opened.enter_context(LanguageWatcher(options.language, options.profile))
        listener = options.open_listener(watcher.first)
        bridge = open_bridge(options, options.vehicle, listener, None, note, note_reply)
        opened.enter_context(closing(bridge))
        bridge.start()
        for reply in Reply:
            if not stops:
                bridge.reply(reply, f"{reply.value}: {reply.words}")
            while not (bridge.has_replied or stops):
                clock.sleep(WAIT_STEP)
    if missing:
        raise VehicleError(missing[0])


@contextmanager
def handle_signals(stop: Callable[[], None], reload: Callable[[], None]) -> Iterator[None]:
    """Stop in order on SIGINT and SIGTERM, at once on a second; reload on SIGHUP."""
    actions = {signal.SIGINT: stop, signal.SIGTERM: stop}
    if hasattr(signal, "SIGHUP"):  # not on Windows
        actions[signal.SIGHUP] = reload

    before = {number: signal.getsignal(number) for number in actions}

    def handle(number: int, frame: FrameType | None) -> None:
        action = actions[signal.Signals(number)]
        if action is stop:  # the second one may be of the other kind, such as systemd's
            for kind in (signal.SIGINT, signal.SIGTERM):
                signal.signal(kind, before[kind])
        action()

    for number in actions:
        signal.signal(number, handle)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def open_bridge(
    options: RobotOptions,
    table_file: Path,
    listener: LandmarkListener,
    source: Source | None,
    tell: Callable[[str], None],
    tell_reply: Callable[[Reply, int, str], None],
) -> MavlinkBridge:
    """Open the bridge to a vehicle; it talks once it is started.

    Parameters
    ----------
    options
        The vehicle's address, and whether gestures are spotted without triggers.
    table_file
        Vehicle table.
    listener, source
        What recognises gestures, and where its frames come from; None: from nowhere.
    tell, tell_reply
        Called with every line about the vehicle, and with every reply to the diver, its pulses and
        its words; from any thread.

    Raises
    ------
    VehicleError
        When its library is missing, the table is invalid or does not fit the language, or the
        vehicle's address cannot be used.
    OSError
        When the table or its key cannot be read.

    """
    with explain_missing_package("--mavlink", "mavlink", VehicleError):
        from app.robot.mavlink.bridge import MavlinkBridge
        from app.robot.mavlink.links import open_link
        from app.robot.mavlink.table import read_signing_key, read_vehicle_table
    table = read_vehicle_table(table_file)
    language = listener.language.recognizer.language
    found = table.list_faults(language, without_salutes=options.without_salutes)
    if faults := [fault for _, fault in found]:
        raise VehicleError(
            f"{table_file}: {'; '.join(faults)}; correct the table or choose its language "
            f"(this one has {', '.join(language.labels)})"
        )
    key = read_signing_key(table, table_file)
    named = table.vehicle.key_file
    time_file = None if named is None else table_file.parent / f"{named}.time"
    vehicle, address = table.vehicle, options.mavlink or ""
    link = open_link(address, vehicle.system, vehicle.component, key, time_file)
    now = source.now if isinstance(source, LiveSource) else None
    return MavlinkBridge(
        table,
        link,
        lambda: listener.language,
        tell,
        now,
        tell_reply,
        without_salutes=options.without_salutes,
        memory=table_file.with_name(f"{table_file.name}.before"),
    )
