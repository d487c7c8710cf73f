"""Figures: what was measured, in numbers, the file that keeps them, and the pages that quote them.

A *measurement* is a part of the bench that runs by itself, such as ``comparison/digits``; each of
its *figures* has a name, such as ``full/same``. `benchmarks/results.json` keeps them. A page quotes
a figure between two comments, which are invisible where the page is shown:

    <!--= comparison/digits full/same-->99.5 % (99-100)<!--/-->
    <!--table nearest-->...<!--/-->

`python -m benchmarks` writes what stands between them.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass, field, replace
from hashlib import sha256
from pathlib import Path
from statistics import fmean, median, stdev
from typing import Any, Literal

from app.evaluation.share import Share

Unit = Literal["%", "points", "ratio", ""]

ROOT = Path(__file__).parent.parent
RESULTS = ROOT / "benchmarks" / "results.json"

PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
"""Pages that may quote figures."""

FINDING = tuple(
    f"app/recognition/{each}" for each in ("estimation", "models", "poses", "recording")
)
"""Folders that find keypoints in pictures, with the models."""

FOLDERS = ("app", "app/recognition", *FINDING, "app/robot", "benchmarks")
"""Folders of which a measurement may say that it measures them."""

OLD = "†"
"""Mark of a figure that was measured before the last change of what it measures."""

_QUOTED = re.compile(r"<!--(=|table) ([^>]+?)-->(.*?)<!--/-->", re.DOTALL)


class FigureError(ValueError):
    """A page quotes a figure or table that was not measured."""


@dataclass(frozen=True)
class Figure:
    """One measured number.

    Attributes
    ----------
    name
        Within its measurement.
    value
        A share in [0, 1], a ratio of two things in one run, or a plain number.
    n
        Number of takes, pictures, runs or whatever was counted.
    interval
        95 % interval of the value, or its range over runs; None: there is none.
    unit
        ``%``: a share; ``points``: a difference of shares in per cent; ``ratio``; or empty, a plain
        number.

    """

    name: str
    value: float
    n: int
    interval: tuple[float, float] | None = None
    unit: Unit = "%"


def share(name: str, hits: int, n: int) -> Figure:
    """Return a share with Wilson's 95 % interval (Wilson 1927); of none the share is 0."""
    found = Share(hits, n)
    return Figure(name, found.value or 0.0, n, found.interval())


def ratio(name: str, values: Sequence[float]) -> Figure:
    """Return the median of the ratios of several runs, with their range; one run has none."""
    interval = (min(values), max(values)) if len(values) > 1 else None
    return Figure(name, median(values), len(values), interval, "ratio")


def mean(name: str, values: Sequence[float], unit: Unit = "") -> Figure:
    """Return the mean of independent values, with its 95 % interval by the normal distribution."""
    middle = fmean(values)
    half = 1.96 * stdev(values) / len(values) ** 0.5 if len(values) > 1 else 0.0
    return Figure(name, middle, len(values), (middle - half, middle + half), unit)


@dataclass(frozen=True)
class Measurement:
    """A part of the bench that runs by itself.

    Attributes
    ----------
    name
        Topic and part, such as ``comparison/digits``.
    run
        Measures; its argument says whether quickly, with fewer draws and wider intervals.
    data
        What is measured: the name of a set, or what is simulated.
    protocol
        How, in one sentence.
    people
        Number of people in the data; None: not known, or nobody.
    reads
        Files and folders; without one of them the measurement is left out.
    measures
        Folders of the repository whose change makes the figures old, of `FOLDERS`.
    alone
        Whether nothing may run beside it: it measures time.

    """

    name: str
    run: Callable[[bool], Iterable[Figure]]
    data: str
    protocol: str
    people: int | None = None
    reads: tuple[Path, ...] = ()
    measures: tuple[str, ...] = ("app/recognition",)
    alone: bool = False

    def missing(self) -> list[str]:
        """Return what it needs and is not there."""
        return [str(each) for each in self.reads if not each.exists()]

    def hash_data(self) -> str | None:
        """Return SHA-256 over the files that it reads; None where it reads none."""
        if not self.reads:
            return None
        files = [
            file
            for each in self.reads
            for file in ([each] if each.is_file() else sorted(each.rglob("*")))
            if file.is_file()
        ]
        digests = b"".join(sha256(file.read_bytes()).digest() for file in files)
        return sha256(digests).hexdigest()


@dataclass(frozen=True)
class Measured:
    """A measurement that was made.

    Attributes
    ----------
    data, protocol, people
        Of the `Measurement`.
    command
        What makes it again.
    commit
        At which it was made.
    trees
        Git's hash of each folder that it measures.
    seconds
        How long it took.
    data_hash
        SHA-256 over the files that it read.
    figures
        By name.

    """

    data: str
    protocol: str
    people: int | None
    command: str
    commit: str
    trees: dict[str, str]
    seconds: float
    data_hash: str | None
    figures: dict[str, Figure] = field(default_factory=dict)

    def beside(self, others: Measured | None) -> Measured:
        """Return these figures after those of another run with the same draws."""
        return replace(self, figures={**(others.figures if others else {}), **self.figures})

    def to_dict(self) -> dict[str, Any]:
        """Convert to plain JSON types, four digits a value."""
        figures = {
            name: {
                "value": float(f"{each.value:.4g}"),
                "n": each.n,
                "interval": each.interval and [float(f"{end:.4g}") for end in each.interval],
                "unit": each.unit,
            }
            for name, each in self.figures.items()
        }
        return {**asdict(self), "figures": figures}

    @classmethod
    def from_dict(cls, content: dict[str, Any]) -> Measured:
        """Read what `to_dict` wrote."""
        figures = {
            name: Figure(
                name,
                each["value"],
                each["n"],
                each["interval"] and (each["interval"][0], each["interval"][1]),
                each["unit"],
            )
            for name, each in content["figures"].items()
        }
        return cls(**{**content, "figures": figures})


@dataclass(frozen=True)
class Results:
    """Measurements by name, and today's hashes of the folders that they measure.

    Attributes
    ----------
    measured
        By name.
    trees
        Git's hash of each folder as it is now; empty: nothing is marked as old.

    """

    measured: dict[str, Measured]
    trees: dict[str, str] = field(default_factory=dict)

    def names(self, topic: str) -> list[str]:
        """Return the parts of a topic that were measured, in their order."""
        start = f"{topic}/"
        return [name.removeprefix(start) for name in self.measured if name.startswith(start)]

    def find(self, measurement: str, figure: str) -> Figure:
        """Return a figure.

        Raises
        ------
        FigureError
            If nobody measured it.

        """
        try:
            return self.measured[measurement].figures[figure]
        except KeyError:
            raise FigureError(f"nobody measured {measurement} {figure}") from None

    def is_old(self, measurement: str) -> bool:
        """Return whether a folder that it measures has changed since."""
        then = self.measured[measurement].trees
        return any(self.trees.get(folder, tree) != tree for folder, tree in then.items())

    def old(self) -> list[str]:
        """Return the measurements that are old."""
        return [name for name in self.measured if self.is_old(name)]

    def show(self, measurement: str, figure: str, style: str = "") -> str:
        """Return a figure as text; a figure that does not exist as ``-``, where `style` allows.

        Parameters
        ----------
        measurement, figure
            Names.
        style
            Empty: value, unit and interval. ``cell``: without the sign of per cent. ``bare``: the
            value alone. ``whole``: rounded to a whole number. ``n``: what was counted. ``hits``:
            how many of these. A trailing ``?`` gives ``-`` for what was not measured.

        """
        if style.endswith("?"):
            if figure not in getattr(self.measured.get(measurement), "figures", {}):
                return "-"
            style = style[:-1]
        found = self.find(measurement, figure)
        counted = style in ("n", "hits")
        return _format(found, style) + (OLD if not counted and self.is_old(measurement) else "")


_FORMATS: dict[Unit, str] = {"%": "{:.1%}", "points": "{:+.1f}", "ratio": "{:.2f}", "": "{:.3g}"}


def _format(found: Figure, style: str) -> str:
    if style == "n":
        return f"{found.n:,}"
    if style == "hits":
        return f"{found.value * found.n:.0f}"
    if style == "whole":
        return f"{found.value:.0%}"[:-1] if found.unit == "%" else f"{found.value:.0f}"
    form = "{:.0f}" if found.unit == "" and abs(found.value) >= 10 else _FORMATS[found.unit]
    value = form.format(found.value)
    sign = " %" if found.unit == "%" and style == "" else ""
    text = value.rstrip("%") + sign
    if style == "bare" or found.interval is None:
        return text
    # Whole numbers around a narrow share could leave it outside.
    wide = found.interval[1] - found.interval[0] >= 0.02
    ends = form.replace(".1%", ".0%") if wide else form
    low, high = (ends.format(end).rstrip("%") for end in found.interval)
    signed = found.unit == "points" or found.interval[0] < 0
    return f"{text} ({low}{' to ' if signed else '-'}{high})"


Table = Callable[[Results], str]


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table in Markdown.

    Raises
    ------
    FigureError
        Without a row.

    """
    lines = [head, ["---"] * len(head), *rows]
    if len(lines) == 2:
        raise FigureError(f"nobody measured a row of the table {' | '.join(head)}")
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def fill(text: str, results: Results, tables: dict[str, Table]) -> str:
    """Write the figures and tables that a page quotes.

    Raises
    ------
    FigureError
        If one of them was not measured, or is no table.

    """

    def write(match: re.Match[str]) -> str:
        kind, name = match[1], match[2]
        if kind == "=":
            inside = results.show(*name.split(" ", 2))
        elif name in tables:
            inside = f"\n\n{tables[name](results)}\n\n"
        else:
            raise FigureError(f"no table is called {name}")
        return f"<!--{kind} {name}-->{inside}<!--/-->"

    return _QUOTED.sub(write, text)


def read_results(path: Path = RESULTS, trees: dict[str, str] | None = None) -> Results:
    """Read the file of results; without a file there are none.

    Raises
    ------
    FigureError
        If the file is damaged.

    """
    if not path.is_file():
        return Results({}, trees or {})
    try:
        content = json.loads(path.read_text("utf-8"))["measurements"]
        measured = {name: Measured.from_dict(each) for name, each in content.items()}
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise FigureError(
            f"{path} is damaged ({type(error).__name__}: {error}); nothing was changed. "
            f"Bring it back: git checkout -- {path}"
        ) from error
    return Results(measured, trees or {})
