"""Accuracy of a profile on other people's recorded trajectories, one template a class.

Per draw, one template of each class comes from one person, and queries from the same person
(UD, user-dependent) or from everyone else (UI, user-independent), through the public interface:
`Gesture.from_demonstration` and `Recognizer.recognize`. Only x and y are used. Draws are random
with a fixed seed, so that the whole runs in a few minutes on one core; the interval is Wilson's.

    python -m benchmarks.shared_sets ../shared/data
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import dataclass
from math import sqrt
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from app.recognition import (
    Gesture,
    GestureError,
    Language,
    PoseError,
    PoseSequence,
    Recognizer,
)
from app.recognition.recognizer import PROFILES

FRAME = (640, 480)
RATE = 30.0
"""Frames per second, about that of all sets; profile ``paper`` does not look at time."""

PUBLISHED = {"digits": (67.0, 43.3), "letters": (53.3, 37.7), "commands": (72.3, 57.7)}
"""The published implementation on the same sets, UD and UI in per cent, every template tried."""

DUPLICATED = "Wheel"
"""A class of 3DMadLabSD that shares 60 identical trajectories with the digit 0."""


@dataclass(frozen=True)
class RecordedSet:
    """Recordings of several people.

    Attributes
    ----------
    name
        For the report.
    recordings
        N pose sequences.
    labels, people
        ``(N,)`` class and person of each; one unknown person where the set does not tell.

    """

    name: str
    recordings: list[PoseSequence]
    labels: npt.NDArray[np.str_]
    people: npt.NDArray[np.str_]


@dataclass(frozen=True)
class Score:
    """Correct answers out of all queries."""

    correct: int
    queries: int

    def __str__(self) -> str:
        if not self.queries:
            return "     -          "
        share, n, z = self.correct / self.queries, self.queries, 1.96
        middle = (share + z * z / (2 * n)) / (1 + z * z / n)
        half = z * sqrt(share * (1 - share) / n + z * z / (4 * n * n)) / (1 + z * z / n)
        return f"{share:6.1%} ({middle - half:.0%}-{middle + half:.0%})"


def recorded_sets(folder: Path) -> Iterator[RecordedSet]:
    """Read the three sets that published numbers exist for, and two with both arms."""
    madlab = _content(folder / "madlab3d.npz")
    for domain in PUBLISHED:
        chosen = (madlab["domain"] == domain) & (madlab["label"] != DUPLICATED)
        yield _recorded_set(domain, madlab, np.flatnonzero(chosen))
    for name in ("grufba3d", "natops"):
        content = _content(folder / f"{name}.npz")
        yield _recorded_set(name, content, np.arange(len(content["label"])))


def _content(path: Path) -> dict[str, npt.NDArray[Any]]:
    """Read all arrays of a file once: each look into an opened one reads it again."""
    with np.load(path, allow_pickle=True) as file:
        return dict(file)


def _recorded_set(
    name: str, content: dict[str, npt.NDArray[Any]], chosen: npt.NDArray[np.intp]
) -> RecordedSet:
    """Bring trackers' units to pixels, y down, with one scale for the whole set."""
    joints = [str(joint) for joint in content["joint_names"]]
    hands = [index for index, joint in enumerate(joints) if joint.endswith(("hand", "wrist"))]
    columns = hands or list(range(len(joints)))
    landmarks = tuple(joints[column] for column in columns)
    paths = [content["x"][index][:, columns, :2].astype(np.float64) for index in chosen]
    widest = max(float(np.ptp(path, axis=0).max()) for path in paths)
    recordings = [
        PoseSequence(
            landmarks=landmarks,
            xy=(path - path.mean(axis=(0, 1))) * (1, -1) * (FRAME[1] / widest)
            + np.array(FRAME) / 2,
            time=np.arange(len(path)) / RATE,
            frame_size=FRAME,
        )
        for path in paths
    ]
    labels = content["label"][chosen].astype(str)
    return RecordedSet(name, recordings, labels, content["subject"][chosen].astype(str))


def evaluate(
    recorded: RecordedSet, profile: str, draws: int, queries: int, seed: int
) -> tuple[Score, Score]:
    """Score a profile, user-dependent and user-independent."""
    generator = np.random.default_rng(seed)
    correct, asked = [0, 0], [0, 0]
    for _ in range(draws):
        person = generator.choice(np.unique(recorded.people))
        own = recorded.people == person
        templates = [
            int(generator.choice(np.flatnonzero(own & (recorded.labels == label))))
            for label in np.unique(recorded.labels)
        ]
        recognizer = Recognizer(_language(recorded, templates), profile)
        rest = np.setdiff1d(np.flatnonzero(own), templates)
        for kind, pool in enumerate((rest, np.flatnonzero(~own))):
            for query in generator.choice(pool, min(queries, len(pool)), replace=False):
                asked[kind] += 1
                answer = _answer(recognizer, recorded.recordings[query])
                correct[kind] += answer == recorded.labels[query]
    return Score(correct[0], asked[0]), Score(correct[1], asked[1])


def _language(recorded: RecordedSet, templates: list[int]) -> Language:
    gestures = []
    for template in templates:
        label = str(recorded.labels[template])
        poses = recorded.recordings[template]
        try:
            gestures.append(Gesture.from_demonstration(label, poses))
        except GestureError:  # nothing moves enough by itself: follow every landmark
            gestures.append(Gesture.from_demonstration(label, poses, salient=poses.landmarks))
    return Language(recorded.name, gestures)


def _answer(recognizer: Recognizer, poses: PoseSequence) -> str | None:
    try:
        return recognizer.recognize(poses).label
    except PoseError:
        return None


def main() -> None:
    """Print one line a set."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("data", type=Path, help="the folder that holds trajectories/")
    parser.add_argument("--profile", choices=sorted(PROFILES), default="paper")
    parser.add_argument("--draws", type=int, default=60, help="choices of templates per set")
    parser.add_argument("--queries", type=int, default=30, help="queries per choice, UD and UI")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    print(f"profile {arguments.profile}, one template a class, share correct (95 % interval)")
    print(f"{'set':10} {'UD':>17} {'published':>10} {'UI':>17} {'published':>10}")
    for recorded in recorded_sets(arguments.data / "trajectories"):
        dependent, independent = evaluate(
            recorded, arguments.profile, arguments.draws, arguments.queries, arguments.seed
        )
        before = [f"{value:.1f}%" for value in PUBLISHED.get(recorded.name, ())] or ["-", "-"]
        print(
            f"{recorded.name:10} {dependent!s:>17} {before[0]:>10} "
            f"{independent!s:>17} {before[1]:>10}",
            flush=True,
        )


if __name__ == "__main__":
    main()
