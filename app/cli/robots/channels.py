"""Channels of the robot's events: stdout, stderr in words, ROS 2 topics, and the publishers."""

from __future__ import annotations

import errno
import os
import select
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, suppress
from typing import Final, Literal, Protocol, TextIO

from app.recognition.errors import OsgError
from app.recognition.poses.frame import FrameLandmarks
from app.recognition.text.wording import ask_twins
from app.robot import ActiveLanguage, Frame, events
from app.robot.commands.replies import Reply
from app.robot.event_messages import format_line

Handler = Callable[[events.Event], None]
"""Called with every event."""

STALL_SECONDS: Final = 1.0
"""Longest wait for a reader of stdout or stderr while a vehicle is commanded: an emergency must not
wait for a pager that was left open."""

PIECE: Final = 1000
"""Characters written at once: in UTF-8 they fit into a pipe of which `select` says that it takes
something, which is 4096 bytes on Linux."""


class Channels:
    """Passes every event to stdout as JSON, to stderr in words, and to the handlers.

    A stream that cannot be written, such as a log on a full disk, is given up: the other channels
    say so once, and everything else goes on.

    Parameters
    ----------
    ends_with_reader
        Whether a reader of stdout that closes the pipe ends the robot, by `BrokenPipeError`, and
        one that reads nothing makes it wait. Otherwise both are given up.

    Attributes
    ----------
    failed
        Whether a stream was given up.
    vehicle
        Handler that commands a vehicle; it gets no reports about the vehicle. None: there is none.

    """

    def __init__(self, *, ends_with_reader: bool) -> None:
        self._ends_with_reader = ends_with_reader
        self._streams: list[Stream] = [
            Stream("stdout", sys.stdout, format_line, waits=ends_with_reader),
            Stream("stderr", sys.stderr, describe_event, waits=ends_with_reader),
        ]
        self._handlers: list[Handler] = []
        self.vehicle: Handler | None = None
        self._lock = threading.RLock()
        self._time = 0.0
        self.failed = False

    def add(self, handler: Handler) -> None:
        """Add a handler for as long as the process runs."""
        self._handlers.append(handler)

    @contextmanager
    def joined_by(self, handlers: Sequence[Handler]) -> Iterator[None]:
        """Pass events to further handlers, and to a vehicle, for one run."""
        kept = list(self._handlers)
        self._handlers += handlers
        try:
            yield
        finally:
            self._handlers, self.vehicle = kept, None

    def emit(self, event: events.Event) -> None:
        """Pass an event to all channels; any thread may call this.

        Raises
        ------
        BrokenPipeError
            When the reader of stdout has closed the pipe and the robot ends with it.

        """
        waiting = [event]
        while waiting:
            current = waiting.pop(0)
            with self._lock:
                self._time = current.time
                waiting += self._write(current)
                for handler in self._handlers:
                    handler(current)
            # Outside the lock: the vehicle's own thread reports through `emit`.
            is_report = isinstance(current, events.VehicleReported | events.AnswerGiven)
            if self.vehicle is not None and not is_report:
                self.vehicle(current)

    def report_vehicle(self, text: str) -> None:
        """Pass a line about the vehicle to all channels."""
        self.emit(events.VehicleReported(self._time, text))

    def report_reply(self, reply: Reply, pulses: int, text: str) -> None:
        """Pass a reply to the diver to all channels."""
        self.emit(events.AnswerGiven(self._time, reply, pulses, text))

    def _write(self, event: events.Event) -> list[events.OutputFailed]:
        """Write an event to the streams; return the failures."""
        failures = []
        for stream in list(self._streams):
            try:
                stream.write(event)
            except OSError as error:
                stream.give_up()
                if (
                    self._ends_with_reader
                    and isinstance(error, BrokenPipeError)
                    and stream.name == "stdout"
                ):
                    raise
                self._streams.remove(stream)
                self.failed = True
                reason = error.strerror or str(error)
                failures.append(events.OutputFailed(event.time, stream.name, reason))
        return failures


class Stream:
    """One standard stream.

    Parameters
    ----------
    name
        Its name.
    file
        The stream; None if the process was started without it.
    format_event
        Formats an event as a line; empty for events that it leaves out.
    waits
        Whether writing waits for a reader that reads nothing, for as long as it takes.

    """

    def __init__(
        self,
        name: Literal["stdout", "stderr"],
        file: TextIO | None,
        format_event: Callable[[events.Event], str],
        *,
        waits: bool,
    ) -> None:
        self.name: Literal["stdout", "stderr"] = name
        self._file = file
        self._format = format_event
        self._waits = waits or os.name != "posix"  # Windows tells of sockets alone

    def write(self, event: events.Event) -> None:
        """Write an event; raises `OSError` when that fails, or nobody reads."""
        if self._file is None or not (line := self._format(event)):
            return
        line += "\n"
        size = len(line) if self._waits else PIECE
        for start in range(0, len(line), size):
            if not self._waits:
                self._wait_for_reader(self._file)
            self._file.write(line[start : start + size])
            self._file.flush()

    @staticmethod
    def _wait_for_reader(file: TextIO) -> None:
        """Wait until a stream takes something; raises `TimeoutError` when it does not."""
        try:
            number = file.fileno()
        except OSError:  # a stream of another program that runs this one has no descriptor
            return
        if not select.select([], [number], [], STALL_SECONDS)[1]:
            raise TimeoutError(errno.ETIMEDOUT, "nobody reads it")

    def give_up(self) -> None:
        """Drop what was not written: Python would write it at exit, and fail again."""
        if self._file is None:
            return
        null = os.open(os.devnull, os.O_WRONLY)
        with suppress(OSError):  # a stream of another program that runs this one has no descriptor
            os.dup2(null, self._file.fileno())
        os.close(null)


def describe_event(event: events.Event) -> str:
    """Describe an event in one sentence; empty for events that need none."""
    if isinstance(event, events.TakeEvent):
        return _describe_take(event)
    if isinstance(event, events.PhraseHeard):
        return event.phrase.text
    if isinstance(event, events.VehicleReported):
        return f"vehicle: {event.text}"
    if isinstance(event, events.OutputFailed):
        return f"{event.output} is not written any more: {event.reason}; recognition goes on"
    return _describe_state(event)


def _describe_take(event: events.TakeEvent) -> str:
    span = f"{event.start:.2f} - {event.end:.2f} s"
    if isinstance(event, events.TakeRecognized):
        return f"{span}: {event.label} ({event.confidence:.2f})"
    if event.pair is not None:
        return f"{span}: {event.reason}"
    return f"{span}: rejected, {event.reason}"


def _describe_state(event: events.Event) -> str:
    match event:
        case events.LanguageRefused(revision=kept, reason=reason):
            return f"the new language file is not used, revision {kept} is kept: {reason}"
        case events.LanguageChanged():
            return (
                f"listening for {event.name!r}, revision {event.revision}, code {event.code}: "
                f"{', '.join(event.gestures)} (profile {event.profile}, {event.tuning})"
                + "".join(f". {ask_twins(twins)}" for twins in event.undecided_twins)
            )
        case events.SourceOpened(source=source, frame_size=(width, height)):
            return f"watching {source}, {width} x {height} pixels"
        case events.SourceWarned(reason=reason):
            return reason
        case events.SourceLost(reason=reason):
            return f"source lost: {reason}; it is opened again and again"
        case events.SourceRestored(missing=missing):
            return f"source restored after {missing:.1f} s"
        case events.RecognitionReady(time=time):
            return f"ready for gestures, {time:.1f} s after the source was opened"
        case events.FrameRateChanged():
            return event.words
        case events.FramesDropped(seconds=seconds, dropped=dropped, frames=frames):
            return f"{dropped} of {dropped + frames} frames dropped in {seconds:.0f} s"
        case _:
            return ""


class Topics(Protocol):
    """Protocol of the node that publishes the robot's landmarks and events."""

    def publish_frame(self, frame: Frame, found: FrameLandmarks) -> None:
        """Publish the landmarks of a frame."""

    def publish_event(self, event: events.Event, language: ActiveLanguage) -> None:
        """Publish an event of the active language."""


def open_ros2_topics(arguments: Sequence[str]) -> AbstractContextManager[Topics]:
    """Return a context manager that runs a ROS 2 node and gives its topics.

    Parameters
    ----------
    arguments
        ROS 2's arguments, from ``--ros-args`` on: remapped names, parameters, log level.

    Raises
    ------
    OsgError
        When ROS 2 or this project's ROS packages are not installed.

    """
    try:
        from osg_ros.nodes.robot_node import run_robot_node
    except ModuleNotFoundError as error:
        raise OsgError(
            f"--ros2 needs ROS 2 and the packages of the folder ros2/; {error.name} is missing: "
            "build them with colcon and source the workspace in this shell"
        ) from error
    return run_robot_node(arguments)
