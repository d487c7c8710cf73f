"""Diagnostics of a node: counts input and problems and builds the report for /diagnostics."""

from __future__ import annotations

from collections.abc import Mapping

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

SILENT_SECONDS = 2.0
"""Seconds without input after which a node warns. Cameras give at least five frames a second; a
network stream that waits for a key frame recovers within one or two seconds."""


class Health:
    """Counts since the last report.

    Parameters
    ----------
    name
        Name of the node, with its namespace.
    awaited
        Input topic of the node, for people.
    steady
        Whether messages come all the time, so that silence is a fault.

    Attributes
    ----------
    inputs
        Number of input messages since the start.

    """

    def __init__(self, name: str, awaited: str, *, steady: bool = True) -> None:
        self._name = name
        self._awaited = awaited
        self._steady = steady
        self.inputs = 0
        self._reported = 0
        self._problems = 0
        self._problem = ""
        self._listening_since: float | None = None
        self._last = 0.0

    def listen(self, now: float | None) -> None:
        """Expect messages from `now` on (seconds of a steady clock); None: expect none."""
        self._listening_since = now

    def count(self, now: float) -> None:
        """Count an input message received at `now`, in seconds of a steady clock."""
        self.inputs += 1
        self._last = now

    def problem(self, what: str) -> None:
        """Add a problem, described in one line, to the next report."""
        self._problems += 1
        self._problem = what

    def report(self, now: float, seconds: float, facts: Mapping[str, str]) -> DiagnosticArray:
        """Build the report and reset the counts; the caller sets the stamp.

        Parameters
        ----------
        now
            Seconds of the steady clock.
        seconds
            Seconds since the previous report.
        facts
            Further keys and values.

        """
        rate = (self.inputs - self._reported) / seconds
        level, message = self._level(now)
        values = {
            "messages": str(self.inputs),
            "messages per second": f"{rate:.1f}",
            "problems since the last report": str(self._problems),
            **facts,
        }
        self._reported, self._problems, self._problem = self.inputs, 0, ""
        status = DiagnosticStatus(
            level=level,
            name=self._name,
            message=message,
            hardware_id=self._awaited,
            values=[KeyValue(key=key, value=value) for key, value in values.items()],
        )
        return DiagnosticArray(status=[status])

    def _level(self, now: float) -> tuple[bytes, str]:
        if self._problems:
            return DiagnosticStatus.ERROR, self._problem
        if self._listening_since is None:
            return DiagnosticStatus.OK, "not active"
        silent = now - max(self._listening_since, self._last)
        if self._steady and silent > SILENT_SECONDS:
            return DiagnosticStatus.WARN, f"nothing on {self._awaited} for {silent:.0f} s"
        return DiagnosticStatus.OK, "working"
