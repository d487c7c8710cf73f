"""Known faults: whether the one fault that a take or a demonstration was given is named.

Languages are drawn from recordings of several people: one person demonstrates every gesture, takes
are by the others. Only takes that are read right are spoilt, each in one way; of those that are no
longer read right, the first cause named is counted. Where a fault is the same as another one for a
gesture (a circle drawn backwards is its mirror image), which is measured on the demonstration
itself, either name is right.

Spoilt demonstrations are the subject of `benchmarks.accuracy.blame`.

    python -m benchmarks.accuracy.known_faults ../shared/data [--draws 6] [--explained 0.5]
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from app.evaluation.share import Share
from app.recognition import Gesture, Language, PoseError, PoseSequence, Recognizer
from app.recognition.explanation.causes import EXPLAINED, find_causes
from app.recognition.explanation.context import RecognitionContext
from app.recognition.explanation.undoing import Comparison
from app.recognition.features.motion import find_hands, parse_body_part
from app.recognition.gestures.demonstration import condense
from app.recognition.poses.landmarks import WRISTS, other_side
from app.recognition.poses.sequence import FloatArray
from benchmarks.arguments import set_arguments
from benchmarks.sets.every_set import all_sets
from benchmarks.sets.one_shot_draws import demonstrated, draws
from benchmarks.sets.recorded_sets import RecordedSet
from benchmarks.sets.whole_body_sets import ARM_CLASSES, whole_body_sets

SETS = ("utd_signals", "utkinect", "utd_other", "carried_figures", "carried_letters")
"""Sets of whole bodies by several people."""

CUT = 0.35
"""Share of a take's path that is missing."""

TURN = 65.0
"""Degrees by which a diver is turned away."""

ARMS = ("elbow", "wrist", "hand", "index", "pinky", "thumb")

Fault = Callable[[PoseSequence, np.random.Generator], PoseSequence]


def of_arms(poses: PoseSequence) -> npt.NDArray[np.bool_]:
    """Return a mask ``(K,)`` of the landmarks of the arms."""
    return np.array([parse_body_part(name).split("_", 1)[-1] in ARMS for name in poses.landmarks])


def flipped(way: tuple[float, float]) -> Fault:
    """Return the fault of arms that are mirrored where they are."""

    def spoil(poses: PoseSequence, _random: np.random.Generator) -> PoseSequence:
        arms, xy = of_arms(poses), poses.xy.copy()
        mean = np.nanmean(xy[:, arms], axis=0)
        xy[:, arms] = mean + (xy[:, arms] - mean) * np.array(way)
        return replace(poses, xy=xy)

    return spoil


def turn_round(poses: PoseSequence, _random: np.random.Generator) -> PoseSequence:
    """Show it the other way round."""
    return replace(poses, xy=poses.xy[::-1].copy())


def exchange_arms(poses: PoseSequence, _random: np.random.Generator) -> PoseSequence:
    """Show it with the other arm, as a mirror does."""
    others = [poses.landmarks.index(other_side(name)) for name in poses.landmarks]
    xy = poses.xy[:, others] * (-1.0, 1.0) + (poses.frame_size[0], 0.0)
    return replace(poses, xy=xy)


def find_way(poses: PoseSequence) -> FloatArray:
    """Return ``(T,)`` the share of the wrists' path that is done at every frame."""
    names = [name for name in WRISTS if name in poses.landmarks]
    steps = np.nan_to_num(np.diff(poses.select(names).xy, axis=0))
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(steps, axis=2).sum(axis=1))])
    return np.asarray(way / max(float(way[-1]), 1e-9))


def keep(poses: PoseSequence, kept: npt.NDArray[np.bool_]) -> PoseSequence:
    """Keep some frames; a gap in time is closed."""
    world = None if poses.world is None else poses.world[kept]
    time = at_rate_of(poses, int(np.count_nonzero(kept)))
    return replace(poses, xy=poses.xy[kept], time=time, confidence=None, world=world)


def at_rate_of(poses: PoseSequence, count: int) -> FloatArray:
    """Return ``(count,)`` times at the frame rate of some poses."""
    return np.asarray(np.arange(count) * float(np.median(np.diff(poses.time))), dtype=np.float64)


def begin_late(poses: PoseSequence, _random: np.random.Generator) -> PoseSequence:
    """Begin late."""
    return keep(poses, find_way(poses) >= CUT)


def end_early(poses: PoseSequence, _random: np.random.Generator) -> PoseSequence:
    """End early."""
    return keep(poses, find_way(poses) <= 1 - CUT)


def leave_out(poses: PoseSequence, _random: np.random.Generator) -> PoseSequence:
    """Leave out the middle; the hand goes on where it is."""
    way = find_way(poses)
    before, after = way <= 0.5 - CUT / 2, way >= 0.5 + CUT / 2
    if not before.any() or not after.any():
        return poses
    arms, xy = of_arms(poses), poses.xy.copy()
    gap = xy[np.flatnonzero(after)[0]] - xy[np.flatnonzero(before)[-1]]
    xy[np.ix_(after, arms)] -= np.nan_to_num(gap[arms])
    return keep(replace(poses, xy=xy), before | after)


def add_part(poses: PoseSequence, random: np.random.Generator) -> PoseSequence:
    """Add a swing of the arm before, after or in the middle of the movement."""
    way = find_way(poses)
    at = {0: 0.04, 1: 0.5, 2: 0.96}[int(random.integers(3))]
    place = int(np.argmin(np.abs(way - at)))
    size = 0.5 * float(np.nanmax(np.ptp(poses.xy[:, of_arms(poses)], axis=0)))
    step = float(np.median(np.diff(poses.time)))
    # As quick as a hand that hurries: five torso lengths a second.
    hurried = int(2 * np.pi * size / (5 * (poses.torso_length() or 100.0) * step))
    count = max(8, hurried, int(0.35 * np.count_nonzero((way > 0.03) & (way < 0.97))))
    phase = np.linspace(0, 2 * np.pi, count)
    side = random.choice((-1.0, 1.0))
    swing = size * np.stack([side * np.sin(phase), 0.4 * (np.cos(phase) - 1)], axis=1)
    added = np.repeat(poses.xy[place][None], count, axis=0)
    moving = find_moving_arm(poses)
    added[:, moving] += swing[:, None]
    xy = np.concatenate([poses.xy[:place], added, poses.xy[place:]])
    time = at_rate_of(poses, len(xy))
    return replace(poses, xy=xy, time=time, confidence=None, world=None)


def find_moving_arm(poses: PoseSequence) -> npt.NDArray[np.bool_]:
    """Return a mask of the landmarks of the arm whose wrist moves more."""
    moved = {
        name: float(np.nanmax(np.ptp(poses.column(name), axis=0)))
        for name in WRISTS
        if name in poses.landmarks
    }
    side = max(moved, key=moved.__getitem__).split("_")[0]
    of_side = np.array([name.startswith(side) for name in poses.landmarks])
    return np.asarray(of_arms(poses) & of_side)


def shrink(poses: PoseSequence, _random: np.random.Generator) -> PoseSequence:
    """Show it at a quarter of its size."""
    arms, xy = of_arms(poses), poses.xy.copy()
    mean = np.nanmean(xy[:, arms], axis=0)
    xy[:, arms] = mean + (xy[:, arms] - mean) / 4
    return replace(poses, xy=xy)


def jump(poses: PoseSequence, _random: np.random.Generator) -> PoseSequence:
    """Let the moving wrist jump to the other arm's elbow, or hip if farther, twice for 0.35 s."""
    xy, way = poses.xy.copy(), find_way(poses)
    arm = find_moving_arm(poses)
    outer = arm & np.array(["elbow" not in name for name in poses.landmarks])
    moving = poses.landmarks[int(np.flatnonzero(arm)[0])]
    other = "left" if moving.startswith("right") else "right"
    targets = [poses.landmarks.index(f"{other}_{part}") for part in ("elbow", "hip")]
    count = max(3, round(0.35 / float(np.median(np.diff(poses.time)))))
    for at in (0.35, 0.65):
        first = int(np.argmin(np.abs(way - at)))
        span = slice(first, min(first + count, len(xy) - 1))
        wrist = np.nanmean(poses.xy[first][outer], axis=0)
        target = max(targets, key=lambda each: float(np.linalg.norm(xy[first, each] - wrist)))
        xy[span, outer] = xy[span, target][:, None]
    return replace(poses, xy=xy)


def change_body(poses: PoseSequence, random: np.random.Generator) -> PoseSequence:
    """Show a buddy's body, who is farther away and at rest, for a quarter of the movement."""
    xy, way = poses.xy.copy(), find_way(poses)
    first = int(np.argmin(np.abs(way - 0.4)))
    span = slice(first, first + max(4, int(0.25 * np.count_nonzero((way > 0.02) & (way < 0.98)))))
    torso = poses.torso_length() or 100.0
    rest = xy[0] + np.array([random.choice((-1.6, 1.6)) * torso, 0.2 * torso])
    middle = np.nanmean(rest, axis=0)
    xy[span] = middle + 0.65 * (rest - middle)
    return replace(poses, xy=xy)


TAKE_FAULTS: dict[str, Fault] = {
    "mirrored": flipped((-1, 1)),
    "upside_down": flipped((1, -1)),
    "reversed": turn_round,
    "other_arm": exchange_arms,
    "begun_late": begin_late,
    "ended_early": end_early,
    "part_missing": leave_out,
    "part_added": add_part,
    "too_small": shrink,
    "keypoints_jumped": jump,
    "other_person": change_body,
}
"""Faults of takes, by the kind of cause that they are."""


@dataclass(frozen=True, eq=False)
class Drawn:
    """A language that one person shows, and takes by others that are read right."""

    recognizer: Recognizer
    right: list[int]
    others: npt.NDArray[np.intp]
    templates: list[int]


def draw_languages(recorded: RecordedSet, count: int, queries: int, seed: int) -> Iterator[Drawn]:
    """Draw languages of a set."""
    for drawn in draws(recorded, count, queries, seed):
        gestures = demonstrated(recorded, drawn.templates)
        recognizer = Recognizer(Language(recorded.name, gestures), "full")
        right = [
            index
            for index in drawn.others.tolist()
            if read(recognizer, recorded.recordings[index]) == recorded.labels[index]
        ]
        yield Drawn(recognizer, right, drawn.others, drawn.templates)


def read(recognizer: Recognizer, poses: PoseSequence) -> str | None:
    """Return what a take is read as."""
    try:
        return recognizer.recognize(poses).label
    except PoseError:
        return None


def name_first(
    recognizer: Recognizer, poses: PoseSequence, label: str, explained: float = EXPLAINED
) -> str | None:
    """Return the kind of the first cause of a take; "right" where it is read right all the same."""
    context = RecognitionContext(recognizer=recognizer, poses=poses, whole=poses)
    try:
        if context.result.label == label:
            return "right"
        causes = find_causes(context, label, explained=explained)
    except PoseError:
        return None
    return causes[0].kind.value if causes else "none"


def list_equal_faults(
    recognizer: Recognizer, gesture: Gesture, poses: PoseSequence, fault: str
) -> set[str]:
    """Return the causes that a fault is for a gesture, measured on its demonstration itself.

    Parameters
    ----------
    recognizer
        Of the language.
    gesture
        The gesture.
    poses
        Its demonstration after the fault.
    fault
        The fault's name.

    """
    try:
        query = condense(recognizer.query(poses))
    except PoseError:
        return {fault}
    vote: Any = recognizer.vote
    comparison = Comparison(vote, query, gesture, None)
    undone: dict[str, float] = {}
    for each in comparison.undo_all():
        undone[each.kind] = min(each.novelty, undone.get(each.kind, np.inf))
    least = undone.get(fault, 0.0)
    return {fault} | {kind for kind, novelty in undone.items() if novelty <= max(0.1, least)}


def count_causes(
    recorded: RecordedSet, drawn: Drawn, random: np.random.Generator, explained: float
) -> Iterator[tuple[str, str, str]]:
    """Yield fault, person and answer of every spoilt take that is no longer read right."""
    labels = drawn.recognizer.language.labels
    for fault, spoil in TAKE_FAULTS.items():
        for index in random.permutation(drawn.right)[:PER_LANGUAGE].tolist():
            label = str(recorded.labels[index])
            gesture = drawn.recognizer.language.gesture(label)
            if fault in ("mirrored", "upside_down") and find_hands(gesture.salient) != 1:
                continue
            poses = recorded.recordings[index]
            # With seven frames a second a jump cannot be told from a stroke.
            if fault == "keypoints_jumped" and np.median(np.diff(poses.time)) > SLOWEST_FRAMES:
                continue
            spoilt = spoil(poses, random)
            first = name_first(drawn.recognizer, spoilt, label, explained)
            if first == "right" or first is None:
                yield fault, "", first or "unread"
                continue
            shown = recorded.recordings[drawn.templates[labels.index(label)]]
            same = list_equal_faults(
                drawn.recognizer, gesture, spoil(shown, np.random.default_rng(0)), fault
            )
            yield fault, str(recorded.people[index]), fault if first in same else first
    for index in random.permutation(drawn.right)[: 2 * PER_LANGUAGE].tolist():
        others = [label for label in labels if label != recorded.labels[index]]
        meant = others[int(random.integers(len(others)))]
        first = name_first(drawn.recognizer, recorded.recordings[index], meant, explained)
        answer = NOTHING if first == "none" else first or "unread"
        yield NOTHING, str(recorded.people[index]), answer


SLOWEST_FRAMES = 0.08
"""Most seconds between frames in which keypoints are made to jump."""

NOTHING = "none, another gesture was shown"
"""The fault of a take that is another gesture of the language: no cause should be named."""

PER_LANGUAGE = 4
"""Takes of a language that are spoilt in each way."""


def name_turned(recorded: RecordedSet, folder: Any, drawn: Drawn) -> Iterator[tuple[str, str]]:
    """Yield person and first cause of takes by divers who are turned away, with known depth."""
    near, far = (
        next(whole_body_sets(folder, [recorded.name], degrees, depth=0.03))
        for degrees in (0.0, TURN)
    )
    recognizer = Recognizer(Language(recorded.name, demonstrated(near, drawn.templates)), "full")
    for index in drawn.right[: 2 * PER_LANGUAGE]:
        first = name_first(recognizer, far.recordings[index], str(far.labels[index]))
        yield str(near.people[index]), first or "unread"


def main() -> None:
    """Print a line per fault: the share named first, people, takes, and what was named."""
    parser = set_arguments(__doc__, draws=6, queries=120)
    parser.add_argument("--explained", type=float, default=EXPLAINED, help="instead of `EXPLAINED`")
    given = parser.parse_args()
    folder = given.data / "trajectories"
    totals: dict[str, Counter[str]] = defaultdict(Counter)
    people: dict[str, set[str]] = defaultdict(set)
    for recorded in all_sets(folder, given.sets or SETS):
        found: dict[str, Counter[str]] = defaultdict(Counter)
        random = np.random.default_rng(given.seed)
        for drawn in draw_languages(recorded, given.draws, given.queries, given.seed):
            for fault, person, answer in count_causes(recorded, drawn, random, given.explained):
                found[fault][answer] += 1
                people[fault] |= {f"{recorded.name} {person}"} if person else set()
            if recorded.name in ARM_CLASSES:
                for person, answer in name_turned(recorded, folder, drawn):
                    found["turned_away"][answer] += 1
                    people["turned_away"].add(f"{recorded.name} {person}")
        for fault, answers in found.items():
            totals[fault].update(answers)
        print_answers(recorded.name, found, people)
    print_answers("all", totals, people)


def print_answers(name: str, found: dict[str, Counter[str]], people: dict[str, set[str]]) -> None:
    """Print how often each fault was named first."""
    for fault, answers in found.items():
        told = Counter({key: n for key, n in answers.items() if key not in ("right", "unread")})
        share = Share(told[fault], told.total())
        print(
            f"{name:16} {fault:42} first {share!s:20} n {told.total():4} "
            f"people {len(people[fault]):3} {dict(answers.most_common(6))}",
            flush=True,
        )


if __name__ == "__main__":
    main()
