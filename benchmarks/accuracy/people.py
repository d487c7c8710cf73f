"""Accuracy on people not used for tuning, beside plain DTW of positions and of velocities.

Each gesture has one demonstration, all by one person; queries are by the same person (UD) or by
everybody else (UI). `nearest` is the share of queries whose nearest gesture is the right one,
`refused` the share of these that the shipped thresholds reject; the interval is Wilson's.

    python -m benchmarks.accuracy.people ../shared/data --draws 8 --queries 60
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from app.evaluation.proportion import Share
from app.recognition import Language, PoseError, PoseSequence, Recognition, Recognizer
from app.recognition.matching.dtw import dtw_distances
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from benchmarks.arguments import set_arguments
from benchmarks.methods.ours import gesture_of
from benchmarks.sets.one_shot_draws import Draw, draws
from benchmarks.sets.recorded_sets import SETS, RecordedSet, recorded_sets
from benchmarks.sets.simulated_bodies import CARRIED, carried_sets
from benchmarks.sets.whole_body_sets import ARM_CLASSES, whole_body_sets

STEPS, BAND = 32, 8
"""Steps that a recording is resampled to in time, and the band of DTW in steps."""

MOVING = ("elbow", "wrist", "hand", "hand_tip", "thumb", "index")
"""Parts of the body that plain DTW follows."""

Name = Callable[[PoseSequence], Recognition | str | None]


def positions(poses: PoseSequence) -> FloatArray:
    """Return ``(N, D)`` positions of arms in time: torso lengths from the shoulders' mean place.

    Without a torso they are normalised by place and size.
    """
    trajectory = Trajectory.from_poses(poses)
    arms = [name for name in trajectory.landmarks if name.split("_", 1)[-1] in MOVING]
    centre, length = poses.torso_centre(), poses.torso_length()
    if centre is None or length is None:
        paths = trajectory.select(arms or trajectory.landmarks).fill_gaps().resample_in_time(STEPS)
        free = np.nan_to_num(paths.xy - np.nanmean(paths.xy, axis=0))
        return np.asarray(free.reshape(STEPS, -1) / max(float(np.sqrt((free**2).mean())), 1e-9))
    shoulders = (poses.column("left_shoulder") + poses.column("right_shoulder")) / 2
    fixed = replace(poses.select(arms), xy=poses.select(arms).xy - np.nanmedian(shoulders, axis=0))
    paths = replace(trajectory.select(arms), xy=fixed.xy / length).fill_gaps()
    return np.asarray(np.nan_to_num(paths.resample_in_time(STEPS).xy).reshape(STEPS, -1))


def velocities(poses: PoseSequence) -> FloatArray:
    """Return ``(N, D)`` velocities of arms in time, scaled by their own energy."""
    speed = np.gradient(positions(poses), axis=0)
    return np.asarray(speed / max(float(np.sqrt((speed**2).mean())), 1e-9))


def plain_dtw(
    describe: Callable[[PoseSequence], FloatArray], templates: Sequence[PoseSequence]
) -> Callable[[PoseSequence], FloatArray]:
    """Return a function that measures the distances to all templates, over their median."""
    references = np.stack([describe(each) for each in templates])
    between = [dtw_distances(each, references, BAND) for each in references]
    typical = float(np.median(np.array(between)[np.triu_indices(len(references), 1)]))
    return lambda poses: dtw_distances(describe(poses), references, BAND) / typical


def score(recorded: RecordedSet, chosen: Draw) -> Iterator[tuple[str, str, Share, Share]]:
    """Yield method, relation, share of right nearest gestures, and share rejected among these."""
    templates = [recorded.recordings[index] for index in chosen.templates]
    labels = [str(recorded.labels[index]) for index in chosen.templates]
    language = Language(recorded.name, list(map(gesture_of, labels, templates)))
    full = Recognizer(language, "full")
    plain = {
        "DTW positions": plain_dtw(positions, templates),
        "DTW velocities": plain_dtw(velocities, templates),
    }
    for relation, queries in (("UD", chosen.own), ("UI", chosen.others)):
        for query in queries:
            poses, label = recorded.recordings[query], str(recorded.labels[query])
            compared = {name: distances(poses) for name, distances in plain.items()}
            compared["DTW of both"] = np.asarray(sum(compared.values()))
            for name, distances in compared.items():
                yield name, relation, Share(labels[distances.argmin()] == label, 1), Share(0, 0)
            try:
                result = full.recognize(poses)
            except PoseError:
                yield "full", relation, Share(0, 1), Share(0, 0)
                continue
            right = result.nearest == label
            refused = Share(result.label is None, 1) if right else Share(0, 0)
            yield "full", relation, Share(right, 1), refused


def all_sets(folder: Path, names: Sequence[str] | None) -> Iterator[RecordedSet]:
    """Yield the recorded sets of hands and of whole bodies, and hands' paths carried by bodies."""
    wanted = [*SETS, *ARM_CLASSES, *CARRIED] if names is None else names
    yield from recorded_sets(folder, [name for name in wanted if name in SETS])
    for recorded in whole_body_sets(folder) if set(wanted) & set(ARM_CLASSES) else ():
        if recorded.name in wanted:
            yield recorded
    yield from carried_sets(folder, [name for name in wanted if name in CARRIED])


def main() -> None:
    """Print one line per set, method and relation."""
    parser = set_arguments(__doc__, draws=8, queries=60)
    given = parser.parse_args()
    for recorded in all_sets(given.data / "trajectories", given.sets):
        right: dict[tuple[str, str], Share] = {}
        refused: dict[tuple[str, str], Share] = {}
        for chosen in draws(recorded, given.draws, given.queries, given.seed):
            for method, relation, nearest, rejected in score(recorded, chosen):
                key = method, relation
                right[key] = right.get(key, Share(0, 0)) + nearest
                refused[key] = refused.get(key, Share(0, 0)) + rejected
        for (method, relation), share in right.items():
            note = f"  refused {refused[method, relation]}" if method == "full" else ""
            print(f"{recorded.name:10} {relation} {method:15} {share}{note}", flush=True)


if __name__ == "__main__":
    main()
