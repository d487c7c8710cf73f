"""How a node is, for /diagnostics: what it counts, and what went wrong lately."""

from __future__ import annotations

from collections.abc import Mapping

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

SILENT_SECONDS = 2.0
"""Without an input message for so long a node warns. Cameras give at least five frames a second;
a network stream that stalls for a key frame recovers within one or two seconds."""


class Health:
    """What happened since the last report.

    Parameters
    ----------
    name
        Of the node, with its namespace.
    awaited
        The topic without which the node is idle, for people.
    steady
        Whether messages come all the time, so that silence is a fault.

    Attributes
    ----------
    inputs
        Count of messages taken from it since the start.

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
        """Expect messages from now on (seconds of a steady clock), or, with None, no longer."""
        self._listening_since = now

    def count(self, now: float) -> None:
        """Count an input message that came at `now` seconds of a steady clock."""
        self.inputs += 1
        self._last = now

    def problem(self, what: str) -> None:
        """Report something that went wrong, in one line, with the next report."""
        self._problems += 1
        self._problem = what

    def report(self, now: float, seconds: float, facts: Mapping[str, str]) -> DiagnosticArray:
        """Return what to publish, and begin to count anew; the caller stamps it.

        Parameters
        ----------
        now
            Seconds of the steady clock.
        seconds
            Since the report before.
        facts
            What else there is to know.

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
