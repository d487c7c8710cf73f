"""Plant faults in the app, one at a time, and note which of them the tests find.

`python -m tests.plant_faults JOURNAL` changes 17 places in each part of `AREAS`, always the same.
Each fault runs against quick tests: of the files named after the changed module, then of those
that import it, then of those beside it. The journal has one JSON line for each fault, and a run
goes on where the last one stopped. `--found JOURNAL` plants again only the faults that an earlier
run found, whatever has become of the tests since: a fault is known by its function and its text,
not by its line. The page's JavaScript is left out.

Run this in a checkout of its own, since it writes to the files of `app`.
"""

import argparse
import ast
import json
import os
import random
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator
from copy import deepcopy
from itertools import islice
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
AREAS = {
    "decision": "recognition/decision/*.py",
    "segmentation": "recognition/recording/*segmentation.py",
    "trimming": "recognition/recording/trimming.py",
    "salute": "recognition/recording/*salute*.py",
    "language file": "recognition/language/*.py",
    "store": "store/*s.py",
    "backup": "store/backup/*.py",
    "invitations": "**/invit*.py",
    "quotas": "**/quotas.py",
    "access": "api/middleware/access.py",
    "orders": "robot/mavlink/*.py",
    "dialogue": "robot/commands/*.py",
    "transcript": "recognition/explanation/transcript.py",
    "causes": "recognition/explanation/causes.py",
}
FAULTS_AN_AREA, FILES_A_MODULE, SECONDS_A_FAULT = 17, 3, 240
WAITS_ELSEWHERE = {"browser", "ros2", "release", "page", "benchmarks"}
PAIRS = "Lt LtE Gt GtE Eq NotEq Is IsNot In NotIn And Or Add Sub Mult Div".split()  # noqa: SIM905
SWAPS: dict[type[Any], Any] = {
    getattr(ast, name): getattr(ast, other)
    for pair in zip(PAIRS[::2], PAIRS[1::2], strict=True)
    for name, other in (pair, pair[::-1])
}


def faulty(node: ast.AST) -> Iterator[tuple[str, ast.AST]]:
    """Yield each kind of fault that can be planted at a node, with the node that replaces it."""
    changed = deepcopy(node)
    if isinstance(changed, ast.Compare) and type(changed.ops[0]) in SWAPS:
        changed.ops[0] = SWAPS[type(changed.ops[0])]()
        yield "comparison", changed
    elif isinstance(changed, ast.BoolOp | ast.BinOp) and type(changed.op) in SWAPS:
        changed.op = SWAPS[type(changed.op)]()
        yield "operator", changed
    elif isinstance(changed, ast.Constant) and isinstance(changed.value, int | float):
        number = changed.value
        yield "constant", ast.Constant(not number if isinstance(number, bool) else number + 1)
    elif isinstance(changed, ast.If | ast.IfExp):
        changed.test = ast.UnaryOp(ast.Not(), changed.test)
        yield "negation", changed
    elif isinstance(changed, ast.Return) and changed.value is not None:
        yield "returned None", ast.Return(ast.Constant(None))
    elif isinstance(changed, ast.AugAssign | ast.Raise) or (
        isinstance(changed, ast.Expr) and isinstance(changed.value, ast.Call)
    ):
        yield "dropped statement", ast.Pass()


def faults(tree: ast.AST, where: str = "") -> Iterator[tuple[str, str, ast.AST, ast.AST]]:
    """Yield function, kind, node and its replacement of each fault in functions below a node."""
    for field, value in ast.iter_fields(tree):
        if field in ("annotation", "returns", "decorator_list", "type_params"):
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
                yield from faults(child, f"{where}.{child.name}")
            elif isinstance(child, ast.AST):
                if where:
                    yield from ((where, kind, child, new) for kind, new in faulty(child))
                yield from faults(child, where)


def name_faults(path: Path) -> list[str]:
    """Return a name of each fault of a module, which survives changes elsewhere."""
    seen, names = Counter[str](), list[str]()
    for where, kind, node, _ in faults(ast.parse(path.read_text())):
        text = ast.unparse(node).splitlines()[0]
        name = f"{path.relative_to(ROOT)} {where[1:]}: {kind} in `{text}`"
        seen[name] += 1
        names.append(f"{name}#{seen[name]}")
    return names


def with_fault(path: Path, number: int) -> str:
    """Return a module's source with one of its faults."""
    tree = ast.parse(path.read_text())
    *_, old, new = next(islice(faults(tree), number, None))
    for parent in ast.walk(tree):
        for field, value in ast.iter_fields(parent):
            if value is old:
                setattr(parent, field, new)
            elif isinstance(value, list):
                value[:] = [new if each is old else each for each in value]
    return ast.unparse(ast.fix_missing_locations(tree))


def tests_of(path: Path) -> list[str]:
    """Return test files named after a module, then those that import it or lie beside it."""
    module = ".".join(path.relative_to(ROOT).with_suffix("").parts)
    package, _, stem = module.rpartition(".")
    folder = ROOT / "tests" / path.relative_to(ROOT / "app").parent
    found = list[tuple[tuple[bool, ...], str]]()
    for file in sorted((ROOT / "tests").rglob("test_*.py")):
        if file.relative_to(ROOT / "tests").parts[0] not in WAITS_ELSEWHERE:
            text = file.read_text()
            imports = f"{module} import" in text or f"from {package} import" in text
            named, alike = file.name == f"test_{stem}.py", f"test_{stem[:5]}" in file.name
            if named or imports or file.parent == folder or alike:
                nearness = (named, f"{module} import" in text, imports, alike)
                rank = (*(not each for each in nearness), file.parent != folder)
                found.append((rank, str(file.relative_to(ROOT))))
    return [file for _, file in sorted(found)[:FILES_A_MODULE]]


def outcome(tests: list[str]) -> str:
    """Run tests until one fails, and return what became of them."""
    options = ["-x", "-q", "-p", "no:cacheprovider", "--hypothesis-profile", "ci", "-m"]
    command = [sys.executable, "-m", "pytest", *options, "not slow and not models", *tests]
    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}
    with Path(os.devnull).open("w") as nowhere:
        try:
            code = subprocess.call(
                command, cwd=ROOT, env=environment, stdout=nowhere, timeout=SECONDS_A_FAULT
            )
        except subprocess.TimeoutExpired:
            return "found: no end"
    return {0: "missed", 1: "found"}.get(code, "found: not importable")


def main() -> None:
    """Plant each fault that the journal does not have yet."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("journal", type=Path)
    parser.add_argument("--found", type=Path, default=os.devnull)
    arguments = parser.parse_args()
    before = map(json.loads, arguments.found.read_text().splitlines())
    wanted = {line["fault"] for line in before if line["outcome"].startswith("found")}
    done = arguments.journal.read_text() if arguments.journal.exists() else ""
    chosen = list[tuple[int, str, Path, str, int]]()
    for area, pattern in AREAS.items():
        pool = [
            (path, name, number)
            for path in sorted((ROOT / "app").glob(pattern))
            if "migrations" not in path.parts
            for number, name in enumerate(name_faults(path))
        ]
        random.Random(area).shuffle(pool)
        pool = [fault for fault in pool if fault[1] in wanted] if wanted else pool[:FAULTS_AN_AREA]
        chosen += [(place, area, *fault) for place, fault in enumerate(pool)]
    for _, area, path, name, number in sorted(chosen):
        if json.dumps(name) in done:
            continue
        tests, original, started = tests_of(path), path.read_text(), time.monotonic()
        try:
            path.write_text(with_fault(path, number))
            result = outcome(tests)
        finally:
            path.write_text(original)
        seconds = round(time.monotonic() - started, 1)
        line = dict(area=area, fault=name, outcome=result, seconds=seconds, tests=tests)
        with arguments.journal.open("a") as journal:
            journal.write(json.dumps(line) + "\n")


if __name__ == "__main__":
    main()
