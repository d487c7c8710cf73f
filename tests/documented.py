"""The commands that the documentation's pages tell their reader to run."""

import re
import shlex

from tests.conftest import ROOT

PAGES = sorted((ROOT / "docs").rglob("*.md"))


def documented(*words: str, page: str | None = None) -> list[list[str]]:
    """Return the arguments of the documented `osg-studio` commands, in their order.

    Parameters
    ----------
    words
        First arguments of the commands.
    page
        Page below ``docs``, or None for all of them.

    """
    pages = PAGES if page is None else [ROOT / "docs" / page]
    text = "".join(each.read_text(encoding="utf-8") for each in pages)
    blocks = re.findall(r"```sh\n(.*?)```", text, re.DOTALL)
    lines = [line for block in blocks for line in block.splitlines()]
    commands = [shlex.split(line)[1:] for line in lines if line.startswith("osg-studio ")]
    found = [command for command in commands if command[: len(words)] == list(words)]
    assert found, f"{page or 'docs'} runs no such command: {words}"
    return found
