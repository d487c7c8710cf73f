"""Version comparison: compares the results of two versions of the program, number by number.

Writes every answer that somebody may rely on: takes, recognitions, language files, reports,
explanations, robot events, the HTTP schema, on the sample clips and on recorded sets. Written by
two versions, the files are compared:

    python -m benchmarks.version_comparison write BEFORE.json --data ../shared/data
    python -m benchmarks.version_comparison compare BEFORE.json AFTER.json

It uses the public surface alone, so that it runs on any version.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import math
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from app.recognition import (
    Gesture,
    GestureError,
    Language,
    PoseError,
    PoseSequence,
    Recognizer,
    Recording,
    takes_in,
)
from benchmarks.sets.recorded_sets import SETS, RecordedSet, recorded_sets

ROOT = Path(__file__).resolve().parents[1]
RECORDINGS = ROOT / "tests" / "recordings"
LANGUAGES = ROOT / "languages"
PROFILES = ("paper", "full")

QUERIES = 60
"""Number of recordings recognised per set."""

TOLERANCE = 1e-9
"""Tolerance, relative or absolute, within which two numbers are equal."""

TEXTS = ("sentence", "message", "title", "description", "summary", "why", "text", "findings")
"""Keys of texts; these may be reworded, so they are not compared."""


def write_answers(data: Path | None) -> dict[str, Any]:
    """Collect all answers of this version.

    Parameters
    ----------
    data
        The folder that holds trajectories/; None: the sample clips alone.

    """
    answers: dict[str, Any] = {"clips": {}, "languages": {}, "sets": {}, "commands": {}}
    for folder in sorted(RECORDINGS.iterdir()):
        if folder.is_dir() and any(folder.glob("*.npz")):
            answers["clips"][folder.name] = dict(_clip_answers(folder))
    answers["languages"] = {file.name: _rebuild(file) for file in sorted(LANGUAGES.glob("*.json"))}
    if data is not None:
        for recorded in recorded_sets(data / "trajectories", SETS):
            answers["sets"][recorded.name] = dict(_set_answers(recorded))
    answers["commands"] = dict(_command_answers())
    answers["http"] = _http_schema()
    return answers


def _clip_answers(folder: Path) -> Iterator[tuple[str, Any]]:
    recognizers = {
        f"{file.stem} {profile}": Recognizer(Language.load(file), profile=profile)
        for file in sorted(LANGUAGES.glob("*.json"))
        for profile in PROFILES
    }
    for file in sorted(folder.glob("*.npz")):
        takes = []
        for take in takes_in(Recording.load(file)):
            spans = [take.start, take.end, take.stroke_start, take.stroke_end]
            results = {name: answer(one, take.poses) for name, one in recognizers.items()}
            takes.append({"spans": spans, "closed": take.closed, "results": results})
        yield file.stem, takes


def answer(recognizer: Recognizer, poses: PoseSequence) -> dict[str, Any]:
    """Return a complete recognition, or the reason why the take cannot be compared."""
    try:
        return recognizer.recognize(poses).to_dict()
    except PoseError as error:
        return {"refused": str(error)}


def _rebuild(file: Path) -> dict[str, Any]:
    """Load and save a shipped language, and a new one of its gestures."""
    language = Language.load(file)
    with tempfile.TemporaryDirectory() as folder:
        again, rebuilt = Path(folder) / "again.json", Path(folder) / "rebuilt.json"
        language.save(again)
        built = Language(name="rebuilt", gestures=list(language.gestures), created=language.created)
        built.save(rebuilt)
        return {
            "same bytes": again.read_bytes() == file.read_bytes(),
            "sha256": hashlib.sha256(again.read_bytes()).hexdigest(),
            "rebuilt": json.loads(rebuilt.read_text()),
        }


def _set_answers(recorded: RecordedSet) -> Iterator[tuple[str, Any]]:
    """Recognise recordings by a language of the first recording of each class."""
    gestures = []
    for label in sorted(set(recorded.labels.tolist())):
        first = int(np.flatnonzero(recorded.labels == label)[0])
        try:
            gestures.append(Gesture.from_demonstration(label, recorded.recordings[first]))
        except GestureError as error:
            yield f"refused {label}", str(type(error).__name__)
    for profile in PROFILES:
        recognizer = Recognizer(Language(recorded.name, gestures=gestures), profile=profile)
        for index in np.linspace(0, len(recorded.recordings) - 1, QUERIES).astype(int).tolist():
            yield f"{profile} {index}", answer(recognizer, recorded.recordings[index])


def _command_answers() -> Iterator[tuple[str, Any]]:
    clips = LANGUAGES / "clips"
    language = str(LANGUAGES / "osg-table-2.json")
    triangle, line = str(clips / "unfinished-triangle.mp4"), str(clips / "line-test-1.mp4")
    explained = ["recognize", triangle, "--language", language, "--expected", "triangle", "--json"]
    yield "check", json.loads(_run("check", language, "--json"))
    yield "recognize", json.loads(_run(*explained))
    for publish in ([], ["--without-salutes"]):
        events = _run("robot", "--language", language, "--source", line, *publish)
        yield " ".join(["robot", *publish]), [json.loads(row) for row in events.splitlines()]


def _run(*arguments: str) -> str:
    command = [sys.executable, "-m", "app", *arguments]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False).stdout


def _http_schema() -> Any:
    from app.server import create_app
    from app.settings import Settings

    with tempfile.TemporaryDirectory() as folder:
        return create_app(Settings(data_dir=Path(folder))).openapi()


def differences(one: Any, other: Any, path: str = "") -> Iterator[str]:
    """Yield every place at which two answers differ, except texts."""
    if isinstance(one, dict) and isinstance(other, dict):
        for key in sorted({*one, *other}, key=str):
            if key in TEXTS:
                continue
            if key not in one or key not in other:
                yield f"{path}/{key}: only {'before' if key in one else 'after'}"
            else:
                yield from differences(one[key], other[key], f"{path}/{key}")
    elif isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        for index, (left, right) in enumerate(zip(one, other, strict=True)):
            yield from differences(left, right, f"{path}/{index}")
    elif not _same(one, other):
        yield f"{path}: {str(one)[:80]} -> {str(other)[:80]}"


def _same(one: Any, other: Any) -> bool:
    if isinstance(one, float) and isinstance(other, float):
        return math.isclose(one, other, rel_tol=TOLERANCE, abs_tol=TOLERANCE)
    return bool(one == other)


def main() -> None:
    """Write a file of answers, or compare two."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parts = parser.add_subparsers(dest="part", required=True)
    writing = parts.add_parser("write")
    writing.add_argument("output", type=Path)
    writing.add_argument("--data", type=Path)
    comparing = parts.add_parser("compare")
    comparing.add_argument("before", type=Path)
    comparing.add_argument("after", type=Path)
    given = parser.parse_args()
    if given.part == "write":
        given.output.write_text(json.dumps(write_answers(given.data), indent=1))
        return
    found = list(
        differences(*(json.loads(file.read_text()) for file in (given.before, given.after)))
    )
    print("\n".join(found) or "the same answers")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
