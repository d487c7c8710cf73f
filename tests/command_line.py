"""The command line run inside the test's own process."""

from dataclasses import dataclass
from pathlib import Path

import pytest

from app.cli.application import main


@dataclass(frozen=True)
class Outcome:
    """How a run of the command ended."""

    code: int
    out: str
    error: str


class OsgStudio:
    """Runs `osg-studio` in this process, which spares loading everything for each test."""

    def __init__(self, capsys: pytest.CaptureFixture[str]) -> None:
        self._capsys = capsys

    def __call__(self, *arguments: str | int | Path) -> Outcome:
        with pytest.raises(SystemExit) as ended:
            main([str(argument) for argument in arguments])
        captured = self._capsys.readouterr()
        code = ended.value.code
        return Outcome(code if isinstance(code, int) else 0, captured.out, captured.err)
