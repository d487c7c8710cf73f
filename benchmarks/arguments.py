"""Arguments that the benchmarks on recorded sets share."""

from __future__ import annotations

import argparse
from pathlib import Path


def set_arguments(description: str | None, *, draws: int, queries: int) -> argparse.ArgumentParser:
    """Return a parser for the folder, the sets, and the numbers of languages and queries to draw.

    Parameters
    ----------
    description
        The benchmark's docstring, of which the first line is shown.
    draws, queries
        The defaults.

    """
    parser = argparse.ArgumentParser(description=(description or "").partition("\n")[0])
    parser.add_argument("data", type=Path, help="the folder that holds trajectories/")
    parser.add_argument("--sets", nargs="+", help="names of sets; default: all")
    parser.add_argument("--draws", type=int, default=draws, help="languages per set")
    parser.add_argument(
        "--queries", type=int, default=queries, help="queries per language, of each kind of person"
    )
    parser.add_argument("--seed", type=int, default=1)
    return parser
