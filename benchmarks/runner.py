"""Measure everything that README and `docs/` quote, and write it there.

    python -m benchmarks FOLDER
    python -m benchmarks FOLDER --only comparison/digits forecasts
    python -m benchmarks FOLDER --quick
    python -m benchmarks FOLDER --only comparison --method package.module:Class
    python -m benchmarks --pages

FOLDER holds recordings of other people, which are not part of the project (`docs/bench.md`); what
needs a set that is not there is left out by name. As many processes measure as there are cores;
what measures time runs by itself at the end. A run that was broken off goes on where it was: each
measurement is kept in a journal, which counts for its commit only. The run ends with
`benchmarks/results.json` and the pages that quote it. A quick run, and one with a method of your
own, writes `benchmarks/out/results.json` alone. With a method of your own only this one and profile
`full` are measured; the other columns are those of `benchmarks/results.json`, of the same draws.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, replace
from hashlib import sha256
from importlib import import_module
from itertools import product
from multiprocessing import active_children, get_context
from pathlib import Path
from signal import SIG_IGN, SIGINT, signal
from statistics import fmean
from tempfile import TemporaryDirectory
from time import monotonic
from traceback import format_exception

from app import __version__
from benchmarks.figures import (
    FOLDERS,
    PAGES,
    RESULTS,
    ROOT,
    FigureError,
    Measured,
    Measurement,
    Results,
    Table,
    fill,
    read_results,
)
from benchmarks.methods import find_method

TOPICS = (
    "benchmarks.accuracy.comparison",
    "benchmarks.accuracy.people",
    "benchmarks.accuracy.reliability",
    "benchmarks.accuracy.hand_shapes",
    "benchmarks.accuracy.pictures",
    "benchmarks.accuracy.murky_clips",
    "benchmarks.accuracy.views",
    "benchmarks.accuracy.samples",
    "benchmarks.accuracy.spotting",
    "benchmarks.accuracy.damage",
    "benchmarks.accuracy.landmark_sets",
    "benchmarks.accuracy.published_signs",
    "benchmarks.accuracy.explanations",
    "benchmarks.accuracy.misreadings",
    "benchmarks.simulation.triggers",
    "benchmarks.simulation.variation",
    "benchmarks.cost.speed",
    "benchmarks.cost.clips",
    "benchmarks.cost.robot",
    "benchmarks.cost.uneven",
    "benchmarks.cost.server",
    "benchmarks.cost.crashes",
)
"""Modules with `measurements`, and `TABLES` if pages quote one."""

OUT = ROOT / "benchmarks" / "out"

CODE = ("app", "benchmarks", f":!{RESULTS.relative_to(ROOT).as_posix()}")
"""What has to be in a commit before it is measured."""


class BenchError(Exception):
    """Nothing can be measured, with the reason for a person."""


@dataclass(frozen=True)
class Order:
    """What is to be measured, as a process of its own is told.

    Attributes
    ----------
    folder
        Of recordings; None: only what needs none.
    quick
        Whether with fewer draws.
    methods
        Of others, ``package.module:Class``.
    topics
        Names of the modules.

    """

    folder: Path | None
    quick: bool = False
    methods: tuple[str, ...] = ()
    topics: tuple[str, ...] = TOPICS

    def measurements(self) -> dict[str, Measurement]:
        """Return all measurements by name."""
        folder = self.folder or Path("FOLDER")
        modules = [import_module(each) for each in self.topics]
        found = [each for topic in modules for each in topic.measurements(folder, self.methods)]
        return {each.name: each for each in found}

    def narrow(self, name: str) -> Order:
        """Return an order for the one topic with this measurement: a process imports no other."""
        each_alone = (replace(self, topics=(each,)) for each in self.topics)
        return next(order for order in each_alone if name in order.measurements())


def tables() -> dict[str, Table]:
    """Return the tables of all topics by name."""
    found: dict[str, Table] = {}
    for topic in TOPICS:
        found |= getattr(import_module(topic), "TABLES", {})
    return found


def measure(order: Order, name: str, commit: str, trees: dict[str, str]) -> Measured:
    """Make one measurement."""
    chosen = order.measurements()[name]
    start = monotonic()
    figures = {each.name: each for each in chosen.run(order.quick)}
    return Measured(
        data=chosen.data,
        protocol=chosen.protocol,
        people=chosen.people,
        command=" ".join(
            [
                f"python -m benchmarks{' FOLDER' if chosen.reads else ''} --only {name}",
                *(["--quick"] if order.quick else []),
                *(f"--method {each}" for each in order.methods),
            ]
        ),
        commit=commit,
        trees={folder: trees[folder] for folder in chosen.measures},
        seconds=round(monotonic() - start, 1),
        data_hash=chosen.hash_data(),
        figures=figures,
    )


class Journal:
    """Measurements of one commit that are made already, kept one a line.

    Parameters
    ----------
    path
        The file; one of another commit is set aside beside it.
    commit
        Whose measurements count.

    """

    def __init__(self, path: Path, commit: str) -> None:
        self._path, self.commit = path, commit
        self.measured: dict[str, Measured] = {}
        text = path.read_text("utf-8") if path.is_file() else ""
        for number, line in enumerate(text.splitlines(), 1):
            try:
                content = json.loads(line)
                name, measured = content["name"], Measured.from_dict(content["measured"])
            except (ValueError, KeyError, TypeError, AttributeError):
                print(f"Line {number} of {path} is damaged and is not read.")
                continue
            if measured.commit != commit:
                aside = path.with_name(f"{path.stem}-{measured.commit[:8]}{path.suffix}")
                with aside.open("a", encoding="utf-8") as file:
                    file.write(text)
                path.unlink()
                print(f"{path} is of commit {measured.commit[:8]}: it is kept as {aside.name}.")
                self.measured = {}
                return
            self.measured[name] = measured
        if text and not text.endswith("\n"):
            with path.open("a", encoding="utf-8") as file:
                file.write("\n")

    def keep(self, name: str, measured: Measured) -> None:
        """Write down a measurement, and have it on the disk."""
        self.measured[name] = measured
        self._path.parent.mkdir(parents=True, exist_ok=True)
        with self._path.open("a", encoding="utf-8") as file:
            file.write(json.dumps({"name": name, "measured": measured.to_dict()}) + "\n")
            file.flush()
            os.fsync(file.fileno())


def choose(known: Iterable[Measurement], only: Sequence[str]) -> Iterator[Measurement]:
    """Yield the measurements that are asked for and can be made; name those that cannot.

    Raises
    ------
    BenchError
        If a name in `only` is none of a measurement or topic.

    """
    known = [*known]
    for name in only:
        if not any(_is_part(each.name, name) for each in known):
            topics = ", ".join(dict.fromkeys(each.name.partition("/")[0] for each in known))
            raise BenchError(f"nothing is called {name}. Topics: {topics}")
    for each in known:
        if only and not any(_is_part(each.name, name) for name in only):
            continue
        if missing := each.missing():
            print(f"{each.name} is left out: {', '.join(missing)} is not there.")
        else:
            yield each


def _is_part(name: str, of: str) -> bool:
    return name == of or name.startswith(f"{of.rstrip('/')}/")


def run(
    order: Order,
    chosen: Sequence[Measurement],
    journal: Journal,
    before: Results,
    trees: dict[str, str],
) -> bool:
    """Make the measurements that the journal lacks; return whether all of them succeeded."""
    for each in chosen:
        kept = journal.measured.get(each.name)
        if kept and kept.data_hash != each.hash_data():
            print(f"{each.name} is measured again: the journal has it of other data.")
            del journal.measured[each.name]
    waiting = [each for each in chosen if each.name not in journal.measured]
    if len(waiting) < len(chosen):
        print(f"{len(chosen) - len(waiting)} of {len(chosen)} are in the journal.")
    usual = {name: each.seconds for name, each in before.measured.items()}
    guess = fmean(usual.values()) if usual else 60.0
    left = {each.name: usual.get(each.name, guess) for each in waiting}
    waiting.sort(key=lambda each: -left[each.name])
    succeeded = True
    for alone in (False, True):
        workers = 1 if alone else os.cpu_count() or 1
        with ThreadPoolExecutor(workers) as pool:
            futures = {
                pool.submit(_measure_apart, order.narrow(name), name, journal.commit, trees): name
                for name in (each.name for each in waiting if each.alone is alone)
            }
            try:
                for future in as_completed(futures):
                    name = futures[future]
                    del left[name]
                    if reason := _why_failed(future.exception()):
                        succeeded = False
                        print(f"{name} failed: {reason}", flush=True)
                        continue
                    journal.keep(name, future.result())
                    done = f"{len(chosen) - len(left)} of {len(chosen)}"
                    seconds, minutes = future.result().seconds, sum(left.values()) / workers / 60
                    print(f"{done}: {name}, {seconds:.0f} s; about {minutes:.0f} min left")
            except KeyboardInterrupt:
                pool.shutdown(wait=False, cancel_futures=True)
                for process in active_children():
                    process.terminate()
                raise
    return succeeded


def _measure_apart(order: Order, name: str, commit: str, trees: dict[str, str]) -> Measured:
    """Measure in a process of its own: what it leaves, and its end, change no other."""
    # A Ctrl-C reaches all processes of a terminal: the first one alone ends the others.
    with ProcessPoolExecutor(
        1, get_context("spawn"), initializer=signal, initargs=(SIGINT, SIG_IGN)
    ) as pool:
        return pool.submit(measure, order, name, commit, trees).result()


def _why_failed(error: BaseException | None) -> str:
    if isinstance(error, BrokenProcessPool):
        return "its process was killed, as the system does when memory runs out."
    return "".join(format_exception(error)) if error else ""


def write_results(path: Path, results: Results) -> None:
    """Write the file of results, with the last change of what it measures."""
    measurements = {name: each.to_dict() for name, each in results.measured.items()}
    # Ratios are mostly of times; what reads no data measures this machine.
    steady = {
        name: [
            measured["data_hash"],
            {key: each for key, each in measured["figures"].items() if each["unit"] != "ratio"},
        ]
        for name, measured in measurements.items()
        if measured["data_hash"]
    }
    content = {
        "version": __version__,
        "changed": {
            folder: {"commit": _git("log", "-1", "--format=%H", "--", folder), "tree": tree}
            for folder, tree in results.trees.items()
        },
        "hash": sha256(json.dumps(steady, sort_keys=True).encode()).hexdigest(),
        "measurements": measurements,
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    text = json.dumps(content, indent=1, ensure_ascii=False)
    # A figure is a line, so that a change of one is seen.
    lines = re.sub(r"\{[^{}]*\}", lambda found: " ".join(found[0].split()), text)
    partial = path.with_suffix(".partial")
    partial.write_text(f"{lines}\n", "utf-8")
    partial.replace(path)


def write_pages(results: Results) -> bool:
    """Write the figures and tables into every page that quotes one.

    A page that quotes what nobody measured is named, and stays as it is; then the result is False.
    """
    written, complete = tables(), True
    for page in PAGES:
        text = page.read_text("utf-8")
        try:
            filled = fill(text, results, written)
        except FigureError as error:
            print(f"{page.relative_to(ROOT)} is not written: {error}.")
            complete = False
            continue
        if filled != text:
            page.write_text(filled, "utf-8")
            print(f"{page.relative_to(ROOT)} is written.")
    return complete


def hash_folders() -> dict[str, str]:
    """Return Git's hash of each folder that is measured, as it is in the working tree."""
    with TemporaryDirectory() as folder:
        index = {"GIT_INDEX_FILE": str(Path(folder) / "index")}
        _git("read-tree", "HEAD", **index)
        _git("add", "--all", *CODE, **index)
        _git("rm", "--cached", "--quiet", "--ignore-unmatch", str(RESULTS), **index)
        return {each: _git("write-tree", f"--prefix={each}/", **index) for each in FOLDERS}


def _git(*words: str, **variables: str) -> str:
    environment = {**os.environ, **variables}
    command = ("git", "-c", "safe.directory=*", "-C", str(ROOT), *words)
    try:
        ended = subprocess.run(command, env=environment, check=True, capture_output=True, text=True)
    except (OSError, subprocess.CalledProcessError) as error:
        reason = str(getattr(error, "stderr", error)).strip()
        raise BenchError(f"the bench needs a checkout and git: {reason}") from error
    return ended.stdout.strip()


def print_figures(results: Results, names: Iterable[str]) -> None:
    """Print the figures of measurements."""
    for name in names:
        print(f"\n{name}: {results.measured[name].protocol}")
        for figure in results.measured[name].figures.values():
            print(f"  {figure.name}  {results.show(name, figure.name)}, n {figure.n}")


def main() -> None:
    """Measure, and write results and pages."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("folder", type=Path, nargs="?", help="recordings of other people")
    parser.add_argument("--only", nargs="+", default=[], help="topics or measurements")
    parser.add_argument("--quick", action="store_true", help="fewer draws, wide intervals")
    parser.add_argument(
        "--method", action="append", default=[], help="one of your own, package.module:Class"
    )
    parser.add_argument("--pages", action="store_true", help="measure nothing, write the pages")
    given = parser.parse_args()
    try:
        sys.exit(bench(given))
    except (BenchError, FigureError) as error:
        parser.exit(2, f"{parser.prog}: {error}.\n")
    except KeyboardInterrupt:
        lost = given.quick or given.method
        what = "nothing is kept of it" if lost else "the same command goes on where it was"
        parser.exit(130, f"Broken off; {what}.\n")


def _find_own(name: str) -> None:
    """Find a method that is named on the command line, before anything is measured."""
    try:
        if not callable(find_method(name)):
            raise TypeError("it is no class")
    except Exception as error:
        raise BenchError(
            f"--method {name}, which is module:Class, cannot be loaded: "
            f"{type(error).__name__}: {error}"
        ) from error


def _beside(name: str, mine: Measured, before: Results, quick: bool) -> Measured:
    """Return figures beside those of the others, if these are of the same draws and data."""
    others = before.measured.get(name)
    if quick:
        return mine
    if others is None:
        reason = "nobody measured them"
    elif others.data_hash != mine.data_hash:
        reason = "they were measured on other data"
    elif before.is_old(name):
        reason = "the code has changed since they were measured"
    else:
        return mine.beside(others)
    print(f"{name}: the other methods are left out, {reason}.")
    return mine


def print_own(methods: Sequence[str], names: Sequence[str], results: Results) -> bool:
    """Print methods of one's own beside the others; return whether they have all figures."""
    if results.measured:
        print(f"\n{tables()['nearest'](results)}")
    complete = True
    for name, method in product(names, methods):
        figures = results.measured[name].figures if name in results.measured else {}
        if not any(each.startswith(f"{method.replace(' ', '-')}/") for each in figures):
            print(f"{method} has no figures of {name}.")
            complete = False
    return complete


def find_chosen(given: argparse.Namespace, known: Iterable[Measurement]) -> list[Measurement]:
    """Return the measurements that the command line asks for.

    Raises
    ------
    BenchError
        If there is none, or it is none of methods.

    """
    only = given.only or (["comparison"] if given.method else [])
    chosen = [*choose(known, only)]
    if not chosen:
        raise BenchError(
            "nothing can be measured without these; which sets there are: docs/bench.md"
        )
    if given.method and not all(each.name.startswith("comparison/") for each in chosen):
        raise BenchError("a method of your own is measured by --only comparison, or a set of it")
    return chosen


def bench(given: argparse.Namespace) -> int:
    """Do what the command line says, and return the exit status."""
    trees = hash_folders()
    before = read_results(trees=trees)
    if given.pages:
        return 0 if write_pages(before) else 1
    if given.folder is not None and not given.folder.is_dir():
        raise BenchError(f"{given.folder} is not a folder")
    for name in given.method:
        _find_own(name)
    order = Order(given.folder, given.quick, tuple(given.method))
    known = order.measurements()
    chosen = find_chosen(given, known.values())
    kept = not given.quick and not given.method
    if kept and _git("status", "--porcelain", "--", *CODE):
        raise BenchError("app or benchmarks has changes that are in no commit: commit them first")
    if not kept:
        (OUT / "trial.jsonl").unlink(missing_ok=True)
    journal = Journal(OUT / ("journal.jsonl" if kept else "trial.jsonl"), _git("rev-parse", "HEAD"))
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    succeeded = run(order, chosen, journal, before, trees)
    made = {name: journal.measured[name] for name in known if name in journal.measured}
    print_figures(Results(made, trees), [each.name for each in chosen if each.name in made])
    if given.method:
        made = {name: _beside(name, each, before, given.quick) for name, each in made.items()}
        succeeded &= print_own(given.method, [each.name for each in chosen], Results(made, trees))
    everything = {**before.measured, **made}
    results = Results({name: everything[name] for name in known if name in everything}, trees)
    write_results(RESULTS if kept else OUT / "results.json", results)
    return 0 if (not kept or write_pages(results)) and succeeded else 1
