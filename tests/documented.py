"""What docs/robots.md tells its reader to run."""

import re
import shlex

from tests.conftest import ROOT


def documented(*words: str, below: str | None = None) -> list[list[str]]:
    """Return the arguments of the commands that docs/robots.md runs, in its order.

    Parameters
    ----------
    words
        With which the arguments begin.
    below
        Heading of the section, or None for the whole page.

    """
    text = (ROOT / "docs" / "robots.md").read_text(encoding="utf-8")
    if below is not None:
        level, text = re.split(rf"^(#+) {re.escape(below)}$", text, flags=re.MULTILINE)[1:]
        text = re.split(rf"^#{{1,{len(level)}}} ", text, flags=re.MULTILINE)[0]
    blocks = re.findall(r"```sh\n(.*?)```", text, re.DOTALL)
    lines = [line for block in blocks for line in block.splitlines()]
    commands = [shlex.split(line)[1:] for line in lines if line.startswith("osg-studio ")]
    found = [command for command in commands if command[: len(words)] == list(words)]
    assert found, f"docs/robots.md runs no such command: {words} below {below}"
    return found
