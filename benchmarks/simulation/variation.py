"""Variation: how far simulated takes differ from people's further ones, by a factor on their shape.

In each recorded set random pairs of takes of one class are drawn: a demonstration and a further
take, by the same person or another one, or by anybody if the set does not name people. Figures are
Kolmogorov and Smirnov's largest difference of the distributions of the voters' distances, of the
further takes and of variants of the demonstrations, mean over the voters. The factor 1 is shipped;
each set was left out by choosing the factor that is best on the others.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from itertools import product
from pathlib import Path

import numpy as np

from app.recognition.decision.fused_vote import FusedVote
from app.recognition.gestures.demonstration import condense
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.simulation.variation import SPREADS, Person, vary
from app.recognition.voters.registry import VOTER_NAMES
from benchmarks.figures import Figure, Measurement, Results, table
from benchmarks.sets.every_set import count_people, measure_sets
from benchmarks.sets.one_shot_draws import demonstrated
from benchmarks.sets.recorded_sets import SETS, RecordedSet

ARTEFACTS = {"natops": ("tempo",)}
"""Voters that measure what a set's authors normalised away: the number of frames."""

SCALES = (0.7, 0.85, 1.0, 1.2, 1.4)
SHAPE = ("slant", "stretch", "shear", "waver", "sway")
VARIANTS = 3


def compare_kinds(
    recorded: RecordedSet, person: Person, pairs: int
) -> Iterator[tuple[FloatArray, dict[float, FloatArray]]]:
    """Yield voters' distances of a further take ``(V,)``, and of variants ``(M, V)`` by factor."""
    random = np.random.default_rng(1)
    recordings, known = recorded.recordings, count_people(recorded) is not None
    for number in range(pairs):
        first = int(random.integers(len(recordings)))
        others = recorded.labels == recorded.labels[first]
        if known:
            others &= (recorded.people == recorded.people[first]) == (person == "same")
        others[first] = False
        (gesture,) = demonstrated(recorded, [first])
        shown = gesture.trajectory
        assert shown is not None, "gestures made from poses have one"
        measure = partial(measure_distances, FusedVote([gesture]), shown.landmarks)
        further = recordings[int(random.choice(np.flatnonzero(others)))]
        varied = {}
        for factor in SCALES:
            spread = SPREADS[person]
            larger = {name: factor * getattr(spread, name) for name in SHAPE}
            drawn = vary(shown, VARIANTS, replace(spread, **larger), seed=1 + number)
            varied[factor] = np.array([measure(each) for each in drawn])
        yield measure(Trajectory.from_poses(further)), varied


def measure_distances(vote: FusedVote, landmarks: tuple[str, ...], take: Trajectory) -> FloatArray:
    """Return the ``(V,)`` distances of a take in the nearest traversal."""
    return vote.compare(condense(take).select(landmarks)).distances[:, 0]


def measure_variants(recorded: RecordedSet, quick: bool) -> Iterator[Figure]:
    """Yield the mean difference of the distributions by person and factor."""
    counted = [
        index
        for index, name in enumerate(VOTER_NAMES)
        if name not in ARTEFACTS.get(recorded.name, ())
    ]
    people: tuple[Person, ...] = ("same", "another") if count_people(recorded) else ("another",)
    for person in people:
        pairs = [*compare_kinds(recorded, person, 12 if quick else 50)]
        real = np.array([taken for taken, _ in pairs])
        for factor in SCALES:
            varied = np.concatenate([drawn[factor] for _, drawn in pairs])
            differences = [
                find_difference(real[:, voter], varied[:, voter])
                for voter in counted
                if np.isfinite(real[:, voter]).all() and np.ptp(real[:, voter]) > 0
            ]
            yield Figure(f"{person}/{factor:g}", float(np.mean(differences)), len(pairs), unit="")


def find_difference(one: FloatArray, other: FloatArray) -> float:
    """Return the largest difference between two samples' cumulative distributions."""
    every = np.sort(np.concatenate([one, other]))
    below = [
        np.searchsorted(np.sort(each), every, side="right") / len(each) for each in (one, other)
    ]
    return float(np.abs(below[0] - below[1]).max())


def measurements(folder: Path, methods: tuple[str, ...]) -> Iterator[Measurement]:
    """Yield one for each set."""
    protocol = "50 pairs of takes of a class, three variants of each first one"
    yield from measure_sets("variants", folder, SETS, measure_variants, protocol)


def write_variants(results: Results) -> str:
    """Write the differences by factor, and the factor that the other sets choose."""
    found = {
        (name, person): [
            results.find(f"variants/{name}", f"{person}/{factor:g}").value for factor in SCALES
        ]
        for name, person in product(results.names("variants"), ("same", "another"))
        if f"{person}/1" in results.measured[f"variants/{name}"].figures
    }
    rows = []
    for (name, person), values in found.items():
        others = [each for (other, who), each in found.items() if other != name and who == person]
        chosen = SCALES[int(np.mean(others, axis=0).argmin())]
        rows.append([f"{name}, {person}", *(f"{each:.2f}" for each in values), f"{chosen:g}"])
    return table(("set, by", *(f"{each:g}" for each in SCALES), "the others choose"), rows)


TABLES = {"variants": write_variants}
