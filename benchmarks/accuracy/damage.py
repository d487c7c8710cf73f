"""Damaged keypoints: accuracy of profile ``full`` with and without the repair.

Demonstrations are clean and takes damaged, the same ones with and without the repair. The recorded
sets show hands or arms only; the takes of the sample clips show a whole body.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import numpy.typing as npt

from app.recognition import Language, PoseSequence, Recognizer
from app.recognition.gestures.profile import Tuning
from app.recognition.preprocessing.repair import swap_sides
from benchmarks.accuracy.samples import is_right, read_samples, teach_samples
from benchmarks.figures import Figure, Measurement, Results, share, table
from benchmarks.sets.every_set import measure_sets
from benchmarks.sets.one_shot_draws import demonstrated, draws
from benchmarks.sets.recorded_sets import RecordedSet

SETS = ("digits", "grufba3d", "natops")
TORSOS_PER_EXTENT = 0.7
"""Torso lengths in the extent of a gesture: the unit of damage where no torso is in view."""

MEAN_RUN = 4
"""Frames that a loss or an exchange of sides lasts on average."""

Damage = Callable[[PoseSequence, np.random.Generator], PoseSequence]
Mask = npt.NDArray[np.bool_]

Question = tuple[Language, PoseSequence, str]
"""A language, a take, and the gesture that it shows."""


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
    **{f"missing-{share:.0%}".rstrip("%"): partial(missing, share) for share in (0.1, 0.3, 0.6)},
    **{f"jitter-{sigma:g}": partial(jitter, sigma) for sigma in (0.02, 0.05, 0.1)},
    **{
        f"exchanged-{share:.0%}".rstrip("%"): partial(exchange, share) for share in (0.05, 0.2, 0.4)
    },
    **{f"jumps-{share:.0%}".rstrip("%"): partial(jumping, share) for share in (0.02, 0.05, 0.1)},
}
"""By name: kind, and per cent of the frames or torso lengths."""


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


def measure_damage(questions: Sequence[Question]) -> Iterator[Figure]:
    """Yield how many takes are nearest right by damage, with the repair and without it."""
    languages = dict.fromkeys(language for language, _, _ in questions)
    recognizers = {
        name: {
            language: Recognizer(language, tuning=Tuning(keypoints_repaired=name == "repaired"))
            for language in languages
        }
        for name in ("repaired", "unrepaired")
    }
    for name, damage in DAMAGES.items():
        random = np.random.default_rng(1)
        right = Counter[str]()
        for language, poses, label in questions:
            bad = damage(poses, random)
            for repair, by_language in recognizers.items():
                right[repair] += is_right(by_language[language], bad, label)
        for repair in recognizers:
            yield share(f"{name}/{repair}", right[repair], len(questions))


def measure_set(recorded: RecordedSet, quick: bool) -> Iterator[Figure]:
    """Ask about takes by other people, or by anybody where people are not known."""
    questions = []
    for draw in draws(recorded, 1 if quick else 4, 20, seed=1):
        language = Language(recorded.name, demonstrated(recorded, draw.templates))
        for query in draw.others if len(draw.others) else draw.own:
            questions.append((language, recorded.recordings[query], str(recorded.labels[query])))
    yield from measure_damage(questions)


def measure_takes(quick: bool) -> Iterator[Figure]:
    """Ask about the takes of the sample clips, each damaged several times."""
    demonstrations, tests = read_samples()
    language = teach_samples(demonstrations)
    takes = [(language, poses, label) for label, poses in tests]
    yield from measure_damage(takes * (1 if quick else 4))


def measurements(folder: Path, methods: tuple[str, ...]) -> Iterator[Measurement]:
    """Yield one for the sample clips, and for each set."""
    protocol = "clean demonstrations; the same damaged takes with the repair and without it"
    yield Measurement("damage/clips", measure_takes, "sample clips", protocol)
    yield from measure_sets("damage", folder, SETS, measure_set, protocol)


def write_damage(results: Results) -> str:
    """Write a row for each damage, a column for each set: with repair / without."""
    sets = results.names("damage")
    rows = [
        [
            name.replace("-", " "),
            *(
                " / ".join(
                    results.show(f"damage/{each}", f"{name}/{repair}", "bare")
                    for repair in ("repaired", "unrepaired")
                )
                for each in sets
            ),
        ]
        for name in ("none", "missing-60", "exchanged-20", "jumps-10")
    ]
    return table(("damage, % of frames", *sets), rows)


TABLES = {"damage": write_damage}
