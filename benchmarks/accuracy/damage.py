"""Damaged keypoints: accuracy of profile ``full`` with and without the repair.

Demonstrations are clean and queries damaged, the same ones with and without the repair. The
recorded sets show hands or arms only; the takes of our own test clips show a whole body (their
poses are extracted once and stored in the folder TAKES).

    python -m benchmarks.accuracy.damage ../shared/data TAKES --draws 10 --queries 20 --seed 1
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
import numpy.typing as npt

from app.evaluation.share import Share
from app.recognition import (
    Language,
    PoseError,
    PoseSequence,
    Recognizer,
    Recording,
    record,
    takes_in,
)
from app.recognition.gestures.profile import Tuning
from app.recognition.preprocessing.repair import swap_sides
from benchmarks.sets.one_shot_draws import demonstrated, draws
from benchmarks.sets.recorded_sets import recorded_sets
from languages.build import FOLDER, TABLE_2

SETS = ("digits", "grufba3d", "natops")
TORSOS_PER_EXTENT = 0.7
"""Torso lengths in the extent of a gesture: the unit of damage where no torso is in view."""

MEAN_RUN = 4
"""Frames that a loss or an exchange of sides lasts on average."""

Damage = Callable[[PoseSequence, np.random.Generator], PoseSequence]
Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class Question:
    """A query with its true label, for the recognisers of its language."""

    repairing: Recognizer
    unrepaired: Recognizer
    poses: PoseSequence
    label: str


def missing(share: float, poses: PoseSequence, random: np.random.Generator) -> PoseSequence:
    """Remove all landmarks in a share of the frames, in runs."""
    lost = in_runs(share, len(poses), random)
    return replace(poses, xy=np.where(lost[:, None, None], np.nan, poses.xy))


def jitter(sigma: float, poses: PoseSequence, random: np.random.Generator) -> PoseSequence:
    """Add noise of standard deviation `sigma` torso lengths to x and y of every landmark."""
    return replace(poses, xy=poses.xy + random.normal(0, sigma * unit(poses), poses.xy.shape))


def exchange(share: float, poses: PoseSequence, random: np.random.Generator) -> PoseSequence:
    """Take left for right in a share of the frames, in runs."""
    mistaken = in_runs(share, len(poses), random)
    return replace(poses, xy=swap_sides(poses.xy, poses.landmarks, mistaken))


def jumping(share: float, poses: PoseSequence, random: np.random.Generator) -> PoseSequence:
    """Displace each landmark by half to two torso lengths in a share of its frames."""
    shape = poses.xy.shape[:2]
    angle = random.uniform(0, 2 * np.pi, shape)
    far = random.uniform(0.5, 2, shape) * unit(poses) * (random.uniform(size=shape) < share)
    off = far[..., None] * np.stack([np.cos(angle), np.sin(angle)], axis=2)
    return replace(poses, xy=poses.xy + off)


def untouched(poses: PoseSequence, random: np.random.Generator) -> PoseSequence:
    """Return the query unchanged."""
    return poses


DAMAGES: dict[str, Damage] = {
    "none": untouched,
    **{f"missing in {share:.0%}": partial(missing, share) for share in (0.1, 0.3, 0.6)},
    **{f"jitter of {sigma:g}": partial(jitter, sigma) for sigma in (0.02, 0.05, 0.1)},
    **{f"exchanged in {share:.0%}": partial(exchange, share) for share in (0.05, 0.2, 0.4)},
    **{f"jumps in {share:.0%}": partial(jumping, share) for share in (0.02, 0.05, 0.1)},
}


def unit(poses: PoseSequence) -> float:
    """Return a torso length in pixels, or the size used in its place."""
    low, high = np.nanpercentile(poses.xy, (5, 95), axis=0)
    extent = float(np.linalg.norm(high - low, axis=1).max())
    return poses.torso_length() or TORSOS_PER_EXTENT * extent


def in_runs(share: float, count: int, random: np.random.Generator) -> Mask:
    """Choose about a share of `count` frames in runs of `MEAN_RUN` on average; not the ends."""
    chosen = np.zeros(count, dtype=bool)
    while chosen.mean() < share:
        start = int(random.integers(1, count - 1))
        chosen[start : min(start + int(random.geometric(1 / MEAN_RUN)), count - 1)] = True
    return chosen


def question(language: Language, poses: PoseSequence, label: str) -> Question:
    """Recognise a query with the repair and without it."""
    return Question(
        Recognizer(language),
        Recognizer(language, tuning=Tuning(keypoints_repaired=False)),
        poses,
        label,
    )


def recorded_questions(
    folder: Path, count: int, queries: int, seed: int
) -> Iterator[tuple[str, Question]]:
    """Return queries by other people, or by anyone where people are unknown."""
    for recorded in recorded_sets(folder):
        if recorded.name not in SETS:
            continue
        for draw in draws(recorded, count, queries, seed):
            language = Language(recorded.name, demonstrated(recorded, draw.templates))
            first = question(language, recorded.recordings[0], "")
            for query in draw.others if len(draw.others) else draw.own:
                poses, label = recorded.recordings[query], str(recorded.labels[query])
                yield recorded.name, replace(first, poses=poses, label=label)


def clip_questions(kept: Path, times: int) -> Iterator[tuple[str, Question]]:
    """Recognise the takes of our test clips, each several times; poses are stored in a folder."""
    first = question(
        Language.load(FOLDER / "osg-table-2.json"), _recording(kept, "line-test-1").poses, ""
    )
    for label in (entry.label for entry in TABLE_2):
        for number in (1, 2):
            take = takes_in(_recording(kept, f"{label}-test-{number}"))[0]
            yield from [("takes", replace(first, poses=take.poses, label=label))] * times


def _recording(kept: Path, name: str) -> Recording:
    file = kept / f"{name}.npz"
    if not file.exists():
        record(FOLDER / "clips" / f"{name}.mp4").save(file)
    return Recording.load(file)


def is_named(recognizer: Recognizer, poses: PoseSequence, label: str) -> bool:
    """Return whether the gesture is recognised; a take with a fault counts as not recognised."""
    try:
        return recognizer.recognize(poses).nearest == label
    except PoseError:
        return False


def main() -> None:
    """Print one line per damage and set: with the repair, and without it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("data", type=Path, help="the folder that holds trajectories/")
    parser.add_argument("takes", type=Path, help="a folder for the poses of our test clips")
    parser.add_argument("--draws", type=int, default=10, help="languages per set")
    parser.add_argument("--queries", type=int, default=20, help="queries per language")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    questions = [
        *clip_questions(given.takes, given.draws),
        *recorded_questions(given.data / "trajectories", given.draws, given.queries, given.seed),
    ]
    for name, damage in DAMAGES.items():
        random = np.random.default_rng(given.seed)
        repaired: dict[str, Share] = {}
        unrepaired: dict[str, Share] = {}
        for set_name, asked in questions:
            bad = damage(asked.poses, random)
            for recognizer, shares in (
                (asked.repairing, repaired),
                (asked.unrepaired, unrepaired),
            ):
                right = is_named(recognizer, bad, asked.label)
                shares[set_name] = shares.get(set_name, Share(0, 0)) + Share(right, 1)
        for set_name, share in repaired.items():
            print(f"{name:17} {set_name:9} {share!s:18} {unrepaired[set_name]}", flush=True)


if __name__ == "__main__":
    main()
